//! Design and run through the binary: limits, plans, repeats, interruptions, job arrays, and disks
//! that fail.

mod cli_binary;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use cli_binary::{code, frfid, replaced, stderr, stdout};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// Five short runs of the paper's joint, with friction.
const SMALL: [(&str, &str); 2] = [
    ("resolution_hz = 0.1", "resolution_hz = 1.0"),
    ("realizations = 30", "realizations = 5"),
];
/// Hundreds of long ones.
const LONG: [(&str, &str); 2] = [
    ("periods = 1", "periods = 3"),
    ("realizations = 30", "realizations = 200"),
];

/// A folder with `x.toml`: the multisine template with these replacements.
fn description(replacements: &[(&str, &str)]) -> TempDir {
    let folder = tempdir().expect("a temporary folder");
    let text = replaced(
        stdout(&frfid(folder.path(), &["init", "multisine"])),
        replacements,
    );
    fs::write(folder.path().join("x.toml"), text).expect("written");
    folder
}

/// Every file of a folder with its content.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("readable"));
    entries
        .map(|entry| {
            (
                entry.file_name().to_string_lossy().into(),
                fs::read(entry.path()).expect("read"),
            )
        })
        .collect()
}

#[test]
fn a_plan_and_its_description_give_the_same_runs_whatever_the_jobs() {
    let folder = description(&SMALL);
    let here = folder.path();
    let design = frfid(here, &["design", "x.toml", "-o", "plan.mcap"]);
    assert_eq!(code(&design), 0, "{}", stderr(&design));
    let text = stdout(&design);
    for told in [
        "period T",
        "line spacing f0",
        "lines",
        "crest factor",
        "150 N m  150 N m  100 %",
        "time on the robot",
    ] {
        assert!(text.contains(told), "{told} is not told in\n{text}");
    }
    let all = [
        ("one", "plan.mcap", "1"),
        ("four", "plan.mcap", "4"),
        ("toml", "x.toml", "0"),
    ];
    for (logs, order, jobs) in all {
        let run = frfid(here, &["run", order, "-o", logs, "--jobs", jobs]);
        assert_eq!(code(&run), 0, "{}", stderr(&run));
    }
    let one = contents(&here.join("one"));
    assert_eq!(
        one.keys().next().map(String::as_str),
        Some("p000-m0-q0.mcap")
    );
    assert!(
        one.len() == 5
            && one == contents(&here.join("four"))
            && one == contents(&here.join("toml"))
    );

    let again = frfid(here, &["design", "x.toml", "-o", "plan.mcap"]);
    assert!(
        code(&again) == 2 && stdout(&again).is_empty(),
        "refused before any work: {}",
        stderr(&again)
    );
    let seventh = frfid(
        here,
        &["design", "x.toml", "-o", "seven.mcap", "--seed", "7"],
    );
    assert_eq!(code(&seventh), 0);
    assert_ne!(
        fs::read(here.join("plan.mcap")).expect("read"),
        fs::read(here.join("seven.mcap")).expect("read")
    );
    let refused = frfid(here, &["run", "plan.mcap", "-o", "logs", "--seed", "7"]);
    assert!(
        code(&refused) == 2 && stderr(&refused).contains("frfid design"),
        "{}",
        stderr(&refused)
    );
}

#[test]
fn runs_that_are_there_are_skipped_and_others_are_not_overwritten() {
    let folder = description(&SMALL);
    let here = folder.path();
    let summary = |arguments: &[&str]| {
        let output = frfid(here, arguments);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let value: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        (
            value["written"].as_array().map(Vec::len),
            value["n_skipped"].as_u64(),
        )
    };
    // one run of a job array, then the others
    assert_eq!(
        summary(&["run", "x.toml", "-o", "logs", "--index", "3", "--json"]),
        (Some(1), Some(0))
    );
    assert!(here.join("logs/p003-m0-q0.mcap").exists());
    assert_eq!(
        summary(&["run", "x.toml", "-o", "logs", "--json"]),
        (Some(4), Some(1))
    );
    assert_eq!(
        summary(&["run", "x.toml", "-o", "logs", "--json"]),
        (Some(0), Some(5))
    );
    let beyond = frfid(here, &["run", "x.toml", "-o", "logs", "--index", "5"]);
    assert!(
        code(&beyond) == 2 && stderr(&beyond).contains("0 to 4"),
        "{}",
        stderr(&beyond)
    );

    let before = contents(&here.join("logs"));
    let other = frfid(here, &["run", "x.toml", "-o", "logs", "--seed", "2"]);
    assert!(
        code(&other) == 2 && stderr(&other).contains("--force"),
        "{}",
        stderr(&other)
    );
    assert_eq!(before, contents(&here.join("logs")));
    assert_eq!(
        code(&frfid(
            here,
            &["run", "x.toml", "-o", "logs", "--seed", "2", "--force"]
        )),
        0
    );
    assert_ne!(before, contents(&here.join("logs")));
}

#[test]
fn a_design_outside_its_limits_is_refused_with_the_amplitude_that_fits() {
    let folder = description(&[
        SMALL[0],
        SMALL[1],
        ("max_effort = [150.0]", "max_effort = [120.0]"),
    ]);
    let design = frfid(folder.path(), &["design", "x.toml", "-o", "plan.mcap"]);
    let told = stderr(&design);
    assert_eq!(code(&design), 2);
    assert!(
        told.contains("x.toml:") && told.contains("^^^^^^^") && told.contains("by 0.8 or less"),
        "{told}"
    );
    assert!(!folder.path().join("plan.mcap").exists());
    assert!(stdout(&design).contains("125 %"), "{}", stdout(&design));
    let run = frfid(folder.path(), &["run", "x.toml", "-o", "logs"]);
    assert!(
        code(&run) == 3 && stderr(&run).contains("stopped: axis 1: torque"),
        "{}",
        stderr(&run)
    );
}

#[test]
fn a_dry_run_writes_nothing() {
    let folder = description(&SMALL);
    for arguments in [
        ["design", "x.toml", "--dry-run", "--json"].as_slice(),
        &["run", "x.toml", "--dry-run", "--json"],
        &["run", "x.toml", "-o", "logs", "--dry-run", "--json"],
    ] {
        let output = frfid(folder.path(), arguments);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let value: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert!(
            value["prediction"]["peaks"]["effort_nm"][0]
                .as_f64()
                .is_some_and(|peak| (peak - 150.0).abs() < 0.1)
        );
        assert_eq!(contents(folder.path()).len(), 1);
    }
}

/// How many runs a folder holds.
fn n_runs(folder: &Path) -> usize {
    let entries = fs::read_dir(folder).expect("a folder");
    let names = entries.map(|entry| entry.expect("readable").file_name());
    let runs = names.filter(|name| name.to_string_lossy().ends_with(".mcap"));
    runs.count()
}

/// Starts a long campaign and waits until some runs are done.
fn begun(here: &Path) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frfid"));
    command
        .current_dir(here)
        .args(["run", "x.toml", "-o", "logs", "--jobs", "2"]);
    let child = command
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let started = Instant::now();
    while !here.join("logs/p002-m0-q0.mcap").exists() {
        assert!(
            started.elapsed() < Duration::from_secs(120),
            "no run was done"
        );
        sleep(Duration::from_millis(20));
    }
    child
}

#[cfg(unix)]
#[test]
fn an_interrupted_campaign_ends_cleanly_and_goes_on_where_it_stopped() {
    let folder = description(&LONG);
    let here = folder.path();
    for (signal, expected) in [("-INT", Some(130)), ("-TERM", Some(130)), ("-KILL", None)] {
        let child = begun(here);
        let sent = Command::new("kill")
            .args([signal, &child.id().to_string()])
            .status()
            .expect("kill exists");
        assert!(sent.success());
        let n_then = n_runs(&here.join("logs"));
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), expected, "{}", stderr(&output));
        if expected.is_some() {
            let n_kept = n_runs(&here.join("logs"));
            assert!(n_kept > n_then, "no run under way was finished");
            let told = stderr(&output);
            assert!(
                told.contains("Ctrl-C again") && told.contains("goes on from there"),
                "{told}"
            );
            assert!(
                contents(&here.join("logs"))
                    .keys()
                    .all(|name| name.ends_with(".mcap"))
            );
        }
        // three are enough to see that the next start goes on: the first ones are not done again
        let kept = fs::metadata(here.join("logs/p000-m0-q0.mcap"))
            .and_then(|file| file.modified())
            .expect("kept");
        let index = frfid(
            here,
            &["run", "x.toml", "-o", "logs", "--index", "0", "--json"],
        );
        let value: Value = serde_json::from_slice(&index.stdout).expect("JSON");
        assert_eq!(value["n_skipped"], 1, "{}", stderr(&index));
        let now = fs::metadata(here.join("logs/p000-m0-q0.mcap"))
            .and_then(|file| file.modified())
            .expect("kept");
        assert_eq!(kept, now);
        fs::remove_file(here.join("logs/p002-m0-q0.mcap")).expect("it was done");
    }
    // what the killed one left is no obstacle
    let again = frfid(here, &["run", "x.toml", "-o", "logs", "--index", "2"]);
    assert_eq!(code(&again), 0, "{}", stderr(&again));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_and_a_folder_that_cannot_be_written_are_told_as_such() {
    let folder = description(&SMALL);
    let here = folder.path();
    fs::create_dir(here.join("logs")).expect("made");
    std::os::unix::fs::symlink("/dev/full", here.join("logs/p001-m0-q0.mcap.part"))
        .expect("a link");
    let full = frfid(here, &["run", "x.toml", "-o", "logs"]);
    let told = stderr(&full);
    assert_eq!(code(&full), 1, "{told}");
    assert!(
        told.contains("No space left on device") && told.contains("p001-m0-q0.mcap"),
        "{told}"
    );
    assert!(!here.join("logs/p001-m0-q0.mcap").exists());
    for output in ["/proc/logs", "x.toml/logs", "/proc"] {
        let refused = frfid(here, &["run", "x.toml", "-o", output]);
        assert_eq!(code(&refused), 1, "{}", stderr(&refused));
        assert!(
            stderr(&refused).contains(output) && stderr(&refused).contains("cannot create"),
            "{}",
            stderr(&refused)
        );
    }
    let plan = frfid(here, &["design", "x.toml", "-o", "/proc/plan.mcap"]);
    assert!(
        code(&plan) == 1 && stderr(&plan).contains("/proc/plan.mcap"),
        "{}",
        stderr(&plan)
    );
}
