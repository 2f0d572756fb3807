//! The command line as a library: arguments and writers in, exit code out. The binary and the
//! Python wheel call [`main`].

mod arguments;
/// One file for each command: its arguments and what it does.
mod command {
    pub(crate) mod check;
    pub(crate) mod compare;
    pub(crate) mod completions;
    pub(crate) mod demo;
    pub(crate) mod design;
    pub(crate) mod estimate;
    pub(crate) mod export;
    pub(crate) mod import;
    pub(crate) mod init;
    pub(crate) mod inspect;
    pub(crate) mod man;
    pub(crate) mod recover;
    pub(crate) mod report;
    pub(crate) mod run;
    pub(crate) mod schema;
    pub(crate) mod shape;
}
mod console;
mod exit;
mod input;
mod interrupt;
mod log_map;
mod memory;
mod options;
mod player;
mod progress;
/// Texts for people: tables of what was designed, reached and checked.
mod text {
    pub(crate) mod checks;
    pub(crate) mod comparison;
    pub(crate) mod distortion;
    pub(crate) mod inspection;
    pub(crate) mod load;
    pub(crate) mod looked;
    pub(crate) mod plan;
    pub(crate) mod signal;
    pub(crate) mod strength;
    pub(crate) mod summary;
    pub(crate) mod table;
    pub(crate) mod verdicts;
}

use std::ffi::OsString;
use std::io::Write;

use anstream::ColorChoice;

use crate::arguments::Arguments;
use crate::console::Console;
use crate::exit::{Exit, Failure};

/// Runs the command line `args`, the first of them the program's name, and returns the exit code: 0
/// done, 1 failed, 2 usage, description or input, 3 done but data was lost or a check failed, 130
/// interrupted.
///
/// Data go to `stdout`, messages to `stderr`. Colours and progress bars follow the process's own
/// streams (and `--color`, `NO_COLOR`, `--quiet`); a bar is drawn on the process's stderr, from
/// several threads: hand in `stderr()`, never its lock. A command that takes long listens for
/// Ctrl-C in the whole process from then on.
pub fn main(
    args: impl IntoIterator<Item = OsString>,
    stdout: &mut dyn Write,
    stderr: &mut dyn Write,
) -> i32 {
    let args: Vec<OsString> = args.into_iter().collect();
    let as_json = asks_for_json(&args);
    let arguments = match Arguments::parse(args) {
        Ok(arguments) => arguments,
        Err(told) => return told_by_clap(&told, as_json, stdout, stderr) as i32,
    };
    let options = arguments.options;
    let mut console = Console::new(stdout, stderr, options.quiet, options.colour());
    let exit = arguments.run(&mut console).unwrap_or_else(|mut failure| {
        if interrupt::asked() {
            failure.exit = Exit::Interrupted;
        }
        console.failed(&failure, options.json);
        failure.exit
    });
    exit as i32
}

/// Whether a command line that cannot be read asks for JSON.
fn asks_for_json(args: &[OsString]) -> bool {
    let options = args.iter().take_while(|arg| *arg != "--");
    options.skip(1).any(|arg| arg == "--json")
}

/// Help and version are data; wrong usage is a message.
fn told_by_clap(
    told: &clap::Error,
    as_json: bool,
    stdout: &mut dyn Write,
    stderr: &mut dyn Write,
) -> Exit {
    let text = told.render().ansi().to_string();
    let mut console = Console::new(stdout, stderr, false, ColorChoice::Auto);
    if told.use_stderr() && as_json {
        let message = told.to_string();
        let message = message.strip_prefix("error: ").unwrap_or(&message);
        console.failed(&Failure::usage(message.trim_end()), true);
        return Exit::Usage;
    }
    if told.use_stderr() {
        console.own_message(&text);
        return Exit::Usage;
    }
    let told = console.own_data(&text).map(|()| Exit::Done);
    told.unwrap_or_else(|failure: Failure| {
        console.failed(&failure, as_json);
        failure.exit
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exit code, stdout and stderr of a command line.
    fn frfid(line: &str) -> (i32, String, String) {
        let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
        let args = format!("frfid --color never {line}");
        let exit = main(
            args.split_whitespace().map(OsString::from),
            &mut stdout,
            &mut stderr,
        );
        (
            exit,
            String::from_utf8_lossy(&stdout).into(),
            String::from_utf8_lossy(&stderr).into(),
        )
    }

    #[test]
    fn data_and_messages_go_to_the_writers_given() {
        let (exit, schema, silence) = frfid("schema");
        assert!(exit == 0 && schema.starts_with('{') && silence.is_empty());
        let (exit, silence, told) = frfid("check nowhere.toml");
        assert_eq!((exit, silence.as_str()), (2, ""));
        assert_eq!(
            told,
            "error: nowhere.toml: cannot read: No such file or directory (os error 2)\n"
        );
        let (exit, version, _) = frfid("--version");
        assert_eq!(
            (exit, version),
            (0, format!("frfid {}\n", env!("CARGO_PKG_VERSION")))
        );
        assert_eq!(frfid("check").0, 2);
    }

    #[test]
    fn under_json_an_error_is_an_object_on_the_last_line_of_stderr() {
        for line in [
            "check nowhere.toml --json",
            "check --json",
            "check . --json",
        ] {
            let (exit, silence, told) = frfid(line);
            assert_eq!((exit, silence.as_str()), (2, ""), "{line}");
            let told = told.lines().last().unwrap_or_default();
            let told: serde_json::Value = serde_json::from_str(told).expect(line);
            assert_eq!(
                (&told["version"], &told["error"]["exit_code"]),
                (&1.into(), &2.into())
            );
            let message = told["error"]["message"].as_str().expect("a text");
            assert!(
                !message.starts_with("error") && message.len() > 20,
                "{message}"
            );
        }
        let (_, _, told) = frfid("check -- --json");
        assert!(told.starts_with("error: --json: cannot read"), "{told}");
    }

    #[test]
    fn a_panic_in_the_work_is_no_silent_end() {
        let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
        let mut console = Console::new(&mut stdout, &mut stderr, true, ColorChoice::Never);
        let work = std::panic::AssertUnwindSafe(|| {
            progress::watched(&mut console, "a", "b", |_| panic!("a fault of ours"))
        });
        let panic = std::panic::catch_unwind(work).expect_err("the panic goes on");
        assert_eq!(panic.downcast_ref(), Some(&"a fault of ours"));
    }
}
