//! The command line through the binary: help, streams, exit codes, and what it says about wrong
//! input.

mod cli_binary;

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

use cli_binary::{code, frfid, replaced, stderr, stdout};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// A folder with `x.toml`: the multisine template, `from` replaced by `to`.
fn description(from: &str, to: &str) -> TempDir {
    let folder = tempdir().expect("a temporary folder");
    let text = replaced(
        stdout(&frfid(folder.path(), &["init", "multisine"])),
        &[(from, to)],
    );
    fs::write(folder.path().join("x.toml"), text).expect("written");
    folder
}

#[test]
fn help_and_version_are_data_and_begin_with_examples() {
    let here = Path::new(".");
    let version = frfid(here, &["--version"]);
    assert_eq!(
        (code(&version), stdout(&version)),
        (0, format!("frfid {}\n", env!("CARGO_PKG_VERSION")))
    );
    for arguments in [
        vec!["--help"],
        vec!["design", "--help"],
        vec!["estimate", "-h"],
    ] {
        let help = frfid(here, &arguments);
        let text = stdout(&help);
        assert_eq!((code(&help), stderr(&help)), (0, String::new()));
        let (examples, usage) = (text.find("Examples:"), text.find("Usage:"));
        assert!(examples.is_some() && examples < usage, "{text}");
        assert!(
            text.lines().all(|line| line.chars().count() <= 110),
            "{text}"
        );
        assert!(!text.contains('\u{1b}'), "colours in a pipe");
    }
}

#[test]
fn wrong_usage_is_told_on_stderr_with_exit_code_2() {
    let folder = tempdir().expect("a temporary folder");
    let all: [&[&str]; 7] = [
        &[],
        &["desing"],
        &["init", "sawtooth"],
        &["check"],
        &["design", "x.toml"],
        &["estimate", "nowhere.mcap", "-o", "a.json"],
        &["man", "desing"],
    ];
    for arguments in all {
        let output = frfid(folder.path(), arguments);
        assert_eq!(
            (code(&output), stdout(&output)),
            (2, String::new()),
            "{arguments:?}"
        );
        assert!(!stderr(&output).is_empty(), "{arguments:?}");
    }
    let told = stderr(&frfid(folder.path(), &["desing"]));
    assert!(told.contains("design"), "no suggestion: {told}");
}

#[test]
fn a_template_is_sound_and_its_cost_is_told() {
    for kind in ["multisine", "chirp", "constant-velocity"] {
        let folder = tempdir().expect("a temporary folder");
        let made = frfid(folder.path(), &["init", kind, "-o", "x.toml"]);
        assert_eq!((code(&made), stdout(&made)), (0, String::new()));
        let check = frfid(folder.path(), &["check", "x.toml"]);
        assert_eq!(code(&check), 0, "{}", stderr(&check));
        assert!(stdout(&check).contains("time on the robot"));
    }
    let folder = description("realizations = 30", "realizations = 4");
    let check = frfid(folder.path(), &["check", "x.toml", "--json"]);
    let value: Value = serde_json::from_slice(&check.stdout).expect("JSON");
    assert_eq!(
        (&value["n_lines"], &value["n_runs"]),
        (&71.into(), &4.into())
    );
    assert_eq!(value["period_s"].as_f64(), Some(12.288));
}

#[test]
fn what_is_wrong_in_a_description_is_shown_with_its_place() {
    let all = [
        (
            "peak_nm = [150.0]",
            "peak_Nm = [150.0]",
            "^^^^^^^",
            "unknown field `peak_Nm`",
        ),
        ("low_hz = 1.0", "low_hz = -1.0", "^^^^", "-1"),
        ("low_hz = 1.0", "low_hz = nan", "^^^", "NaN"),
        ("high_hz = 60.0", "high_hz = 600.0", "^^^^^", "Nyquist"),
        (
            "sample_time_s = 0.001",
            "sample_time_s = \"1 ms\"",
            "^^^^^^",
            "needed a number",
        ),
        ("[limits]", "[limit]", "^^^^^", "unknown field `limit`"),
        ("grid = \"odd\"", "grid = \"even\"", "^^^^^^", "odd-random"),
    ];
    for (from, to, caret, reason) in all {
        let output = frfid(description(from, to).path(), &["check", "x.toml"]);
        let told = stderr(&output);
        assert_eq!(
            (code(&output), stdout(&output)),
            (2, String::new()),
            "{told}"
        );
        assert!(told.contains("x.toml:") && told.contains(reason), "{told}");
        assert_eq!(
            told.lines()
                .last()
                .map(|line| line.trim_start_matches([' ', '|'])),
            Some(caret),
            "{told}"
        );
    }
    let output = frfid(Path::new("."), &["check", "nowhere.toml"]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("nowhere.toml: cannot read: No such file"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn an_arm_in_urdf_becomes_a_description_that_names_it_from_where_it_stands() {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    fs::create_dir(here.join("arm")).expect("made");
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/robots/six_axis.urdf");
    fs::copy(urdf, here.join("arm/six.urdf")).expect("copied");
    for (output, file) in [("x.toml", "arm/six.urdf"), ("arm/x.toml", "six.urdf")] {
        let made = frfid(here, &["init", "urdf", "arm/six.urdf", "-o", output]);
        assert_eq!(code(&made), 0, "{}", stderr(&made));
        let text = fs::read_to_string(here.join(output)).expect("written");
        assert!(text.contains(&format!("file = \"{file}\"")), "{text}");
        let checked = frfid(here, &["check", output]);
        assert_eq!(code(&checked), 0, "{}", stderr(&checked));
    }
    let refused = frfid(here, &["init", "chirp", "--tip-link", "hand"]);
    assert_eq!(code(&refused), 2, "{}", stderr(&refused));
}

#[test]
fn a_drive_without_a_model_is_designed_and_what_needs_one_is_refused() {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    for line in [
        "init drive-axis -o x.toml",
        "check x.toml",
        "design x.toml -o plan.mcap",
        "inspect plan.mcap",
    ] {
        let done = frfid(here, &line.split(' ').collect::<Vec<_>>());
        assert_eq!(code(&done), 0, "{line}: {}", stderr(&done));
    }
    let told = frfid(here, &["design", "x.toml", "--dry-run", "--json"]);
    assert!(stderr(&told).contains("no model: only the signal"));
    let told: Value = serde_json::from_slice(&told.stdout).expect("JSON");
    let keys: Vec<&String> = told.as_object().expect("an object").keys().collect();
    assert_eq!(keys, ["limits", "plan", "signal", "version"]);
    for order in ["x.toml", "plan.mcap"] {
        let refused = frfid(here, &["run", order, "-o", "logs"]);
        assert_eq!(code(&refused), 2);
        let said = stderr(&refused);
        assert!(
            said.contains("no robot model") && said.contains("play the plan"),
            "{said}"
        );
    }
    let text = fs::read_to_string(here.join("x.toml")).expect("written");
    fs::write(
        here.join("x.toml"),
        text.replace("peak = [0.5]", "peak = [1.5]"),
    )
    .expect("written");
    let refused = frfid(here, &["design", "x.toml", "--dry-run"]);
    assert_eq!(code(&refused), 2);
    assert!(stderr(&refused).contains("axis_1 would reach 1.5 A, max_input is 1 A"));
}

#[test]
fn nothing_is_overwritten_without_force() {
    let folder = tempdir().expect("a temporary folder");
    let path = folder.path().join("x.toml");
    fs::write(&path, "mine").expect("written");
    let refused = frfid(folder.path(), &["init", "chirp", "-o", "x.toml"]);
    assert_eq!(code(&refused), 2);
    assert!(stderr(&refused).contains("--force"), "{}", stderr(&refused));
    assert_eq!(fs::read_to_string(&path).expect("kept"), "mine");
    assert_eq!(
        code(&frfid(
            folder.path(),
            &["init", "chirp", "-o", "x.toml", "--force"]
        )),
        0
    );
    assert!(
        fs::read_to_string(&path)
            .expect("replaced")
            .contains("[chirp]")
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_reader_who_leaves_is_no_error_and_a_full_disk_is_one() {
    let binary = env!("CARGO_BIN_EXE_frfid");
    for command in [
        "schema",
        "init multisine",
        "completions bash",
        "man",
        "--help",
    ] {
        // the pipe is closed before anything can be written to it
        let script =
            format!("(sleep 0.2; exec {binary} {command}; ) | true; echo ${{PIPESTATUS[0]}}");
        let output = Command::new("bash")
            .args(["-c", &script])
            .output()
            .expect("bash starts");
        assert_eq!(
            (stdout(&output).trim(), stderr(&output)),
            ("0", String::new()),
            "{command}"
        );
        let full = File::options()
            .write(true)
            .open("/dev/full")
            .expect("Linux has it");
        let mut process = Command::new(binary);
        let output = process
            .args(command.split(' '))
            .stdout(full)
            .stderr(Stdio::piped())
            .output()
            .expect("starts");
        assert_eq!(code(&output), 1, "{command}");
        assert!(
            stderr(&output).contains("No space left on device"),
            "{}",
            stderr(&output)
        );
    }
}

#[test]
fn machines_get_json_and_shells_their_completions() {
    let here = Path::new(".");
    let schema: Value = serde_json::from_slice(&frfid(here, &["schema"]).stdout).expect("JSON");
    assert!(schema["properties"]["multisine"].is_object());
    for shell in ["bash", "zsh", "fish"] {
        let script = stdout(&frfid(here, &["completions", shell]));
        assert!(
            script.contains("frfid") && script.contains("design") && script.contains("dry-run"),
            "{shell}"
        );
    }
    for (page, content) in [("frfid", "frfid compare"), ("design", "\\-\\-dry\\-run")] {
        let arguments = if page == "frfid" {
            vec!["man"]
        } else {
            vec!["man", page]
        };
        let text = stdout(&frfid(here, &arguments));
        assert!(
            text.contains(".SH EXAMPLES") && text.contains(content),
            "{text}"
        );
    }
}

#[test]
fn colours_come_only_when_asked_for() {
    let coloured = |arguments: &[&str], variable: (&str, &str)| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_frfid"));
        let output = command
            .env(variable.0, variable.1)
            .args(["check", "nowhere.toml"])
            .args(arguments)
            .output();
        stderr(&output.expect("the binary starts")).contains('\u{1b}')
    };
    let nothing = ("FRFID_NOTHING", "");
    assert!(!coloured(&[], nothing), "in a pipe");
    assert!(coloured(&["--color", "always"], nothing) && !coloured(&["--color", "never"], nothing));
    assert!(
        coloured(&[], ("FRFID_COLOR", "always"))
            && !coloured(&["--color", "never"], ("FRFID_COLOR", "always"))
    );
    assert!(coloured(&[], ("CLICOLOR_FORCE", "1")) && !coloured(&[], ("NO_COLOR", "1")));
}

#[test]
fn quiet_leaves_only_errors_on_stderr() {
    let folder = tempdir().expect("a temporary folder");
    let made = frfid(folder.path(), &["init", "chirp", "-o", "x.toml", "--quiet"]);
    assert_eq!((code(&made), stderr(&made)), (0, String::new()));
    let refused = frfid(folder.path(), &["init", "chirp", "-o", "x.toml", "--quiet"]);
    assert!(
        code(&refused) == 2 && stderr(&refused).starts_with("error: "),
        "{}",
        stderr(&refused)
    );
}
