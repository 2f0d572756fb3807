//! `frfid recover`: what can be read of a damaged or half-written log.

use frfid_signals::format::count;
use std::path::{Path, PathBuf};

use clap::Args;
use frfid_files::{Recovered, path_text, recover};
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check};
use crate::memory::MemoryOption;
use crate::options::{Options, existing_path};

/// Salvage a damaged or half-written log: everything readable goes into a new file
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid recover logs/p003-m0-q0.mcap.part       writes logs/p003-m0-q0.recovered.mcap
  frfid recover robot.mcap -o robot2.mcap")]
pub(crate) struct Arguments {
    /// The damaged file
    #[arg(value_name = "FILE.mcap", value_parser = existing_path())]
    input: PathBuf,
    /// The file to write; NAME.recovered.mcap without it
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    memory: MemoryOption,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    arguments.memory.apply();
    check(&arguments.input, Needed::Log)?;
    let named = arguments.output.clone();
    let output = named.unwrap_or_else(|| beside(&arguments.input));
    let recovered = recover(&arguments.input, &output, options.overwrite())?;
    let lost = recovered.losses.iter().map(|loss| format!("lost: {loss}"));
    console.warnings(lost);
    if options.json {
        console.json(&json!({
            "output": path_text(&output),
            "n_messages": recovered.n_messages,
            "n_attachments": recovered.n_attachments,
            "n_metadata": recovered.n_metadata,
            "losses": recovered.losses.iter().map(ToString::to_string).collect::<Vec<_>>(),
        }))?;
    } else {
        console.data(&in_words(&output, &recovered))?;
    }
    Ok(Exit::flawed_unless(recovered.losses.is_empty()))
}

fn in_words(output: &Path, recovered: &Recovered) -> String {
    let n_messages = usize::try_from(recovered.n_messages).unwrap_or(usize::MAX);
    let messages = count(n_messages, "message");
    format!("{}: {messages} salvaged\n", output.display())
}

/// `logs/a.recovered.mcap` for `logs/a.mcap.part`.
fn beside(input: &Path) -> PathBuf {
    let name = input.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.strip_suffix(".part").unwrap_or(&name);
    let stem = stem.strip_suffix(".mcap").unwrap_or(stem);
    input.with_file_name(format!("{stem}.recovered.mcap"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_new_file_stands_beside_the_old_one() {
        for name in ["logs/a.mcap.part", "logs/a.mcap", "logs/a"] {
            assert_eq!(beside(Path::new(name)), Path::new("logs/a.recovered.mcap"));
        }
    }
}
