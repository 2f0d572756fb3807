//! Files and descriptions without measure, through the binary: names that are no UTF-8, memory,
//! work without end, unstable loops, recordings named twice.

mod cli_binary;

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::{Command, Output};

use cli_binary::{code, frfid, replaced, stderr, stdout};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// The multisine template with three realizations and replacements.
fn short(here: &Path, replacements: &[(&str, &str)]) -> String {
    let text = stdout(&frfid(here, &["init", "multisine"]));
    let short = [
        ("resolution_hz = 0.1", "resolution_hz = 1.0"),
        ("realizations = 30", "realizations = 3"),
    ];
    replaced(replaced(text, &short), replacements)
}

/// A folder with `x.toml`.
fn described(replacements: &[(&str, &str)]) -> TempDir {
    let folder = tempdir().expect("a temporary folder");
    let text = short(folder.path(), replacements);
    fs::write(folder.path().join("x.toml"), text).expect("written");
    folder
}

/// A folder with `x.toml`, its runs in `logs`.
fn campaign() -> TempDir {
    let folder = described(&[]);
    let run = frfid(folder.path(), &["run", "x.toml", "-o", "logs"]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    folder
}

/// Runs a line in which `%` stands for a byte that is no UTF-8.
fn frfid_bytes(here: &Path, line: &str) -> Output {
    let words = line.split(' ').map(|word| {
        let bytes = word
            .bytes()
            .map(|byte| if byte == b'%' { 0xff } else { byte });
        bytes.collect::<Vec<u8>>()
    });
    let mut command = Command::new(env!("CARGO_BIN_EXE_frfid"));
    command.current_dir(here);
    for word in words {
        command.arg(OsStr::from_bytes(&word));
    }
    command.output().expect("the binary starts")
}

#[test]
fn outputs_whose_names_are_no_utf8_are_told_as_json() {
    let folder = campaign();
    let here = folder.path();
    for line in [
        "init multisine -o %.toml",
        "design x.toml -o %.mcap",
        "run x.toml -o %",
        "estimate % -o %.json --report %.html",
        "export %.json -o %.csv",
        "export %.mcap --to csv -o played%",
        "report %.json -o other%.html",
        "recover %/p000-m0-q0.mcap -o %2.mcap",
        "inspect %.json %/p000-m0-q0.mcap",
    ] {
        let output = frfid_bytes(here, &format!("{line} --json"));
        let said = stderr(&output);
        assert!(matches!(code(&output), 0 | 3), "{line}: {said}");
        assert!(!said.contains("panicked"), "{line}: {said}");
        if !line.starts_with("design") {
            let told: Value = serde_json::from_slice(&output.stdout).expect(line);
            assert!(told.to_string().contains('\u{fffd}'), "{line}: {told}");
        }
    }
}

#[test]
fn what_would_not_fit_into_the_memory_is_refused_with_its_size() {
    let folder = campaign();
    let here = folder.path();
    let map = "--u /joint_commands:effort[0]=Nm --y /joint_states:velocity[0]=rad/s";
    for line in [
        "estimate logs -o frf.json".to_owned(),
        format!("estimate logs -o frf.json {map}"),
        "recover logs/p000-m0-q0.mcap".to_owned(),
    ] {
        let line = format!("{line} --force --max-memory");
        let words: Vec<&str> = line.split(' ').collect();
        let refused = frfid(here, &[&words[..], &["9k"]].concat());
        let said = stderr(&refused);
        assert_eq!(code(&refused), 2, "{line}: {said}");
        assert!(
            said.contains("--max-memory allows 9.0 kB; raise it"),
            "{said}"
        );
        let done = frfid(here, &[&words[..], &["1G"]].concat());
        assert!(matches!(code(&done), 0 | 3), "{line}: {}", stderr(&done));
    }
    let wrong = frfid(here, &["inspect", "logs", "--max-memory", "much"]);
    assert!(code(&wrong) == 2 && stderr(&wrong).contains("as 500M or 2G"));
}

#[test]
fn a_recording_named_twice_and_a_pipe_are_refused() {
    let folder = campaign();
    let here = folder.path();
    let log = "logs/p000-m0-q0.mcap";
    let twice = frfid(here, &["estimate", log, log, "-o", "frf.json"]);
    assert_eq!(code(&twice), 2);
    assert!(
        stderr(&twice).contains("p000-m0-q0.mcap twice"),
        "{}",
        stderr(&twice)
    );
    let pipe = frfid(here, &["estimate", "/dev/null", "-o", "frf.json"]);
    assert_eq!(code(&pipe), 2);
    assert!(
        stderr(&pipe).contains("a pipe, a socket or a device"),
        "{}",
        stderr(&pipe)
    );
}

#[test]
fn a_robot_whose_runs_would_not_end_and_a_torque_beyond_all_are_not_sound() {
    for (from, to, told) in [
        (
            "stiffness_nm_per_rad = 1.5e5",
            "stiffness_nm_per_rad = 1e15",
            "fastest resonance or decay is at",
        ),
        ("peak_nm = [150.0]", "peak_nm = [1e300]", "at most 1e12"),
    ] {
        let folder = tempdir().expect("a temporary folder");
        let here = folder.path();
        fs::write(here.join("x.toml"), short(here, &[(from, to)])).expect("written");
        let refused = frfid(here, &["check", "x.toml"]);
        let said = stderr(&refused);
        assert!(code(&refused) == 2 && said.contains(told), "{said}");
        assert!(!stdout(&refused).contains("is sound"));
    }
}

/// Gains 1 % beyond and below the critical one: the run of a loop that grows is flawed, whatever it reached.
#[test]
fn an_unstable_loop_is_not_sound_and_fails_its_run() {
    let folder = tempdir().expect("a temporary folder");
    for (gain, exit, verdict) in [(70_500.0, 3, "is not sound"), (69_300.0, 0, "is sound")] {
        let text = format!(
            "seed = 1\nsample_time_s = 0.001\n[robot.single_joint]\nmotor_inertia_kg_m2 = 35.0\n\
             link_inertia_kg_m2 = 150.0\ndamping_nms_per_rad = 400.0\nstiffness_nm_per_rad = 1.5e5\n\
             [controller]\ngain_nms_per_rad = [{gain}]\nintegral_gain_nm_per_rad = [0.0]\n\
             [multisine]\nlow_hz = 1.0\nhigh_hz = 60.0\nresolution_hz = 2.0\npeak_rad_s = [0.01]\n\
             [averaging]\nperiods = 2\n"
        );
        fs::write(folder.path().join("loop.toml"), text).expect("written");
        let checked = frfid(folder.path(), &["check", "loop.toml"]);
        assert_eq!(code(&checked), exit, "{}", stderr(&checked));
        assert!(stdout(&checked).starts_with(&format!("loop.toml {verdict}")));
        let checked = frfid(folder.path(), &["check", "loop.toml", "--json"]);
        let told: Value = serde_json::from_slice(&checked.stdout).expect("JSON");
        assert_eq!(told["is_sound"], exit == 0);
        let done = frfid(
            folder.path(),
            &["run", "loop.toml", "-o", "logs", "--force"],
        );
        assert_eq!(code(&done), exit, "{gain}: {}", stderr(&done));
    }
}

#[test]
fn more_jobs_than_runs_start_no_more_threads() {
    let folder = described(&[]);
    let run = frfid(
        folder.path(),
        &["run", "x.toml", "-o", "logs", "--jobs", "100000"],
    );
    assert_eq!(code(&run), 0, "{}", stderr(&run));
}
