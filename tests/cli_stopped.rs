//! Runs that a watch stopped, and runs that turned back on their constant velocity, through the
//! binary.

mod cli_binary;

use std::fs;
use std::path::Path;

use cli_binary::{code, frfid, replaced, stderr, stdout};
use serde_json::Value;
use tempfile::tempdir;

/// Writes `x.toml`: a template with these replacements.
fn describe(here: &Path, kind: &str, replacements: &[(&str, &str)]) {
    let text = replaced(stdout(&frfid(here, &["init", kind])), replacements);
    fs::write(here.join("x.toml"), text).expect("written");
}

#[test]
fn a_stopped_run_is_told_and_is_a_loss_to_the_estimate() {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    let short = [
        ("resolution_hz = 0.1", "resolution_hz = 1.0"),
        ("realizations = 30", "realizations = 5"),
    ];
    describe(here, "multisine", &short);
    let free = frfid(here, &["run", "x.toml", "-o", "free", "--json"]);
    assert_eq!(code(&free), 0, "{}", stderr(&free));
    let summary: Value = serde_json::from_slice(&free.stdout).expect("JSON");
    let runs = summary["written"].as_array().expect("a list");
    let mut peaks: Vec<f64> = runs
        .iter()
        .map(|run| run["peaks"]["velocity_rad_s"][0].as_f64().expect("known"))
        .collect();
    peaks.sort_by(f64::total_cmp);
    // only the fastest run is beyond it
    let limit = format!("[limits]\nmax_velocity = [{}]", 0.5 * (peaks[3] + peaks[4]));
    describe(
        here,
        "multisine",
        &[short[0], short[1], ("[limits]", &limit)],
    );
    let run = frfid(here, &["run", "x.toml", "-o", "logs"]);
    assert_eq!(code(&run), 3, "{}", stderr(&run));
    assert!(
        stderr(&run).contains("stopped: axis 1: velocity"),
        "{}",
        stderr(&run)
    );
    let again = frfid(here, &["run", "x.toml", "-o", "logs"]);
    assert!(
        code(&again) == 3 && stderr(&again).contains("was stopped before its end"),
        "{}",
        stderr(&again)
    );
    let forced = frfid(here, &["run", "x.toml", "-o", "logs", "--force"]);
    assert!(
        code(&forced) == 3 && stdout(&forced).contains("1 run written, 4 there already"),
        "{}",
        stdout(&forced)
    );
    let estimate = frfid(here, &["estimate", "logs", "-o", "frf.json"]);
    let told = stderr(&estimate);
    assert_eq!(code(&estimate), 3, "{told}");
    assert!(
        told.contains("stopped: axis 1: velocity") && told.contains("runs: 5, 1 with losses"),
        "{told}"
    );
}

#[test]
fn a_velocity_that_changes_its_sign_fails_its_check() {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    for (velocity, expected, word) in [("[0.25]", 0, "no"), ("[0.011]", 3, "YES")] {
        let short = [
            ("resolution_hz = 0.1", "resolution_hz = 1.0"),
            ("velocity_rad_s = [0.25]", ""),
        ];
        let velocity = format!("velocity_rad_s = {velocity}");
        describe(
            here,
            "constant-velocity",
            &[short[0], (short[1].0, velocity.as_str())],
        );
        let run = frfid(here, &["run", "x.toml", "-o", "logs", "--force"]);
        assert_eq!(code(&run), expected, "{}", stderr(&run));
        let row = stdout(&run)
            .lines()
            .find(|line| line.contains("velocity changes sign"))
            .map(str::to_owned);
        assert!(
            row.is_some_and(|row| row.contains(word)),
            "{}",
            stdout(&run)
        );
        let estimate = frfid(here, &["estimate", "logs", "-o", "frf.json", "--force"]);
        assert_eq!(code(&estimate), expected, "{}", stderr(&estimate));
        assert!(
            stdout(&estimate).contains("velocity keeps its sign: at the slowest"),
            "{}",
            stdout(&estimate)
        );
    }
}
