//! Tables with several clocks: TwinCAT Scope, Simulation Data Inspector, Foxglove; columns that end one by one.

use super::{map, read, signal};
use crate::log::listing::list_recording;
use crate::log::map::LogMap;

fn u(k: usize) -> f64 {
    (k as f64 / 11.0).sin()
}

fn y(k: usize) -> f64 {
    1e-3 * (k as f64 / 7.0).cos()
}

fn on(time: &str, unit: &str, u: &str, y: &str) -> LogMap {
    let mut map = map(time, u, y);
    map.time = Some(signal(time, unit));
    map
}

/// A text read is `n` samples, 1 ms apart, and what is told of it.
fn check(name: &str, text: &str, map: &LogMap, n: usize) -> String {
    let log = read(text.as_bytes(), map).unwrap_or_else(|error| panic!("{name}: {error}"));
    let record = &log.record;
    assert_eq!(record.n_samples(), n, "{name}");
    assert!(
        (record.sample_time_s - 1e-3).abs() < 1e-9,
        "{name}: {}",
        record.sample_time_s
    );
    for k in 0..n {
        let is_equal =
            (record.u[[0, k]] - u(k)).abs() < 1e-6 && (record.y[[0, k]] - y(k)).abs() < 1e-6;
        assert!(is_equal, "{name}, row {k}");
    }
    log.warnings.join("\n")
}

fn refused(text: &str, map: &LogMap) -> String {
    read(text.as_bytes(), map).expect_err("refused").to_string()
}

/// Groups of a text's listing: names and units, and what is told.
fn listed(text: &str) -> (Vec<Vec<String>>, Vec<String>) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("log.csv");
    std::fs::write(&path, text).expect("written");
    let listing = list_recording(&path).expect("a table");
    let groups = listing.groups.into_iter().map(|group| {
        let signals = group.signals.into_iter();
        let named = signals.map(|signal| match signal.unit {
            Some(unit) => format!("{} in {unit}", signal.source),
            None => signal.source,
        });
        named.collect()
    });
    (groups.collect(), listing.told)
}

/// A channel of a Scope export.
struct Channel {
    name: &'static str,
    unit: &'static str,
    step_ms: f64,
    values: fn(usize) -> f64,
    count: usize,
    scale: &'static str,
}

impl Channel {
    fn of(name: &'static str, step_ms: f64, count: usize, values: fn(usize) -> f64) -> Self {
        let unit = if name == "y" {
            "rad/s (Angular velocity)"
        } else {
            "Nm (Torque)"
        };
        Self {
            name,
            unit,
            step_ms,
            values,
            count,
            scale: "1",
        }
    }
}

/// How an export is written.
struct Export {
    separator: &'static str,
    decimal: &'static str,
    /// Windows' time of the first sample, or none: ms from the beginning.
    begin: Option<i64>,
    is_ended: bool,
}

impl Export {
    /// Groups of channels, each behind a time column.
    fn text(&self, groups: &[&[Channel]]) -> String {
        let s = self.separator;
        let quoted = |text: &str| {
            if s == " " {
                format!("\"{text}\"")
            } else {
                text.to_owned()
            }
        };
        let mut text = format!(
            "Name{s}{}\nFile{s}{}\n",
            quoted("my scope"),
            quoted("C:\\a b.csv")
        );
        for key in ["Starttime of export", "Endtime of export"] {
            let date = quoted("Montag, 2. Mai 2022");
            text += &format!(
                "{}{s}132959733843760000{s}{date}{s}15:56:24.376\n",
                quoted(key)
            );
        }
        text += "\n\n";
        let keys = [
            "Name",
            "SymbolComment",
            "Data-Type",
            "SampleTime[ms]",
            "VariableSize",
            "SymbolBased",
            "IndexGroup",
            "IndexOffset",
            "SymbolName",
            "NetID",
            "Port",
            "Offset",
            "ScaleFactor",
            "BitMask",
            "Unit",
            "Unit ScaleFactor",
            "Unit Offset",
        ];
        for key in keys {
            let cells = groups.iter().flat_map(|group| {
                let cell = move |channel: &Channel| match key {
                    "Name" => channel.name.to_owned(),
                    "SymbolComment" => String::new(),
                    "Data-Type" => "REAL32".into(),
                    // by the system's language, whatever the rows are in
                    "SampleTime[ms]" => channel.step_ms.to_string().replace('.', ","),
                    "SymbolName" => format!("MAIN.{}", channel.name),
                    "Unit" => channel.unit.into(),
                    "ScaleFactor" => channel.scale.into(),
                    "Offset" | "Unit Offset" => "0".into(),
                    _ => "1".into(),
                };
                std::iter::once(key.to_owned()).chain(group.iter().map(cell))
            });
            text += &(cells.collect::<Vec<_>>().join(s) + "\n");
        }
        text += "\n";
        let longest = groups.iter().map(|group| group[0].count).max().unwrap_or(0);
        for k in 0..longest {
            let cells = groups.iter().flat_map(|group| self.cells(group, k));
            let cells: Vec<String> = cells.collect();
            let filled = cells
                .iter()
                .rposition(|cell| !cell.is_empty())
                .map_or(0, |last| last + 1);
            text += &(cells[..filled].join(s) + "\n");
        }
        text + if self.is_ended { "EOF\n" } else { "" }
    }

    fn cells(&self, group: &[Channel], k: usize) -> Vec<String> {
        if k >= group[0].count {
            return vec![String::new(); group.len() + 1];
        }
        let at_ms = k as f64 * group[0].step_ms;
        let time = match self.begin {
            Some(begin) => (begin + (1e4 * at_ms).round() as i64).to_string(),
            None => at_ms.to_string().replace('.', self.decimal),
        };
        let value =
            |channel: &Channel| format!("{:.9}", (channel.values)(k)).replace('.', self.decimal);
        std::iter::once(time)
            .chain(group.iter().map(value))
            .collect()
    }
}

#[test]
fn twincat_scope() {
    let channel = Channel::of;
    let file_time = Some(132_959_733_843_760_000);
    let fast = [channel("fast", 0.25, 800, |k| k as f64)];
    let slow = [channel("slow", 5.0, 40, |k| k as f64)];
    for (separator, decimal, begin, is_ended) in [
        ("\t", ",", None, false),
        ("\t", ".", file_time, true),
        (";", ",", file_time, false),
        (",", ".", None, true),
        (" ", ".", None, true),
        (":", ",", None, false),
    ] {
        let export = Export {
            separator,
            decimal,
            begin,
            is_ended,
        };
        let name = format!("{separator:?} {decimal} {begin:?}");
        let shared = [channel("u", 1.0, 200, u), channel("y", 1.0, 200, y)];
        let own = [[channel("u", 1.0, 200, u)], [channel("y", 1.0, 200, y)]];
        for groups in [
            &[&fast[..], &shared, &slow][..],
            &[&own[0][..], &own[1]],
            &[&fast[..], &own[1], &own[0], &slow],
        ] {
            let text = export.text(groups);
            let times = LogMap {
                time: None,
                ..map("", "u", "y")
            };
            for map in [on("Name", "ms", "u", "y"), times] {
                let told = check(&name, &text, &map, 200);
                assert!(told.contains("TwinCAT Scope"), "{name}: {told}");
                assert!(!told.contains("by the file"), "{name}: {told}");
                assert_eq!(
                    told.contains("decimal comma"),
                    decimal == ",",
                    "{name}: {told}"
                );
                assert_eq!(
                    told.contains("separator"),
                    separator != ",",
                    "{name}: {told}"
                );
            }
        }
        let (groups, told) = listed(&export.text(&[&fast, &shared, &[channel("z", 1.0, 200, y)]]));
        assert_eq!(told.len(), 1, "{name}: {told:?}");
        if separator != " " {
            let apart = [
                vec!["Name in ms", "fast in Nm"],
                vec!["Name in ms", "u in Nm", "y in rad/s", "z in Nm"],
            ];
            assert_eq!(groups, apart, "{name}");
        }
        // another unit is told, another rate refused with both
        let text = export.text(&[&fast, &shared, &slow]);
        let mut amperes = on("Name", "ms", "u", "y");
        amperes.u[0].unit = "A".into();
        let told = check(&name, &text, &amperes, 200);
        // units have blanks in them, and no quotes around them
        let is_told = told.contains("column `u` is in `Nm`");
        assert_eq!(is_told, separator != " ", "{name}: {told}");
        let told = refused(&text, &on("Name", "ms", "fast", "y"));
        assert!(
            told.contains("one rate") && told.contains("fast") && told.contains("y"),
            "{told}"
        );
    }
}

#[test]
fn what_a_scope_export_cannot_tell_is_refused() {
    let channels = [
        Channel::of("u of axis", 1.0, 200, u),
        Channel::of("y", 1.0, 200, y),
    ];
    let export = Export {
        separator: " ",
        decimal: ".",
        begin: None,
        is_ended: false,
    };
    let told = refused(
        &export.text(&[&channels]),
        &on("Name", "ms", "u of axis", "y"),
    );
    assert!(told.contains("export it with tabs"), "{told}");
    let channels = [Channel::of("u", 1.0, 200, u), Channel::of("y", 1.0, 200, y)];
    let commas = Export {
        separator: ",",
        decimal: ",",
        begin: None,
        is_ended: false,
    };
    let told = refused(&commas.text(&[&channels]), &on("Name", "ms", "u", "y"));
    assert!(told.contains("export it with tabs"), "{told}");
    let tabs = Export {
        separator: "\t",
        decimal: ".",
        begin: None,
        is_ended: false,
    };
    let text = tabs.text(&[&channels]);
    let told = refused(&text, &on("Name", "ms", "u", "z"));
    assert!(told.contains("one of Name, u, y"), "{told}");
}

#[test]
fn scale_factors_that_values_may_lack_are_told() {
    let export = Export {
        separator: "\t",
        decimal: ".",
        begin: None,
        is_ended: false,
    };
    let mut channels = [
        Channel::of("u", 1.0, 200, u),
        Channel::of("y", 1.0, 200, y),
        Channel::of("z", 1.0, 200, y),
    ];
    let map = on("Name", "ms", "u", "y");
    channels[2].scale = "-10";
    let told = check("others", &export.text(&[&channels]), &map, 200);
    assert!(!told.contains("scaled"), "{told}");
    channels[1].scale = "0,5";
    let told = check("its own", &export.text(&[&channels]), &map, 200);
    assert!(told.contains("`y` is scaled in TwinCAT Scope"), "{told}");
}

#[test]
fn columns_end_one_by_one_and_stay_ended() {
    let early = [Channel::of("y", 1.0, 150, y)];
    let long = [Channel::of("u", 1.0, 200, u)];
    let export = Export {
        separator: "\t",
        decimal: ".",
        begin: None,
        is_ended: false,
    };
    let text = export.text(&[&long, &early]);
    let map = on("Name", "ms", "u", "y");
    let told = check("early", &text, &map, 150);
    assert!(told.contains("y: the column ends in line"), "{told}");
    let again = text.clone() + "200\t0.5\t200\t0.1\n";
    let told = refused(&again, &map);
    assert!(
        told.contains("columns that end stay at their end"),
        "{told}"
    );
    // a file that breaks off loses its last row, not its columns
    let cut = export.text(&[&[Channel::of("u", 1.0, 200, u), Channel::of("y", 1.0, 200, y)]]);
    let log = read(&cut.as_bytes()[..cut.len() - 14], &map).expect("read");
    assert_eq!(log.record.n_samples(), 199);
}

#[test]
fn simulation_data_inspector() {
    let head = "time,u,y,time,slow\n";
    let row = |k: usize| format!("{},{:.9},{:.9}", k as f64 / 1000.0, u(k), y(k));
    let slow = |k: usize| {
        if k < 20 {
            format!("{},{k}", k as f64 / 100.0)
        } else {
            ",".into()
        }
    };
    let rows = |row: &dyn Fn(usize) -> String| (0..200).map(row).collect::<String>();
    let both = rows(&|k| format!("{},{}\n", row(k), slow(k)));
    let map = on("time", "s", "u", "y");
    check("plain", &format!("{head}{both}"), &map, 200);
    let said = ",Unit: N m,Unit: rad/s,,Type: int8\n,Type: double,Interp: zoh,,Unit: V\n";
    let told = check("said", &format!("{head}{said}{both}"), &map, 200);
    assert!(
        told.contains("units: N m, rad/s, V") && !told.contains("by the file"),
        "{told}"
    );
    let (groups, _) = listed(&format!("{head}{said}{both}"));
    assert_eq!(
        groups,
        [
            vec!["time", "u in N m", "y in rad/s"],
            vec!["time", "slow in V"]
        ]
    );
    let other = said.replace("N m", "A");
    let told = check("other", &format!("{head}{other}{both}"), &map, 200);
    assert!(told.contains("column `u` is in `A` by the file"), "{told}");
    // u and y behind times of their own, in semicolons and commas
    let apart = rows(&|k| {
        let t = k as f64 / 1000.0;
        format!("{t};{:.9};{t};{:.9}\n", u(k), y(k)).replace('.', ",")
    });
    check("apart", &format!("time;u;time;y\n{apart}"), &map, 200);
    let rates = refused(&format!("{head}{both}"), &on("time", "s", "u", "slow"));
    assert!(rates.contains("one rate for all signals"), "{rates}");
    let before = refused(
        &format!("a,{head}{}", both.replace('\n', "\n1,")).replace("a,time", "u0,time"),
        &on("time", "s", "u0", "y"),
    );
    assert!(before.contains("no time column before it"), "{before}");
}

#[test]
fn foxglove() {
    let head = "elapsed time,receive time,header.stamp,topic,value\n";
    let row = |k: usize, topic: &str, value: f64, stamped: bool| {
        let t = k as f64 / 1000.0;
        let late = if topic == "/u.data" { 0.0 } else { 0.000_05 };
        let stamp = if stamped {
            format!("{:.9}", 1_764_000_000.0 + t)
        } else {
            String::new()
        };
        format!(
            "{t},{:.9},{stamp},{topic},{value:.9}\n",
            1_764_000_001.0 + t + late
        )
    };
    let u_of = |k: usize, stamped| row(k, "/u.data", u(k), stamped);
    let y_of = |k: usize, stamped| row(k, "/joint.velocity[0]", y(k), stamped);
    let rows =
        |row: &dyn Fn(usize) -> String| head.to_owned() + &(0..200).map(row).collect::<String>();
    let mixed = rows(&|k| u_of(k, true) + &y_of(k, true));
    let blocks = rows(&|k| u_of(k, false)) + &(0..200).map(|k| y_of(k, false)).collect::<String>();
    let others = rows(&|k| {
        let other = row(k, "/other", 7.0, false);
        if k % 3 == 0 {
            y_of(k, true) + &other + &u_of(k, true)
        } else {
            u_of(k, true) + &y_of(k, true)
        }
    });
    for (name, text, time) in [
        ("mixed", &mixed, "header.stamp"),
        ("mixed", &mixed, "receive time"),
        ("mixed", &mixed, "elapsed time"),
        ("blocks", &blocks, "receive time"),
        ("others", &others, "header.stamp"),
    ] {
        check(
            name,
            text,
            &on(time, "s", "/u.data", "/joint.velocity[0]"),
            200,
        );
    }
    let told = refused(&others, &on("header.stamp", "s", "/u.data", "/y"));
    assert!(
        told.contains("topic `/y`") && told.contains("one of /joint.velocity[0], /other, /u.data"),
        "{told}"
    );
    let (groups, told) = listed(&others);
    let times = [
        "header.stamp in s",
        "receive time in s",
        "elapsed time in s",
    ];
    let of = |topic: &'static str, times: &[&'static str]| [times, &[topic]].concat();
    let topics = [
        of("/joint.velocity[0]", &times),
        of("/other", &times[1..]),
        of("/u.data", &times),
    ];
    assert_eq!(
        (groups, told.len()),
        (
            topics
                .map(|topic| topic.into_iter().map(str::to_owned).collect())
                .to_vec(),
            0
        )
    );
    let told = refused(&others, &on("header.stamp", "s", "/u.data", "/other"));
    assert!(told.contains("topic `/other`"), "{told}");
}
