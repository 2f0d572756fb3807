//! Logs that do not belong together, through the binary: runs of another robot, plan or sample time
//! among the others.

mod cli_binary;

use std::fs;
use std::path::Path;
use std::process::Output;

use cli_binary::{code, frfid, replaced, stderr, stdout};
use tempfile::{TempDir, tempdir};

/// Folders `logs` with three short runs, and `others` with those of a description with one more
/// replacement.
fn campaigns(from: &str, to: &str) -> TempDir {
    let folder = tempdir().expect("a temporary folder");
    let here = folder.path();
    let small = [
        ("resolution_hz = 0.1", "resolution_hz = 1.0"),
        ("realizations = 30", "realizations = 3"),
    ];
    let text = replaced(stdout(&frfid(here, &["init", "multisine"])), &small);
    let other = replaced(text.clone(), &[(from, to)]);
    for (name, text) in [("logs", text), ("others", other)] {
        fs::write(here.join("x.toml"), text).expect("written");
        let run = frfid(here, &["run", "x.toml", "-o", name]);
        assert_eq!(code(&run), 0, "{}", stderr(&run));
    }
    folder
}

/// The runs of a folder, by name.
fn runs(here: &Path, name: &str) -> Vec<String> {
    let entries = fs::read_dir(here.join(name)).expect("a folder");
    let path = |entry: std::io::Result<fs::DirEntry>| {
        let name_of_file = entry.expect("readable").file_name();
        format!("{name}/{}", name_of_file.to_string_lossy())
    };
    let mut paths: Vec<String> = entries.map(path).collect();
    paths.sort();
    paths
}

fn estimate(here: &Path, paths: &[&str]) -> Output {
    let arguments = [&["estimate", "-o", "frf.json", "--force"], paths].concat();
    frfid(here, &arguments)
}

#[test]
fn a_run_of_another_robot_is_not_used_and_stops_nothing() {
    let folder = campaigns("coulomb_nm = 50.0", "coulomb_nm = 80.0");
    let here = folder.path();
    let (logs, others) = (runs(here, "logs"), runs(here, "others"));
    let mixed = estimate(here, &[&logs[0], &logs[1], &others[2]]);
    let said = stderr(&mixed);
    assert_eq!(code(&mixed), 3, "{said}");
    assert!(
        said.contains("not used: of another experiment or robot"),
        "{said}"
    );
    let two = estimate(here, &[&logs[0], &others[1]]);
    assert_eq!(code(&two), 2);
    let said = stderr(&two);
    assert!(said.contains("of another experiment or robot"), "{said}");
    assert!(
        said.contains(&logs[0]) && said.contains(&others[1]),
        "{said}"
    );
}

#[test]
fn a_run_of_another_sample_time_is_not_used() {
    let folder = campaigns("sample_time_s = 0.001", "sample_time_s = 0.002");
    let here = folder.path();
    let (logs, others) = (runs(here, "logs"), runs(here, "others"));
    let mixed = estimate(here, &[&others[2], &logs[0], &logs[1]]);
    let said = stderr(&mixed);
    assert_eq!(code(&mixed), 3, "{said}");
    assert!(
        said.contains("sampled every 0.002 s, the others every 0.001 s"),
        "{said}"
    );
}

/// Changes the first digit of a value in the metadata of a file, which no checksum covers.
fn damage(path: &Path, key: &str) {
    let mut bytes = fs::read(path).expect("readable");
    let place = bytes
        .windows(key.len())
        .position(|window| window == key.as_bytes());
    let digit = place.expect("its metadata") + key.len() + 4;
    bytes[digit] = if bytes[digit] == b'0' { b'1' } else { b'0' };
    fs::write(path, bytes).expect("written");
}

#[test]
fn of_two_runs_the_one_whose_record_is_damaged_is_not_used() {
    let folder = campaigns("coulomb_nm = 50.0", "coulomb_nm = 80.0");
    let here = folder.path();
    let (logs, others) = (runs(here, "logs"), runs(here, "others"));
    for (key, damaged, sound) in [
        ("config_sha256", &logs[0], &logs[1]),
        ("design_sha256", &others[1], &others[0]),
    ] {
        damage(&here.join(damaged), key);
        let both = estimate(here, &[damaged, sound]);
        let said = stderr(&both);
        assert_eq!(code(&both), 3, "{said}");
        assert!(
            said.contains(&format!("{damaged}: not used: of another")),
            "{said}"
        );
        assert!(
            said.contains("its metadata record frfid is damaged"),
            "{said}"
        );
        assert!(!said.contains(&format!("{sound}: not used")), "{said}");
    }
}
