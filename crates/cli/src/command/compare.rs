//! `frfid compare`: what moved between two FRFs, and what that says about the machine.

use std::path::{Path, PathBuf};

use clap::Args;
use frfid_estimate::{CompareOptions, Comparison, Side, Sides, compare};
use frfid_files::{ResultFile, read_result};
use frfid_signals::format::significant;
use serde_json::{Value, json};

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check};
use crate::options::{Options, existing_path, named};
use crate::text::comparison::entry_as_text;

/// Compare two FRFs: whether they agree within their noise, shifts of resonances and antiresonances,
/// damping, and what that says about stiffness, inertia and friction
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid compare multisine.json chirp.json --stronger b
  frfid compare before.json after.json --json")]
pub(crate) struct Arguments {
    /// Result of frfid estimate
    #[arg(value_name = "A.json", value_parser = existing_path())]
    a: PathBuf,
    /// Another one
    #[arg(value_name = "B.json", value_parser = existing_path())]
    b: PathBuf,
    /// Which was measured with the stronger excitation: tells stiffness that grows from one that
    /// falls; without this, the one with the larger torques, where both results know theirs
    #[arg(long, value_parser = named::<Side>(), value_name = "WHICH")]
    stronger: Option<Side>,
    /// Least height of a resonance, or depth of an antiresonance, in dB
    #[arg(long, value_name = "DB", default_value_t = CompareOptions::default().prominence_db)]
    prominence_db: f64,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    check(&arguments.a, Needed::Result)?;
    check(&arguments.b, Needed::Result)?;
    let (a, b) = (read_result(&arguments.a)?, read_result(&arguments.b)?);
    let settings = CompareOptions {
        stronger: arguments.stronger.or_else(|| stronger(&a, &b)),
        prominence_db: arguments.prominence_db,
        ..CompareOptions::default()
    };
    let comparison = compare(&a.frf, &b.frf, &settings);
    let comparison = comparison.map_err(|error| Failure::of(Exit::Usage, &error))?;
    if options.json {
        console.json(&as_json(&comparison))?;
        return Ok(Exit::Done);
    }
    console.data(&heading(arguments, settings.stronger, comparison.band_hz))?;
    console.data(&unknown(comparison.unknown_lines))?;
    console.data(&machine(&comparison, &a))?;
    for entry in &comparison.entries {
        let names = names(&a, (entry.output, entry.input));
        console.data(&format!("\n{names}\n{}", entry_as_text(entry)))?;
    }
    Ok(Exit::Done)
}

fn as_json(comparison: &Comparison) -> Value {
    let (low, high) = comparison.band_hz;
    let judgement = comparison.judgement.as_ref();
    json!({
        "low_hz": low,
        "high_hz": high,
        "unknown_lines": comparison.unknown_lines,
        "agreement": comparison.agreement,
        "verdict": judgement.map(|judgement| judgement.verdict),
        "verdict_entry": judgement.and_then(|judgement| judgement.entry),
        "entries": comparison.entries,
    })
}

/// An entry by the names of its channels.
fn names(result: &ResultFile, (output, input): (usize, usize)) -> String {
    format!(
        "{} to {}",
        result.input_names[input], result.output_names[output]
    )
}

/// Whether both agree, and the verdict on the machine.
fn machine(comparison: &Comparison, result: &ResultFile) -> String {
    let agreement = &comparison.agreement;
    let verdict = match &comparison.judgement {
        None => "nothing stands out".to_owned(),
        Some(judgement) => match judgement.entry.filter(|_| comparison.entries.len() > 1) {
            Some(entry) => format!("{} ({})", judgement.verdict, names(result, entry)),
            None => judgement.verdict.to_string(),
        },
    };
    format!("agreement: {agreement}\nverdict: {verdict}\n")
}

/// Both results, which of them was measured with the stronger excitation, and their common band.
fn heading(arguments: &Arguments, stronger: Option<Side>, (low, high): (f64, f64)) -> String {
    let a = result_line("A", &arguments.a, stronger == Some(Side::A));
    let b = result_line("B", &arguments.b, stronger == Some(Side::B));
    let (low, high) = (significant(low, 5), significant(high, 5));
    format!("{a}{b}band {low} to {high} Hz\n")
}

/// How many lines are not compared, because nothing is known of them; empty if none.
fn unknown(Sides { a, b }: Sides<usize>) -> String {
    match (a, b) {
        (0, 0) => String::new(),
        _ => format!("left out, not known: {a} lines of A, {b} lines of B\n"),
    }
}

fn result_line(letter: &str, path: &Path, is_stronger: bool) -> String {
    let mark = if is_stronger {
        "   stronger excitation"
    } else {
        ""
    };
    format!("{letter} {}{mark}\n", path.display())
}

/// The result with the larger rms torques on every axis, by a tenth at least; `None` where that is
/// not known.
fn stronger(a: &ResultFile, b: &ResultFile) -> Option<Side> {
    let (a, b) = (a.torque_rms_nm.as_ref()?, b.torque_rms_nm.as_ref()?);
    match (is_larger(a, b), is_larger(b, a)) {
        (true, false) => Some(Side::A),
        (false, true) => Some(Side::B),
        _ => None,
    }
}

/// Whether the torques of all axes are.
fn is_larger(torques: &[f64], others: &[f64]) -> bool {
    const CLEARLY: f64 = 1.1;
    let mut pairs = torques.iter().zip(others);
    torques.len() == others.len() && pairs.all(|(torque, other)| *torque > CLEARLY * other)
}
