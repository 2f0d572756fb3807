//! The command line as a library: arguments and writers in, exit code out. The binary and the Python wheel call [`main`].

mod arguments;
mod command;
mod console;
mod exit;
mod interrupt;
mod log_map;
mod progress;
mod report;
mod summary;
mod table;

use std::ffi::OsString;
use std::io::Write;

use anstream::ColorChoice;

use crate::arguments::Arguments;
use crate::console::Console;
use crate::exit::{Exit, Failure};

/// Runs the command line `args`, the first of them the program's name, and returns the exit code: 0 done, 1 failed, 2 usage
/// or configuration, 3 done but data was lost or a check failed, 130 interrupted.
///
/// Data go to `stdout`, messages to `stderr`. Colours and progress bars follow the process's own streams (and `--color`,
/// `NO_COLOR`, `--quiet`); a bar is drawn on the process's stderr, from several threads: hand in `stderr()`, never its lock.
/// A command that takes long listens for Ctrl-C in the whole process from then on.
pub fn main(args: impl IntoIterator<Item = OsString>, stdout: &mut dyn Write, stderr: &mut dyn Write) -> i32 {
    let arguments = match Arguments::parse(args) {
        Ok(arguments) => arguments,
        Err(told) => return told_by_clap(&told, stdout, stderr) as i32,
    };
    let options = arguments.options;
    let mut console = Console::new(stdout, stderr, options.quiet, options.colour());
    let exit = arguments.run(&mut console).unwrap_or_else(|mut failure| {
        if interrupt::asked() {
            failure.exit = Exit::Interrupted;
        }
        console.error(&failure);
        failure.exit
    });
    exit as i32
}

/// Help and version are data; wrong usage is a message.
fn told_by_clap(told: &clap::Error, stdout: &mut dyn Write, stderr: &mut dyn Write) -> Exit {
    let text = told.render().ansi().to_string();
    let mut console = Console::new(stdout, stderr, false, ColorChoice::Auto);
    if told.use_stderr() {
        console.note(text);
        return Exit::Usage;
    }
    let told = console.data(&text).map(|()| Exit::Done);
    told.unwrap_or_else(|failure: Failure| {
        console.error(&failure);
        failure.exit
    })
}
