//! Calls the binary as a user does.

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;

/// Runs `frfid` in `folder`.
pub(crate) fn frfid(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_frfid"));
    command
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the binary starts")
}

/// The exit code.
pub(crate) fn code(output: &Output) -> i32 {
    output.status.code().expect("ended by itself")
}

/// What it wrote to stdout.
pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

/// What it wrote to stderr.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

/// A text with these replacements, each of something that is there.
pub(crate) fn replaced(mut text: String, replacements: &[(&str, &str)]) -> String {
    for (from, to) in replacements {
        assert!(text.contains(from), "{from} is not in the text");
        text = text.replace(from, to);
    }
    text
}
