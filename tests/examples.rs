//! Every Rust lesson runs and prints its numbers; those that measure one joint draw it.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

#[test]
fn every_lesson_says_what_it_teaches() {
    let lessons = [
        ("01_excitations", "71 lines"),
        (
            "02_friction",
            "chirp: the peak at the resonance lies 4.8 dB below the truth",
        ),
        (
            "03_constant_velocity",
            "v = 0.25 rad/s: slowest +0.177 rad/s, largest error of the FRF 3.0e-10",
        ),
        (
            "04_stiffness",
            "stiffness grows with deflection: the stronger excitation finds the resonance at 14.5",
        ),
        (
            "05_uncertainty",
            "with one period the noise variance is None",
        ),
        ("06_closed_loop", "indirect: median error"),
        ("07_own_testbed", "to the last bit: true"),
        ("08_arm", "lag by 10.8 deg at 60 Hz"),
        ("09_shaping", "axis 2 sticks"),
    ];
    // `cargo test` builds the examples beside the binary; for this test alone: cargo build
    // --examples
    let folder = PathBuf::from(env!("CARGO_BIN_EXE_frfid")).with_file_name("examples");
    let pictures = tempfile::tempdir().expect("a folder for the pictures");
    for (lesson, says) in lessons {
        let output = Command::new(folder.join(lesson))
            .current_dir(pictures.path())
            .output()
            .expect(lesson);
        let told = String::from_utf8_lossy(&output.stdout);
        assert!(
            output.status.success() && told.contains(says),
            "{lesson}: {told}{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    for lesson in [
        "02_friction",
        "04_stiffness",
        "05_uncertainty",
        "06_closed_loop",
        "07_own_testbed",
    ] {
        let picture = fs::read_to_string(pictures.path().join(lesson).with_extension("svg"));
        let picture = picture.expect(lesson);
        assert!(
            picture.starts_with("<svg") && picture.trim_end().ends_with("</svg>"),
            "{lesson}"
        );
    }
}
