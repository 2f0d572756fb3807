//! Files that an earlier commit wrote, 3b99278: its plan makes the same run, to the byte, its result is read
//! as it was, and its run gives that result to rounding.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use tempfile::tempdir;

const RUN: &str = "p000-m0-q0.mcap";

fn written(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/golden/written_by_3b99278")
        .join(name)
}

#[test]
fn files_of_an_earlier_commit_are_read_as_they_were() {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    for name in ["plan.mcap", RUN, "frf.json"] {
        fs::copy(written(name), here.join(name)).expect("copied");
    }
    for line in [
        "run plan.mcap -o logs",
        &format!("estimate {RUN} -o now.json"),
        "export now.json -o now.csv",
        "export frf.json -o then.csv",
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_frfid"));
        let done = command.current_dir(here).args(line.split(' ')).output();
        let done = done.expect("the binary starts");
        let told = String::from_utf8_lossy(&done.stderr);
        assert!(matches!(done.status.code(), Some(0 | 3)), "{line}: {told}");
    }
    let read = |name: &str| fs::read(here.join(name)).expect("written");
    assert!(read(&format!("logs/{RUN}")) == read(RUN), "another run");
    assert_same_result(&read("now.csv"), &read("then.csv"));
}

/// The same text, and numbers that agree to rounding: the transform of today adds in another order.
fn assert_same_result(now: &[u8], then: &[u8]) {
    let cells = |table: &[u8]| -> Vec<String> {
        let text = String::from_utf8_lossy(table).replace('\n', ",");
        text.split(',').map(str::to_owned).collect()
    };
    let (now, then) = (cells(now), cells(then));
    assert_eq!(now.len(), then.len(), "another table");
    for (now, then) in now.iter().zip(&then) {
        let is_same = match (now.parse::<f64>(), then.parse::<f64>()) {
            (Ok(now), Ok(then)) => (now - then).abs() <= 1e-13 * then.abs(),
            _ => now == then,
        };
        assert!(is_same, "{now} instead of {then}");
    }
}
