//! `frfid compare`: what moved between two FRFs, and what that says about the machine.

use std::path::{Path, PathBuf};

use clap::Args;
use frfid_estimate::{Change, CompareOptions, EntryComparison, Feature, Side, Sides, compare};
use frfid_files::{ResultFile, read_result};
use frfid_signals::format::significant;
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::{Options, existing_path, named};
use crate::text::table::{or_dash, row, table};

/// Compare two FRFs: shifts of resonances and antiresonances, damping, and what it says about
/// stiffness and friction
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
    let (a, b) = (read_result(&arguments.a)?, read_result(&arguments.b)?);
    let settings = CompareOptions {
        stronger: arguments.stronger.or_else(|| stronger(&a, &b)),
        prominence_db: arguments.prominence_db,
        ..CompareOptions::default()
    };
    let comparison = compare(&a.frf, &b.frf, &settings).map_err(|error| Failure::failed(&error))?;
    if options.json {
        let (low, high) = comparison.band_hz;
        console.json(&json!({
            "low_hz": low,
            "high_hz": high,
            "unknown_lines": comparison.unknown_lines,
            "entries": comparison.entries,
        }))?;
        return Ok(Exit::Done);
    }
    console.data(&heading(arguments, settings.stronger, comparison.band_hz))?;
    console.data(&unknown(comparison.unknown_lines))?;
    for entry in &comparison.entries {
        let (input, output) = (&a.input_names[entry.input], &a.output_names[entry.output]);
        console.data(&format!("\n{input} to {output}\n{}", as_text(entry)))?;
    }
    Ok(Exit::Done)
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

/// The table of features, what differs elsewhere, and the verdicts.
fn as_text(entry: &EntryComparison) -> String {
    let Sides { a, b } = entry.phase_range_deg;
    let mut text = features(entry);
    text += &format!(
        "  over the band, B/A: median {:+.2} dB, median size {:.2} dB; phase spans {a:.0} deg in A, {b:.0} deg in B\n",
        entry.level_db, entry.difference_db
    );
    if entry.verdicts.is_empty() {
        text += "  verdict: nothing stands out\n";
    }
    for verdict in &entry.verdicts {
        text += &format!("  verdict: {verdict}\n");
    }
    text
}

/// A row for each resonance and antiresonance: those of A, beside those of B that they moved to,
/// and those that are in B alone.
fn features(entry: &EntryComparison) -> String {
    let title = ["", "A", "B", "shift", "damping A", "damping B", "level B/A"];
    let mut rows = vec![row(title)];
    rows.extend(entry.changes.iter().map(changed));
    rows.extend(entry.only_in_b.iter().map(only_in_b));
    table(&rows)
}

fn changed(change: &Change) -> Vec<String> {
    let shift = change.shift_percent();
    vec![
        change.a.kind.name().to_owned(),
        or_dash(Some(change.a.frequency_hz), in_hz),
        or_dash(change.b.map(|b| b.frequency_hz), in_hz),
        or_dash(shift, |percent| format!("{percent:+.1} %")),
        or_dash(change.a.damping, damping),
        or_dash(change.b.and_then(|b| b.damping), damping),
        or_dash(change.level_db, |level| format!("{level:+.1} dB")),
    ]
}

fn only_in_b(feature: &Feature) -> Vec<String> {
    let mut cells = row(["-"; 7]);
    cells[0] = feature.kind.name().to_owned();
    cells[2] = in_hz(feature.frequency_hz);
    cells[5] = or_dash(feature.damping, damping);
    cells
}

fn in_hz(frequency_hz: f64) -> String {
    format!("{} Hz", significant(frequency_hz, 4))
}

fn damping(damping: f64) -> String {
    significant(damping, 4)
}
