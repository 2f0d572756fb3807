//! Console of a command: data to stdout, messages to stderr, every write checked.

use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::path::Path;

use anstream::adapter::strip_str;
use anstream::{AutoStream, ColorChoice};
use clap::builder::styling::{AnsiColor, Style};
use frfid_files::visible;
use serde_json::Value;

use crate::exit::{Exit, Failure, VERSION};

/// The two streams of a command and how to write to them.
pub(crate) struct Console<'a> {
    stdout: &'a mut dyn Write,
    stderr: &'a mut dyn Write,
    /// No progress and no notes; results, warnings and errors are always shown.
    pub quiet: bool,
    colour: ColorChoice,
    /// The reader of stdout has left (`| head`): nobody to write to any more, and no error.
    left: bool,
}

impl<'a> Console<'a> {
    /// With [`ColorChoice::Auto`] each stream is coloured as the process's own stream of that name
    /// would be: on a terminal unless `NO_COLOR` is set.
    pub(crate) fn new(
        stdout: &'a mut dyn Write,
        stderr: &'a mut dyn Write,
        quiet: bool,
        colour: ColorChoice,
    ) -> Self {
        Self {
            stdout,
            stderr,
            quiet,
            colour,
            left: false,
        }
    }

    /// Writes data to stdout, control characters visibly. A broken pipe is no error.
    ///
    /// # Errors
    /// [`Failure`] with the operating system's reason if stdout cannot be written.
    pub(crate) fn data(&mut self, text: &str) -> Result<(), Failure> {
        self.own_data(&visible(text))
    }

    /// Writes data of our own, which may hold ANSI colours, in the same way.
    ///
    /// # Errors
    /// As [`Console::data`].
    pub(crate) fn own_data(&mut self, text: &str) -> Result<(), Failure> {
        if self.left {
            return Ok(());
        }
        let text = painted(text, self.colour, &AutoStream::choice(&std::io::stdout()));
        let written = self.stdout.write_all(text.as_bytes());
        match written.and_then(|()| self.stdout.flush()) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.left = true;
                Ok(())
            }
            Err(error) => Err(Failure {
                exit: Exit::Failed,
                message: format!("cannot write to standard output: {error}"),
            }),
            Ok(()) => Ok(()),
        }
    }

    /// Writes what `--json` asks for to stdout, with its version.
    ///
    /// # Errors
    /// As [`Console::data`].
    pub(crate) fn json(&mut self, value: &Value) -> Result<(), Failure> {
        let mut value = value.clone();
        if let Value::Object(keys) = &mut value {
            keys.entry("version").or_insert_with(|| VERSION.into());
        }
        self.document(&value)
    }

    /// Writes a JSON value to stdout as it is.
    ///
    /// # Errors
    /// As [`Console::data`].
    pub(crate) fn document(&mut self, value: &Value) -> Result<(), Failure> {
        self.data(&format!("{value:#}\n"))
    }

    /// Tells how things go; nothing if `--quiet`.
    pub(crate) fn note(&mut self, message: impl Display) {
        if !self.quiet {
            self.message(None, &message.to_string());
        }
    }

    /// Tells which file was written; nothing if `--quiet`.
    pub(crate) fn wrote(&mut self, path: &Path) {
        self.note(format_args!("wrote {}", path.display()));
    }

    /// Tells which command comes next; nothing if `--quiet`.
    pub(crate) fn hint(&mut self, message: impl Display) {
        if !self.quiet {
            let label = Some(("next:", AnsiColor::Cyan));
            self.message(label, &message.to_string());
        }
    }

    /// Tells of something that is not as it should be.
    pub(crate) fn warning(&mut self, message: impl Display) {
        let label = Some(("warning:", AnsiColor::Yellow));
        self.message(label, &message.to_string());
    }

    /// Tells all of these in the same way.
    pub(crate) fn warnings(&mut self, messages: impl IntoIterator<Item: Display>) {
        for message in messages {
            self.warning(message);
        }
    }

    /// Tells why the command could not be done, to whom reads JSON as an object on one line.
    pub(crate) fn failed(&mut self, failure: &Failure, as_json: bool) {
        if as_json {
            self.message(None, &failure.as_json().to_string());
        } else {
            self.error(failure);
        }
    }

    /// Tells why the command could not be done.
    fn error(&mut self, failure: &Failure) {
        let label = match failure.exit {
            Exit::Interrupted => ("stopped:", AnsiColor::Yellow),
            _ => ("error:", AnsiColor::Red),
        };
        self.message(Some(label), &failure.message);
    }

    /// Writes a line to stderr, control characters visibly, behind a label.
    fn message(&mut self, label: Option<(&str, AnsiColor)>, text: &str) {
        let label = label.map(|(word, colour)| {
            let style = Style::new().bold().fg_color(Some(colour.into()));
            format!("{style}{word}{style:#} ")
        });
        self.own_message(&(label.unwrap_or_default() + &visible(text)));
    }

    /// Writes a line of our own, which may hold ANSI colours, to stderr. That stderr cannot be written can be told to
    /// nobody.
    pub(crate) fn own_message(&mut self, line: &str) {
        let line = painted(line, self.colour, &AutoStream::choice(&std::io::stderr()));
        writeln!(self.stderr, "{}", line.trim_end())
            .and_then(|()| self.stderr.flush())
            .ok();
    }
}

/// The text with its colours, or without them where `choice`, or `stream` if that is left to it,
/// wants none.
fn painted(text: &str, choice: ColorChoice, stream: &ColorChoice) -> String {
    let choice = if choice == ColorChoice::Auto {
        *stream
    } else {
        choice
    };
    if choice == ColorChoice::Never {
        strip_str(text).to_string()
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

    /// A stream whose every write fails.
    struct Broken(ErrorKind);
    impl Write for Broken {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }
        fn flush(&mut self) -> io::Result<()> {
            Err(self.0.into())
        }
    }

    #[test]
    fn a_reader_who_left_is_no_error_and_a_full_disk_is_one() {
        let mut stderr = Vec::new();
        let mut pipe = Broken(ErrorKind::BrokenPipe);
        let mut console = Console::new(&mut pipe, &mut stderr, false, ColorChoice::Never);
        assert!(console.data("a\n").is_ok() && console.data("b\n").is_ok());
        let mut disk = Broken(ErrorKind::StorageFull);
        let mut console = Console::new(&mut disk, &mut stderr, false, ColorChoice::Never);
        let failure = console.data("a\n").expect_err("the disk is full");
        assert_eq!(
            (failure.exit, failure.message.contains("no storage space")),
            (Exit::Failed, true)
        );
    }

    #[test]
    fn quiet_keeps_warnings_and_colours_come_when_asked_for() {
        for (choice, warning) in [
            (ColorChoice::Never, "warning: b\n"),
            (
                ColorChoice::Always,
                "\u{1b}[1m\u{1b}[33mwarning:\u{1b}[0m b\n",
            ),
        ] {
            let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
            let mut console = Console::new(&mut stdout, &mut stderr, true, choice);
            console.note("a");
            console.warning("b");
            assert_eq!(String::from_utf8_lossy(&stderr), warning);
        }
    }

    #[test]
    fn what_a_file_says_is_shown_and_does_nothing() {
        let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
        let mut console = Console::new(&mut stdout, &mut stderr, false, ColorChoice::Always);
        let clears = "tau\u{1b}[2J\u{9b}m";
        console.data(clears).expect("written");
        console
            .json(&serde_json::json!({ "name": clears }))
            .expect("written");
        console.note(clears);
        console.hint(clears);
        console.warning(clears);
        let told = [stdout, stderr].map(|told| String::from_utf8(told).expect("text"));
        assert_eq!(
            told.concat().matches(r"tau\u001b[2J\u009bm").count(),
            5,
            "{told:?}"
        );
        assert!(!told.concat().contains("\u{1b}[2J"), "{told:?}");
    }
}
