//! Estimate, compare, export and recover through the binary: whole logs, damaged ones, and a
//! recording that is not ours.

mod cli_binary;

use std::fs;
use std::path::{Path, PathBuf};

use cli_binary::{code, frfid, replaced, stderr, stdout};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// A folder with `logs/`: the runs of the multisine template, short, with four realizations of
/// three periods.
fn campaign() -> TempDir {
    let folder = tempdir().expect("a temporary folder");
    let text = stdout(&frfid(folder.path(), &["init", "multisine"]));
    let short = text
        .replace("resolution_hz = 0.1", "resolution_hz = 1.0")
        .replace("realizations = 30", "realizations = 4");
    fs::write(
        folder.path().join("x.toml"),
        short.replace("periods = 1 ", "periods = 3 "),
    )
    .expect("written");
    let run = frfid(folder.path(), &["run", "x.toml", "-o", "logs"]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    folder
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("written")).expect("JSON")
}

/// Estimates `logs` into `name` and returns exit code, summary and messages.
fn estimate(here: &Path, name: &str) -> (i32, Value, String) {
    let output = frfid(here, &["estimate", "logs", "-o", name, "--json"]);
    let summary = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    (code(&output), summary, stderr(&output))
}

#[test]
fn logs_become_a_result_a_report_and_a_table() {
    let folder = campaign();
    let here = folder.path();
    let output = frfid(
        here,
        &["estimate", "logs", "-o", "frf.json", "--report", "frf.html"],
    );
    let text = stdout(&output);
    // the joint sticks for nearly half of the time: what is seen is friction
    assert_eq!(code(&output), 3, "{}", stderr(&output));
    for told in [
        "sticking: joint_1",
        "frf.json",
        "joint_1 torque (N m)",
        "degrees of freedom",
        "runs: 4",
        "passed",
    ] {
        assert!(text.contains(told), "{told} is not told in\n{text}");
    }
    let result = json(&here.join("frf.json"));
    assert_eq!(result["noise"]["degrees_of_freedom"], 8.0);
    assert_eq!(result["total"]["degrees_of_freedom"], 3.0);
    let page = fs::read_to_string(here.join("frf.html")).expect("written");
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("Provenance"));

    let refused = frfid(
        here,
        &[
            "estimate",
            "logs",
            "-o",
            "other.json",
            "--report",
            "frf.html",
        ],
    );
    assert!(
        code(&refused) == 2 && stderr(&refused).contains("frf.html exists"),
        "{}",
        stderr(&refused)
    );
    assert!(
        !here.join("other.json").exists(),
        "half of the outputs was written"
    );

    for (format, begin) in [
        ("csv", b"frequency".as_slice()),
        ("npz", b"PK"),
        ("mat", b"MATLAB 5.0"),
    ] {
        let export = frfid(
            here,
            &[
                "export", "frf.json", "--to", format, "-o", "frf.out", "--force",
            ],
        );
        assert_eq!(code(&export), 0, "{}", stderr(&export));
        assert!(
            fs::read(here.join("frf.out"))
                .expect("written")
                .starts_with(begin)
        );
    }
    let csv = frfid(here, &["export", "frf.html", "--to", "csv", "-o", "b.csv"]);
    assert!(
        code(&csv) == 2 && stderr(&csv).contains("needed a result of frfid estimate"),
        "{}",
        stderr(&csv)
    );
}

#[test]
fn what_was_not_measured_is_said_to_be_unavailable() {
    let folder = campaign();
    let here = folder.path();
    let one = ["estimate", "logs/p000-m0-q0.mcap", "-o", "one.json"];
    let output = frfid(here, &one);
    assert_eq!(code(&output), 3, "three runs are missing");
    assert!(
        stdout(&output).contains("not available: it takes at least two realizations"),
        "{}",
        stdout(&output)
    );
    assert!(
        stderr(&output).contains("needed 4 whole ones"),
        "{}",
        stderr(&output)
    );
    assert_eq!(json(&here.join("one.json"))["total"], Value::Null);
}

#[test]
fn damaged_logs_are_told_and_the_rest_is_used() {
    let folder = campaign();
    let here = folder.path();
    let (clean, whole, _) = estimate(here, "whole.json");
    assert_eq!((clean, &whole["is_lossy"]), (3, &false.into())); // it sticks, nothing is lost
    let log = here.join("logs/p001-m0-q0.mcap");
    let bytes = fs::read(&log).expect("written");
    let cut = bytes[..bytes.len() * 9 / 10].to_vec();
    let mut flipped = bytes.clone();
    flipped[bytes.len() * 6 / 10] ^= 1;
    for (name, damaged) in [
        ("cut", cut),
        ("flipped", flipped),
        ("nothing", Vec::new()),
        ("text", b"hello".to_vec()),
    ] {
        fs::write(&log, damaged).expect("written");
        let (exit, summary, told) = estimate(here, &format!("{name}.json"));
        assert_eq!(
            (exit, &summary["is_lossy"]),
            (3, &true.into()),
            "{name}: {told}"
        );
        assert!(
            told.contains("warning: ") && told.contains("p001-m0-q0.mcap"),
            "{name}: {told}"
        );
    }
    fs::remove_dir_all(here.join("logs")).expect("removed");
    fs::create_dir(here.join("logs")).expect("made");
    let (exit, _, told) = estimate(here, "none.json");
    assert!(
        exit == 2 && told.contains("no MCAP, rosbag2 SQLite, CSV, MAT, NPZ file"),
        "{told}"
    );
    fs::write(here.join("logs/bench.csv"), "t,u,y\n0,1,2\n").expect("written");
    let (exit, _, told) = estimate(here, "none.json");
    assert!(
        exit == 2 && told.contains("bench.csv") && told.contains("--map"),
        "{told}"
    );
}

#[test]
fn recover_salvages_what_is_readable_and_says_what_is_not() {
    let folder = campaign();
    let here = folder.path();
    let bytes = fs::read(here.join("logs/p001-m0-q0.mcap")).expect("written");
    fs::write(here.join("a.mcap.part"), &bytes[..bytes.len() * 2 / 3]).expect("written");
    let cut = frfid(here, &["recover", "a.mcap.part"]);
    assert!(
        code(&cut) == 3 && stderr(&cut).contains("lost: "),
        "{}",
        stderr(&cut)
    );
    assert!(
        stdout(&cut).starts_with("a.recovered.mcap: "),
        "{}",
        stdout(&cut)
    );
    let sound = frfid(
        here,
        &["recover", "a.recovered.mcap", "-o", "b.mcap", "--json"],
    );
    assert_eq!(code(&sound), 0, "{}", stderr(&sound));
    let summary: Value = serde_json::from_slice(&sound.stdout).expect("JSON");
    assert!(
        summary["n_messages"]
            .as_u64()
            .is_some_and(|count| count > 1000)
            && summary["losses"] == Value::Array(vec![])
    );
    let again = frfid(here, &["recover", "a.mcap.part"]);
    assert!(
        code(&again) == 2 && stderr(&again).contains("--force"),
        "{}",
        stderr(&again)
    );
    let part = frfid(here, &["recover", "a.mcap.part", "-o", "a.mcap", "--force"]);
    assert_eq!(code(&part), 2, "the input must not be written over");
    assert_eq!(
        fs::read(here.join("a.mcap.part")).expect("kept").len(),
        bytes.len() * 2 / 3
    );
}

#[test]
fn comparing_says_what_moved_and_what_that_means() {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    let stiffer = [
        (
            "stiffness_beyond_nm_per_rad = 1.5e5",
            "stiffness_beyond_nm_per_rad = 2.55e5",
        ),
        ("coulomb_nm = 50.0", "coulomb_nm = 0.0"),
    ];
    for kind in ["multisine", "chirp"] {
        let text = replaced(stdout(&frfid(here, &["init", kind])), &stiffer);
        let text = text.replace("realizations = 30", "realizations = 3");
        let (toml, logs, result) = (
            format!("{kind}.toml"),
            format!("{kind}-logs"),
            format!("{kind}.json"),
        );
        fs::write(here.join(&toml), text).expect("written");
        assert_eq!(code(&frfid(here, &["run", &toml, "-o", &logs])), 0);
        assert_eq!(code(&frfid(here, &["estimate", &logs, "-o", &result])), 0);
    }
    let compare = frfid(here, &["compare", "multisine.json", "chirp.json"]);
    let text = stdout(&compare);
    assert_eq!(code(&compare), 0, "{}", stderr(&compare));
    assert!(
        text.contains("B chirp.json   stronger excitation"),
        "{text}"
    );
    assert!(
        text.contains("verdict: stiffness grows with deflection")
            && text.contains("agreement: whether they agree within their noise is not known"),
        "{text}"
    );
    let machine = frfid(
        here,
        &[
            "compare",
            "multisine.json",
            "chirp.json",
            "--stronger",
            "a",
            "--json",
        ],
    );
    let value: Value = serde_json::from_slice(&machine.stdout).expect("JSON");
    assert_eq!(value["agreement"]["reason"], "blurred");
    assert_eq!(value["verdict_entry"], serde_json::json!([0, 0]));
    let verdict = value["verdict"].as_str().expect("a verdict");
    assert!(
        verdict.starts_with("stiffness falls with deflection"),
        "{verdict}"
    );
}

#[test]
fn the_demo_leaves_figures_results_and_a_report() {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    let demo = frfid(here, &["demo", "--json"]);
    assert_eq!(code(&demo), 0, "{}", stderr(&demo));
    let summary: Value = serde_json::from_slice(&demo.stdout).expect("JSON");
    let claims = summary["claims"].as_array().expect("claims");
    assert!(
        claims.len() >= 10 && claims.iter().all(|claim| claim["holds"] == true),
        "{summary}"
    );
    for name in [
        "figure_4_friction.svg",
        "figure_4_friction.png",
        "figure_5_stiffness.svg",
        "report.html",
    ] {
        assert!(here.join("frfid-demo").join(name).exists(), "{name}");
    }
    let five = [
        "frfid-demo/figure_5_multisine.json",
        "frfid-demo/figure_5_chirp.json",
    ];
    let compare = frfid(here, &["compare", five[0], five[1], "--stronger", "b"]);
    assert!(
        stdout(&compare).contains("stiffness grows with deflection"),
        "{}",
        stdout(&compare)
    );
    let again = frfid(here, &["demo"]);
    assert!(
        code(&again) == 2 && stderr(&again).contains("report.html exists"),
        "{}",
        stderr(&again)
    );
}

/// The measured two-mass motor bench, from MCAP and from CSV, with and without a map file.
#[test]
fn a_recording_that_is_not_ours_is_estimated_from_its_reference() {
    let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let (mcap, csv) = (
        data.join("rosbags/motor_bench_a.mcap"),
        data.join("motor_bench/multisine_type_a.csv.gz"),
    );
    if !(mcap.exists() && csv.exists()) {
        println!(
            "SKIPPED: {} and {} are not there",
            mcap.display(),
            csv.display()
        );
        return;
    }
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    let (mcap, csv) = (mcap.display().to_string(), csv.display().to_string());
    let map = "[[u]]\nsource = \"current_A\"\nunit = \"A\"\n[[y]]\nsource = \"motor_velocity_rad_per_s\"\nunit = \"rad/s\"\n\
               [[r]]\nsource = \"current_reference_A\"\nunit = \"A\"\n[time]\nsource = \"time_s\"\nunit = \"s\"\n";
    fs::write(here.join("map.toml"), map).expect("written");
    fs::write(
        here.join("bad.toml"),
        map.replace("unit = \"rad/s\"", "units = \"rad/s\""),
    )
    .expect("written");
    let (u, y) = (
        "/joint_states:effort[motor_joint]=A",
        "/joint_states:velocity[motor_joint]=rad/s",
    );
    let by_options = [
        "estimate",
        &mcap,
        "-o",
        "a.json",
        "--u",
        u,
        "--y",
        y,
        "--r",
        "/joint_commands:effort[0]=A",
        "--json",
    ];
    let by_file = [
        "estimate", &csv, "-o", "b.json", "--map", "map.toml", "--json",
    ];
    for arguments in [&by_options[..], &by_file] {
        let output = frfid(here, arguments);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let summary: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(
            (&summary["n_frequencies"], &summary["low_hz"]),
            (&240.into(), &11.0.into())
        );
        assert_eq!(
            (&summary["noise"]["degrees_of_freedom"], &summary["total"]),
            (&18.0.into(), &Value::Null)
        );
    }
    // response and noise covariance of both files agree number by number
    let [a, b] = ["a.json", "b.json"].map(|name| json(&here.join(name)));
    for place in [
        "/response/re",
        "/response/im",
        "/noise/covariance/re",
        "/noise/covariance/im",
    ] {
        let numbers = |result: &Value| -> Vec<f64> {
            let list = result
                .pointer(place)
                .and_then(Value::as_array)
                .expect(place);
            list.iter()
                .map(|number| number.as_f64().expect("a number"))
                .collect()
        };
        let (a, b) = (numbers(&a), numbers(&b));
        assert_eq!((a.len(), b.len()), (240, 240));
        let largest = a.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        assert!(
            a.iter()
                .zip(&b)
                .all(|(a, b)| (a - b).abs() <= 1e-9 * a.abs() + 1e-15 * largest),
            "{place} differs"
        );
    }
    let compare = frfid(here, &["compare", "a.json", "b.json", "--json"]);
    let entry =
        serde_json::from_slice::<Value>(&compare.stdout).expect("JSON")["entries"][0].clone();
    assert!(
        entry["difference_db"]
            .as_f64()
            .is_some_and(|difference| difference < 1e-8),
        "{entry}"
    );
    let hz = |place: usize| {
        entry["changes"][place]["a"]["frequency_hz"]
            .as_f64()
            .expect("a frequency")
    };
    assert!(
        (hz(0) - 53.0).abs() < 1.0 && (hz(1) - 77.0).abs() < 1.0,
        "{entry}"
    );

    let unknown_key = frfid(
        here,
        &["estimate", &csv, "-o", "c.json", "--map", "bad.toml"],
    );
    assert!(
        code(&unknown_key) == 2 && stderr(&unknown_key).contains("bad.toml:6:1"),
        "{}",
        stderr(&unknown_key)
    );
    let no_map = frfid(here, &["estimate", &mcap, "-o", "c.json"]);
    assert!(
        code(&no_map) == 2 && stderr(&no_map).contains("--map"),
        "{}",
        stderr(&no_map)
    );
    let half = frfid(
        here,
        &["estimate", &csv, "-o", "c.json", "--u", "current_A=A"],
    );
    assert!(
        code(&half) == 2 && stderr(&half).contains("--y"),
        "{}",
        stderr(&half)
    );
    let unit = frfid(
        here,
        &[
            "estimate",
            &csv,
            "-o",
            "c.json",
            "--u",
            "current_A",
            "--y",
            "a=rad/s",
        ],
    );
    assert!(
        code(&unit) == 2 && stderr(&unit).contains("SIGNAL=UNIT"),
        "{}",
        stderr(&unit)
    );
}
