//! Iterative shaping through the binary: the trail on disk, going on after an interruption, and
//! what is refused.

mod cli_binary;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use cli_binary::{code, frfid, replaced, stderr, stdout};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// The paper's joint in closed loop, with friction, from a reference that does not move it.
const JOINT: &str = "\
seed = 1
sample_time_s = 0.001

[robot.single_joint]
motor_inertia_kg_m2 = 35.0
link_inertia_kg_m2 = 150.0
damping_nms_per_rad = 400.0
stiffness_nm_per_rad = 1.5e5
coulomb_nm = 50.0

[controller]
gain_nms_per_rad = [2000.0]
integral_gain_nm_per_rad = [16000.0]

[chirp]
low_hz = 2.0
high_hz = 60.0
duration_s = 6.0
fade_s = 0.2
tail_s = 1.0
amplitude_rad_s = [0.006]

[shape]
desired_nm = [200.0]
good_enough = 0.1

[limits]
max_effort = [1000.0]

[estimate]
n_frequencies = 60
";

/// A folder with `x.toml`: the joint, with these replacements.
fn description(replacements: &[(&str, &str)]) -> TempDir {
    let folder = tempdir().expect("a temporary folder");
    fs::write(
        folder.path().join("x.toml"),
        replaced(JOINT.to_owned(), replacements),
    )
    .expect("written");
    folder
}

/// Every file below a folder with its content.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("readable").path();
        if path.is_dir() {
            found.extend(contents(&path));
        } else {
            found.insert(path.clone(), fs::read(&path).expect("read"));
        }
    }
    found
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("written")).expect("JSON")
}

#[test]
fn a_joint_that_sticks_at_first_comes_to_the_desired_torque_and_everything_is_on_disk() {
    let folder = description(&[]);
    let here = folder.path();
    let shape = frfid(here, &["shape", "x.toml", "-o", "shaped"]);
    assert_eq!(code(&shape), 0, "{}", stderr(&shape));
    let told = stdout(&shape);
    for part in [
        "error in %",
        "worst octave in %",
        "stuck in %",
        "peak torque",
        "iteration 1: every axis was stuck",
        "the best is iteration",
    ] {
        assert!(told.contains(part), "{part} is not told in\n{told}");
    }
    let report = json(&here.join("shaped/shape.json"));
    let iterations = report["iterations"].as_array().expect("a list");
    let errors: Vec<f64> = iterations
        .iter()
        .map(|iteration| iteration["axis_error"][0].as_f64().expect("known"))
        .collect();
    assert!(
        errors[0] > 0.9 && errors[errors.len() - 1] < 0.1,
        "{errors:?}"
    );
    let last = &iterations[iterations.len() - 1];
    let octaves = last["octave_error"].as_array().expect("a list");
    let error = |octave: &Value| octave["axis_error"][0].as_f64().expect("known");
    let worst = octaves.iter().map(error).fold(0.0, f64::max);
    assert!(octaves.len() > 2 && worst > errors[errors.len() - 1]);
    assert!(
        last["stuck_share"][0]
            .as_f64()
            .is_some_and(|share| share < 0.15)
    );
    for number in 1..=iterations.len() {
        let iteration = here.join(format!("shaped/iteration_{number:02}"));
        for name in [
            &format!("p{number:03}-m0-q0.mcap"),
            "u_to_y.json",
            "response.json",
            "errors.csv",
        ] {
            assert!(
                iteration.join(name).exists() && iterations[number - 1]["files"][name].is_string(),
                "{name}"
            );
        }
    }
    // the FRF of the best iteration, by another way: from its record alone
    let of_last = format!("shaped/iteration_{:02}", iterations.len());
    let estimate = frfid(here, &["estimate", &of_last, "-o", "frf.json"]);
    assert_eq!(code(&estimate), 0, "{}", stderr(&estimate));
    let [ours, again] =
        ["shaped/frf.json", "frf.json"].map(|path| json(&here.join(path))["response"].clone());
    assert_eq!(ours, again);
    let mixed = frfid(
        here,
        &[
            "estimate",
            "shaped/iteration_02",
            &of_last,
            "-o",
            "both.json",
        ],
    );
    assert!(
        code(&mixed) == 2 && stderr(&mixed).contains("one plan at a time"),
        "{}",
        stderr(&mixed)
    );
}

/// Starts a shaping and waits until an iteration is done.
fn begun(here: &Path, iteration: usize) -> std::process::Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frfid"));
    command
        .current_dir(here)
        .args(["shape", "x.toml", "-o", "shaped"]);
    let child = command
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let started = Instant::now();
    while !here
        .join(format!(
            "shaped/iteration_{iteration:02}/p{iteration:03}-m0-q0.mcap"
        ))
        .exists()
    {
        assert!(
            started.elapsed() < Duration::from_secs(120),
            "no iteration was done"
        );
        sleep(Duration::from_millis(2));
    }
    child
}

#[cfg(unix)]
#[test]
fn an_interrupted_shaping_goes_on_to_the_same_bytes() {
    let long = [("duration_s = 6.0", "duration_s = 40.0")];
    let (whole, cut) = (description(&long), description(&long));
    let reference = frfid(
        whole.path(),
        &["shape", "x.toml", "-o", "shaped", "--jobs", "1"],
    );
    assert_eq!(code(&reference), 0, "{}", stderr(&reference));
    for (iteration, signal, expected) in [
        (1, "-INT", Some(130)),
        (2, "-KILL", None),
        (3, "-TERM", Some(130)),
    ] {
        let child = begun(cut.path(), iteration);
        let sent = Command::new("kill")
            .args([signal, &child.id().to_string()])
            .status()
            .expect("kill exists");
        assert!(sent.success());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), expected, "{}", stderr(&output));
        if expected.is_some() {
            let told = stderr(&output);
            assert!(
                told.contains("interrupted in iteration") && told.contains("goes on from there"),
                "{told}"
            );
        }
    }
    let first = cut.path().join("shaped/iteration_01/p001-m0-q0.mcap");
    let kept = fs::metadata(&first)
        .and_then(|file| file.modified())
        .expect("kept");
    let again = frfid(cut.path(), &["shape", "x.toml", "-o", "shaped"]);
    assert_eq!(
        (code(&again), stdout(&again)),
        (0, stdout(&reference)),
        "{}",
        stderr(&again)
    );
    assert_eq!(
        kept,
        fs::metadata(&first)
            .and_then(|file| file.modified())
            .expect("kept")
    );
    let all = |folder: &TempDir| {
        let files = contents(&folder.path().join("shaped")).into_iter();
        files
            .map(|(path, bytes)| {
                (
                    path.strip_prefix(folder.path()).expect("inside").to_owned(),
                    bytes,
                )
            })
            .collect()
    };
    let [whole, cut]: [BTreeMap<PathBuf, Vec<u8>>; 2] = [all(&whole), all(&cut)];
    assert_eq!(
        whole.keys().collect::<Vec<_>>(),
        cut.keys().collect::<Vec<_>>()
    );
    for (path, bytes) in &whole {
        assert!(cut[path] == *bytes, "{} differs", path.display());
    }
}

#[test]
fn a_folder_of_something_else_and_files_that_were_changed_are_refused() {
    let folder = description(&[]);
    let here = folder.path();
    let shape = |arguments: &[&str]| {
        frfid(
            here,
            &[&["shape", "x.toml", "-o", "shaped"], arguments].concat(),
        )
    };
    assert_eq!(code(&shape(&[])), 0);
    let before = contents(&here.join("shaped"));
    assert_eq!(code(&shape(&[])), 0, "done already");
    let other = shape(&["--seed", "2"]);
    assert!(
        code(&other) == 2 && stderr(&other).contains("another description"),
        "{}",
        stderr(&other)
    );
    assert!(stderr(&other).contains("--force"), "{}", stderr(&other));
    assert_eq!(before, contents(&here.join("shaped")));

    let record = here.join("shaped/iteration_02/p002-m0-q0.mcap");
    let mut bytes = fs::read(&record).expect("written");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&record, bytes).expect("written");
    let changed = shape(&[]);
    assert!(
        code(&changed) == 2 && stderr(&changed).contains("p002-m0-q0.mcap: found another content"),
        "{}",
        stderr(&changed)
    );
    fs::remove_file(&record).expect("there");
    assert_eq!(code(&shape(&[])), 0, "its run is done again");
    assert_eq!(before, contents(&here.join("shaped")));

    assert_eq!(code(&shape(&["--seed", "2", "--force"])), 0);
    assert_ne!(before, contents(&here.join("shaped")));
    fs::create_dir(here.join("mine")).expect("made");
    fs::write(here.join("mine/frf.json"), "mine").expect("written");
    let mine = frfid(here, &["shape", "x.toml", "-o", "mine"]);
    assert!(
        code(&mine) == 2 && stderr(&mine).contains("frf.json exists"),
        "{}",
        stderr(&mine)
    );
    assert_eq!(contents(&here.join("mine")).len(), 1);
}

/// What is changed in the description, where the message points, and what it says.
type Refusal<'a> = (&'a [(&'a str, &'a str)], &'a str, &'a str);

#[test]
fn what_shaping_needs_is_asked_for_at_its_place() {
    let shape = "\n[shape]\ndesired_nm = [200.0]\ngood_enough = 0.1\n";
    let controller =
        "\n[controller]\ngain_nms_per_rad = [2000.0]\nintegral_gain_nm_per_rad = [16000.0]\n";
    let open: &[(&str, &str)] = &[
        (controller, "\n"),
        ("amplitude_rad_s = [0.006]", "amplitude_nm = [10.0]"),
    ];
    let all: [Refusal; 7] = [
        (&[(shape, "")], "no [shape]: add this table", "^^^^^"),
        (open, "add a table [controller]", "^^^^^"),
        (
            &[("desired_nm = [200.0]", "")],
            "desired torque (desired_nm)",
            "^^^^^",
        ),
        (
            &[("desired_nm = [200.0]", "desired_nm = [200.0, 1.0]")],
            "one for each of the 1 axes",
            "^^^^^^^^^^^^",
        ),
        (
            &[("[1000.0]", "[150.0]")],
            "axis 1 desires 200 N m, beyond its max_effort of 150",
            "^^^^^^^",
        ),
        (
            &[("good_enough = 0.1", "damping = 1.5")],
            "damping is 1.5",
            "^^^",
        ),
        (
            &[("good_enough = 0.1", "good_enogh = 0.1")],
            "unknown field `good_enogh`",
            "^^^^^^^^^^",
        ),
    ];
    for (replacements, reason, caret) in all {
        let folder = description(replacements);
        let refused = frfid(folder.path(), &["shape", "x.toml", "-o", "shaped"]);
        let told = stderr(&refused);
        assert_eq!(
            (code(&refused), stdout(&refused)),
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
        assert!(!folder.path().join("shaped").exists());
    }
    let folder = description(&[]);
    let refused = frfid(folder.path(), &["shape", "x.toml", "-o", "/proc/shaped"]);
    assert!(
        code(&refused) == 1 && stderr(&refused).contains("/proc/shaped"),
        "{}",
        stderr(&refused)
    );
}

#[test]
fn a_torque_below_the_friction_is_said_loudly() {
    let folder = description(&[(
        "desired_nm = [200.0]",
        "desired_nm = [[[36.0, 200.0], [44.0, 40.0]]]",
    )]);
    let shape = frfid(
        folder.path(),
        &["shape", "x.toml", "-o", "shaped", "--quiet"],
    );
    assert_eq!(code(&shape), 3, "{}", stderr(&shape));
    assert!(
        stderr(&shape).contains("axis 1 sticks above 47.8 Hz")
            && stderr(&shape).contains("50 N m of friction"),
        "{}",
        stderr(&shape)
    );
    let checks = json(&folder.path().join("shaped/frf.json"))["checks"].clone();
    assert!(
        checks
            .as_array()
            .expect("a list")
            .iter()
            .any(|check| check["name"] == "no axis sticks" && check["passed"] == false)
    );
}
