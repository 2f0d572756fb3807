//! Recorders' and tools' own tables with one clock, three files each.

use super::{map, read, signal, values};
use crate::log::map::LogMap;

/// The recording of a text is that of `values`, row by row.
fn check(name: &str, text: &str, map: &LogMap) {
    let log = read(text.as_bytes(), map).unwrap_or_else(|error| panic!("{name}: {error}"));
    let record = &log.record;
    assert_eq!(record.n_samples(), 200, "{name}");
    let is_even = (record.sample_time_s - 1e-3).abs() < 1e-8;
    assert!(is_even, "{name}: {}", record.sample_time_s);
    for k in 0..200 {
        let [_, u, y] = values(k);
        let is_equal = |found: f64, value: f64| (found - value).abs() < 2e-6;
        let are_equal = is_equal(record.u[[0, k]], u) && is_equal(record.y[[0, k]], y);
        assert!(are_equal, "{name}, row {k}");
    }
}

/// 200 rows below a head.
fn rows(head: &str, row: impl Fn(usize, [f64; 3]) -> String) -> String {
    let rows = (0..200).map(|k| row(k, values(k)));
    head.to_owned() + &rows.collect::<String>()
}

#[test]
fn ur_rtde() {
    let head = "timestamp,actual_q_0,actual_qd_0,actual_current_0,robot_mode\n";
    let row = |t: f64, u: f64, y: f64| format!("{t:.6},0.500000,{y:.6},{u:.6},7\n");
    let map = map("timestamp", "actual_current_0", "actual_qd_0");
    check(
        "plain",
        &rows(head, |_, [t, u, y]| row(7.0 + t, u, y)),
        &map,
    );
    let long_on = rows(head, |_, [t, u, y]| row(1e6 + t, u, y));
    check("after days", &long_on, &map);
    // a state that was read twice is written twice
    let doubled = rows(head, |k, [t, u, y]| {
        row(t, u, y).repeat(1 + usize::from(k % 50 == 9))
    });
    check("doubled", &doubled, &map);
}

#[test]
fn ur_client() {
    let names = "timestamp actual_current_0 actual_qd_0 output_int_register_0\r\n";
    let map = map("timestamp", "actual_current_0", "actual_qd_0");
    let row = |[t, u, y]: [f64; 3]| format!("{t} {u} {y} 0\r\n");
    check("blanks", &rows(names, |_, values| row(values)), &map);
    check(
        "later",
        &rows(names, |_, [t, u, y]| row([t + 1234.5, u, y])),
        &map,
    );
    let unix = |text: String| text.replace("\r\n", "\n");
    check("unix", &unix(rows(names, |_, values| row(values))), &map);
}

#[test]
fn franka() {
    let head = "time,success_rate,state.q[0],state.dq[0],state.dq_d[0],cmd.tau_J_d[0]\n";
    let in_ms = |row: fn([f64; 3]) -> String, head: &str| rows(head, move |_, values| row(values));
    let mut map = map("time", "cmd.tau_J_d[0]", "state.dq[0]");
    map.time = Some(signal("time", "ms"));
    let plain = |[t, u, y]: [f64; 3]| format!("{:.0},1,0.1,{y:.9},0,{u:.9}\n", 4000.0 + 1e3 * t);
    check("comma", &in_ms(plain, head), &map);
    let blanks = |[t, u, y]: [f64; 3]| format!("{:.0}, 1, 0.1, {y:.9}, 0, {u:.9}\n", 1e3 * t);
    check("blanks", &in_ms(blanks, &head.replace(',', ", ")), &map);
    let trailing = |[t, u, y]: [f64; 3]| format!("{:.0},1,0.1,{y:e},0,{u:e},\n", 1e3 * t);
    check("trailing", &in_ms(trailing, head), &map);
}

#[test]
fn klipper() {
    let head = "#time,accel_x,accel_y,accel_z\n";
    let row = |t: f64, u: f64, y: f64| format!("{t:.6},{u:.6},{y:.6},9810.0\n");
    let plain = rows(head, |_, [t, u, y]| row(100.0 + t, u, y));
    for time in ["time", "#time"] {
        check(time, &plain, &map(time, "accel_x", "accel_y"));
    }
    let noted = format!("# shaper test, X\n{plain}");
    check("noted", &noted, &map("time", "accel_x", "accel_y"));
}

#[test]
fn rostopic() {
    let head = "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.velocity0,field.effort0\n";
    let epoch = 1_425_315_906_000_000_000_i64;
    let row = |k: usize, u: f64, y: f64, frame: &str, late: i64| {
        let stamp = epoch + 1_000_000 * k as i64;
        format!("{},{k},{stamp},{frame},{y:.12},{u:.12}\n", stamp + late)
    };
    let on = |time: &str| {
        let mut map = map(time, "field.effort0", "field.velocity0");
        map.time = Some(signal(time, "ns"));
        map
    };
    let plain =
        |frame: &'static str, late| rows(head, move |k, [_, u, y]| row(k, u, y, frame, late));
    check("stamp", &plain("", 250_123), &on("field.header.stamp"));
    check("time", &plain("base", 0), &on("%time"));
    check("without mark", &plain("/base link", 7), &on("time"));
}

#[test]
fn plotjuggler() {
    let head = "time,/joint_states/velocity/joint_1,/joint_states/effort/joint_1,/other/data\n";
    let on = map(
        "time",
        "/joint_states/effort/joint_1",
        "/joint_states/velocity/joint_1",
    );
    let row = |t: f64, u: f64, y: f64, other: &str| format!("{t:.6},{y:.12},{u:.12},{other}\n");
    let epoch = 1_764_000_000.0;
    check(
        "merged",
        &rows(head, |k, [t, u, y]| {
            row(epoch + t, u, y, if k % 4 == 0 { "1" } else { "" })
        }),
        &on,
    );
    check(
        "nan",
        &rows(head, |k, [t, u, y]| row(t, u, y, ["NaN", "Inf"][k % 2])),
        &on,
    );
    // rows of another topic in between
    let between = rows(head, |k, [t, u, y]| {
        let other = format!("{:.6},,,{k}\n", t + 0.0004);
        row(t, u, y, "") + &other
    });
    check("between", &between, &on);
}

#[test]
fn no_header() {
    // 31 columns: time, six each of position, velocity, current, target current, target torque
    let row = |separator: &str, [t, u, y]: [f64; 3], decimal: &str| {
        let mut cells = vec![format!("{t:.4}")];
        cells.extend((0..30).map(|column| match column {
            6 => format!("{y:.9}"),
            12 => format!("{u:.9}"),
            _ => format!("{:.4}", f64::from(column) / 7.0),
        }));
        cells.join(separator).replace('.', decimal) + "\n"
    };
    for (separator, decimal) in [(",", "."), (";", ","), (" ", "."), ("\t", ",")] {
        let text = rows("", |_, values| row(separator, values, decimal));
        check(separator, &text, &map("1", "14", "8"));
    }
}

#[test]
fn pandas_in_five_locales() {
    let stamp = |t: f64| format!("2026-11-26 10:00:{t:09.6}");
    for (name, separator, decimal) in [
        ("english", ",", "."),
        ("german", ";", ","),
        ("swiss", ";", "."),
        ("tabs", "\t", ","),
        ("bars", "|", "."),
    ] {
        let head = ["", "t", "u", "y"].join(separator) + "\n";
        let cell = |value: f64| format!("{value:.9}").replace('.', decimal);
        let index = |k: usize| k.to_string();
        let plain = rows(&head, |k, [t, u, y]| {
            [index(k), cell(t), cell(u), cell(y)].join(separator) + "\n"
        });
        check(name, &plain, &map("t", "u", "y"));
        // times as index, without a name, and with a zone
        for (zone, head) in [("", ["", "u", "y"]), ("+01:00", ["when", "u", "y"])] {
            let dated = rows(&(head.join(separator) + "\n"), |_, [t, u, y]| {
                [stamp(t) + zone, cell(u), cell(y)].join(separator) + "\n"
            });
            check(name, &dated, &map(head[0], "u", "y"));
        }
    }
    let since = rows(",u,y\n", |_, [t, u, y]| {
        format!("0 days 00:00:{t:09.6},{u:.9},{y:.9}\n")
    });
    check("since", &since, &map("", "u", "y"));
}
