//! One table as a dozen programs write it, and texts that are none.

mod clocks;
mod dialects;

use std::io::Write;

use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1252};

use crate::error::FileError;
use crate::log::csv::dialect::CsvTable;
use crate::log::map::{LogMap, Signal};
use crate::log::{Log, read_log};

fn signal(source: &str, unit: &str) -> Signal {
    Signal::of(source, unit)
}

fn map(time: &str, u: &str, y: &str) -> LogMap {
    LogMap {
        time: Some(signal(time, "s")),
        ..LogMap::new(vec![signal(u, "N m")], vec![signal(y, "rad/s")])
    }
}

fn read(bytes: &[u8], map: &LogMap) -> Result<Log, FileError> {
    let mut file = tempfile::Builder::new()
        .suffix(".csv")
        .tempfile()
        .expect("a file");
    file.write_all(bytes).expect("written");
    read_log(file.path(), map)
}

/// Times, inputs and outputs of the rows.
fn values(k: usize) -> [f64; 3] {
    let t = k as f64 / 1000.0;
    [t, (9.0 * t).sin(), 1e-3 * (7.0 * t).cos()]
}

/// 200 rows below a head, cells written and joined as said.
fn table(head: &str, cell: impl Fn(usize, f64) -> String, separator: &str, end: &str) -> String {
    let row = |k: usize| {
        let cells: Vec<String> = (0..3)
            .map(|column| cell(column, values(k)[column]))
            .collect();
        cells.join(separator) + end
    };
    head.to_owned() + &(0..200).map(row).collect::<String>()
}

fn plain(_: usize, value: f64) -> String {
    format!("{value:.9}")
}

fn comma(column: usize, value: f64) -> String {
    plain(column, value).replace('.', ",")
}

/// The time by a form of its own.
fn timed(form: impl Fn(f64) -> String) -> impl Fn(usize, f64) -> String {
    move |column, value| match column {
        0 => form(value),
        _ => plain(column, value),
    }
}

#[test]
fn the_same_table_from_a_dozen_programs() {
    let clock = |t: f64| format!("23:59:{:09.6}", 59.9 + t);
    let over_midnight = |t: f64| match t < 0.0999 {
        true => clock(t),
        false => format!("00:00:{:09.6}", t - 0.1),
    };
    for (name, text, columns) in [
        ("plain", table("t,u,y\n", plain, ",", "\n"), ["t", "u", "y"]),
        (
            "comma at the end",
            table("t,u,y,\r\n", plain, ",", ",\r\n"),
            ["t", "u", "y"],
        ),
        (
            "german",
            table("Zeit;Moment;Drehzahl\ns;Nm;rad/s\n", comma, ";", "\n"),
            ["Zeit", "Moment", "Drehzahl"],
        ),
        (
            "tabs, comma",
            table("t\tu\ty\n[s]\t[N m]\t[rad/s]\n", comma, "\t", "\n"),
            ["t", "u", "y"],
        ),
        (
            "quoted",
            table(
                "\"t, s\",\"u\",\"y\"\n",
                |_, v| format!("\"{v:.9}\""),
                ",",
                "\n",
            ),
            ["t, s", "u", "y"],
        ),
        (
            "quoted decimal commas",
            table("t,u,y\n", |c, v| format!("\"{}\"", comma(c, v)), ",", "\n"),
            ["t", "u", "y"],
        ),
        (
            "savetxt",
            table("# t u y\n", plain, " ", "\n"),
            ["t", "u", "y"],
        ),
        (
            "blanks",
            table("  t     u    y\n", |_, v| format!("  {v:.9} "), " ", "\n"),
            ["t", "u", "y"],
        ),
        (
            "comma and blank",
            table("t, u, y\n", plain, ", ", "\n"),
            ["t", "u", "y"],
        ),
        (
            "rostopic",
            table("%time,field.u,field.y\n", plain, ",", "\n"),
            ["%time", "field.u", "field.y"],
        ),
        (
            "preamble",
            table("Drive: 3\nRate;1000 Hz;x;z\n\nt;u;y\n", plain, ";", "\n"),
            ["t", "u", "y"],
        ),
        (
            "sep=",
            table("sep=;\nt;u;y\n", plain, ";", "\n"),
            ["t", "u", "y"],
        ),
        ("no header", table("", plain, ",", "\n"), ["1", "2", "3"]),
        (
            "seconds",
            table("t,u,y\n", timed(|t| format!("{t:.6} sec")), ",", "\n"),
            ["t", "u", "y"],
        ),
        (
            "clock",
            table("t,u,y\n", timed(over_midnight), ",", "\n"),
            ["t", "u", "y"],
        ),
        (
            "date",
            table(
                "t;u;y\n",
                timed(|t| format!("26.11.2026 10:00:{t:09.6}")),
                ";",
                "\n",
            ),
            ["t", "u", "y"],
        ),
        ("bar", table("t|u|y\n", plain, "|", "\n"), ["t", "u", "y"]),
    ] {
        let [t, u, y] = columns;
        let log =
            read(text.as_bytes(), &map(t, u, y)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let record = &log.record;
        assert_eq!(record.n_samples(), 200, "{name}");
        assert!(
            (record.sample_time_s - 1e-3).abs() < 1e-9,
            "{name}: {}",
            record.sample_time_s
        );
        for k in 0..200 {
            let [_, u, y] = values(k);
            assert!(
                (record.u[[0, k]] - u).abs() < 1e-9 && (record.y[[0, k]] - y).abs() < 1e-9,
                "{name}, row {k}"
            );
        }
        assert_eq!(
            log.warnings.is_empty(),
            [
                "plain",
                "comma at the end",
                "quoted",
                "comma and blank",
                "rostopic",
                "seconds",
                "clock"
            ]
            .contains(&name),
            "{name}: {:?}",
            log.warnings
        );
    }
}

#[test]
fn any_usual_encoding_is_read_and_told() {
    let text = table("t,Länge µ,y\n", plain, ",", "\n");
    let utf_16 = |is_little: bool| {
        let bytes = text.encode_utf16();
        let bytes = bytes.flat_map(|unit| {
            if is_little {
                unit.to_le_bytes()
            } else {
                unit.to_be_bytes()
            }
        });
        bytes.collect::<Vec<u8>>()
    };
    let with_mark = |mark: &[u8], rest: Vec<u8>| [mark, &rest].concat();
    for (encoding, bytes) in [
        (
            WINDOWS_1252.name(),
            WINDOWS_1252.encode(&text).0.into_owned(),
        ),
        (UTF_16LE.name(), utf_16(true)),
        (UTF_16BE.name(), utf_16(false)),
        ("UTF-16LE", with_mark(&[0xff, 0xfe], utf_16(true))),
        (
            "",
            with_mark(&[0xef, 0xbb, 0xbf], text.clone().into_bytes()),
        ),
    ] {
        let log = read(&bytes, &map("t", "Länge µ", "y"))
            .unwrap_or_else(|error| panic!("{encoding}: {error}"));
        assert_eq!(log.record.n_samples(), 200, "{encoding}");
        assert!(log.warnings.iter().any(|told| told.contains(encoding)) || encoding.is_empty());
    }
}

#[test]
fn what_is_stated_is_not_guessed() {
    // integers: with a decimal comma two columns, without it four
    let text = "a;b\n".to_owned()
        + &(0..50)
            .map(|k| format!("{},5;{},25\n", k, k % 7))
            .collect::<String>();
    let counted = |csv| LogMap {
        time: None,
        sample_time_s: Some(0.1),
        csv: Some(csv),
        ..map("", "1", "2")
    };
    let stated = CsvTable {
        separator: Some(';'),
        decimal: Some(','),
        header_line: Some(0),
        encoding: Some("windows-1252".into()),
    };
    let log = read(text.as_bytes(), &counted(stated.clone())).expect("read");
    assert_eq!((log.record.u[[0, 3]], log.record.y[[0, 8]]), (3.5, 1.25));
    for (csv, told) in [
        (
            CsvTable {
                encoding: Some("klingon".into()),
                ..stated.clone()
            },
            "klingon",
        ),
        (
            CsvTable {
                header_line: Some(900),
                ..stated
            },
            "900",
        ),
    ] {
        let error = read(text.as_bytes(), &counted(csv))
            .expect_err("refused")
            .to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn units_in_the_file_that_are_not_those_of_the_map_are_told() {
    let text = table("t;u;y\ns;%;rad/s\n", plain, ";", "\n");
    let log = read(text.as_bytes(), &map("t", "u", "y")).expect("read");
    assert!(
        log.warnings.iter().any(|told| told.contains("`%`")),
        "{:?}",
        log.warnings
    );
}

#[test]
fn a_row_of_another_width_amid_a_long_file_is_no_end_of_it() {
    let mut text = table("t,u,y\n", plain, ",", "\n");
    text += "0.2,1\n";
    for k in 0..20_000 {
        text += &format!("{},1,2\n", 0.3 + f64::from(k) / 1000.0);
    }
    let error = read(text.as_bytes(), &map("t", "u", "y"))
        .expect_err("refused")
        .to_string();
    assert!(
        error.contains("line 202") && error.contains("2 fields"),
        "{error}"
    );
}

proptest::proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in "[tuy0-9,;.:\\-\"#% \t\r\n]{0,200}") {
        let _ = read(text.as_bytes(), &map("t", "u", "y"));
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes: Vec<u8>) {
        let _ = read(&bytes, &map("t", "u", "y"));
    }
}
