//! Export of a result: its FRF for other tools.

use std::path::Path;

use frfid_files::{EXPORTS, Export, path_text, read_result};
use serde_json::json;

use crate::command::export::{Arguments, ending, unfit};
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::Options;

/// The format that is asked for and that of the ending, which must not contradict each other.
fn format(to: Option<&'static Export>, output: &Path) -> Result<&'static Export, Failure> {
    let (path, named) = (output.display(), Export::of_suffix(output));
    match (to, named) {
        (Some(to), Some(named)) if to.name != named.name => Err(Failure::usage(format!(
            "--to {} and {path} contradict each other: .{} is the ending of another format; leave --to out, or choose another name",
            to.name, named.name
        ))),
        (Some(format), _) | (None, Some(format)) => Ok(format),
        (None, None) => Err(Failure::usage(format!(
            "{path}: found {}, needed: {}; name the file so, or say --to FORMAT",
            ending(output),
            endings()
        ))),
    }
}

/// Endings of all formats: `.csv, .npz or .mat`.
fn endings() -> String {
    let names = EXPORTS.map(|export| format!(".{}", export.name));
    let (last, others) = names.split_last().expect("there are formats");
    format!("{} or {last}", others.join(", "))
}

/// The format of this name.
fn named(name: &str) -> Result<&'static Export, Failure> {
    let mut formats = EXPORTS.iter();
    let export = formats.find(|export| export.name == name);
    export.ok_or_else(|| unfit(name, "a result", &names()))
}

fn names() -> String {
    EXPORTS.map(|export| export.name).join(", ")
}

pub(super) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    arguments.plan.refuse_with_result()?;
    let output = &arguments.output;
    let to = arguments.to.as_deref().map(named).transpose()?;
    let format = format(to, output)?;
    options.check_output(output, [&arguments.input])?;
    let result = read_result(&arguments.input)?;
    (format.write)(output, options.overwrite(), &result)?;
    if options.json {
        console.json(&json!({ "output": path_text(output) }))?;
    }
    console.wrote(output);
    Ok(Exit::Done)
}
