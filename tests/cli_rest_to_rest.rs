//! Limits of changes at the command line: torque rate, acceleration and jerk, from the rest before a
//! run to the rest after it.

mod cli_binary;

use std::fs;
use std::path::Path;

use cli_binary::{code, frfid, replaced, stderr, stdout};
use tempfile::tempdir;

/// The example within the limits that libfranka publishes.
fn franka() -> String {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/examples/experiments/franka_joint.toml"
    );
    let text = fs::read_to_string(path).expect("an example");
    replaced(text, &[("realizations = 4", "realizations = 2")])
}

/// Exit code and message of the design of a description.
fn designed(here: &Path, text: &str) -> (i32, String) {
    fs::write(here.join("x.toml"), text).expect("written");
    let done = frfid(here, &["design", "x.toml", "-o", "plan.mcap", "--force"]);
    (code(&done), stderr(&done))
}

#[test]
fn the_limits_of_a_franka_hold_from_rest_to_rest() {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    let (exit, told) = designed(here, &franka());
    assert_eq!(exit, 0, "{told}");
    let done = frfid(here, &["run", "plan.mcap", "-o", "logs"]);
    assert_eq!(code(&done), 0, "{}", stderr(&done));
    let estimated = frfid(here, &["estimate", "logs", "-o", "frf.json"]);
    assert!(matches!(code(&estimated), 0 | 3), "{}", stderr(&estimated));

    let abrupt = replaced(franka(), &[("ramp_s = 0.5", "")]);
    let (exit, told) = designed(here, &abrupt);
    assert_eq!(exit, 2, "{told}");
    for said in ["max_effort_rate is 1000 N m/s", "[averaging] ramp_s"] {
        assert!(told.contains(said), "{told}");
    }
    let too_strong = replaced(franka(), &[("peak_nm = [5.0]", "peak_nm = [12.0]")]);
    let (exit, told) = designed(here, &too_strong);
    assert!(exit == 2 && !told.contains("ramp_s"), "{told}");
}

#[test]
fn a_step_of_90_nm_in_the_first_millisecond_is_refused_and_stopped() {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    let text = replaced(
        stdout(&frfid(here, &["init", "multisine"])),
        &[
            ("resolution_hz = 0.1", "resolution_hz = 2.0"),
            ("realizations = 30", "realizations = 2"),
            ("high_hz = 60.0", "high_hz = 12.0"),
        ],
    );
    let limited = format!("{text}\nmax_effort_rate = [41e3]\n");
    let (exit, told) = designed(here, &limited);
    assert!(
        exit == 2 && told.contains("max_effort_rate is 41000 N m/s"),
        "{exit}: {told}"
    );
    // without a design, straight from the description: stopped at its first sample
    let done = frfid(here, &["run", "x.toml", "-o", "logs"]);
    assert_eq!(code(&done), 3, "{}", stderr(&done));
    let ramped = replaced(limited, &[("periods = 1", "periods = 1\nramp_s = 0.2")]);
    let (exit, told) = designed(here, &ramped);
    assert_eq!(exit, 0, "{told}");
}
