//! `frfid compare`: what moved between two FRFs, and what that says about the machine.

use frfid_signals::format::significant;
use std::path::PathBuf;

use clap::Args;
use frfid_estimate::{CompareOptions, EntryComparison, Side, Sides, compare};
use frfid_files::{ResultFile, read_result};
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::{Options, existing_path, named};
use crate::text::table::table;

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
    let stronger = arguments.stronger.or_else(|| stronger(&a, &b));
    let settings = CompareOptions {
        stronger,
        prominence_db: arguments.prominence_db,
        ..CompareOptions::default()
    };
    let comparison =
        compare(&a.frf, &b.frf, &settings).map_err(|error| Failure::of(Exit::Failed, &error))?;
    if options.json {
        let (low, high) = comparison.band_hz;
        console.json(&json!({ "low_hz": low, "high_hz": high, "entries": comparison.entries }))?;
        return Ok(Exit::Done);
    }
    let (low, high) = comparison.band_hz;
    let mark = |side| {
        if stronger == Some(side) {
            "   stronger excitation"
        } else {
            ""
        }
    };
    let name =
        |letter, path: &PathBuf, side| format!("{letter} {}{}\n", path.display(), mark(side));
    console.data(&format!(
        "{}{}band {} to {} Hz\n",
        name("A", &arguments.a, Side::A),
        name("B", &arguments.b, Side::B),
        significant(low, 5),
        significant(high, 5)
    ))?;
    for entry in &comparison.entries {
        let (input, output) = (&a.input_names[entry.input], &a.output_names[entry.output]);
        console.data(&format!("\n{input} to {output}\n{}", as_text(entry)))?;
    }
    Ok(Exit::Done)
}

/// The result with the larger rms torques on every axis, by a tenth at least; `None` where that is
/// not known.
fn stronger(a: &ResultFile, b: &ResultFile) -> Option<Side> {
    const CLEARLY: f64 = 1.1;
    let (a, b) = (a.torque_rms_nm.as_ref()?, b.torque_rms_nm.as_ref()?);
    let larger =
        |x: &[f64], y: &[f64]| x.len() == y.len() && x.iter().zip(y).all(|(x, y)| *x > CLEARLY * y);
    match (larger(a, b), larger(b, a)) {
        (true, false) => Some(Side::A),
        (false, true) => Some(Side::B),
        _ => None,
    }
}

/// The table of features, what differs elsewhere, and the verdicts.
fn as_text(entry: &EntryComparison) -> String {
    let mut rows = vec![
        ["", "A", "B", "shift", "damping A", "damping B", "level B/A"]
            .map(str::to_owned)
            .to_vec(),
    ];
    let number = |value: Option<f64>, unit: &str| {
        value.map_or_else(
            || "-".to_owned(),
            |value| format!("{}{unit}", significant(value, 4)),
        )
    };
    for change in &entry.changes {
        rows.push(vec![
            change.a.kind.name().to_owned(),
            number(Some(change.a.frequency_hz), " Hz"),
            number(change.b.map(|b| b.frequency_hz), " Hz"),
            change
                .shift_percent()
                .map_or_else(|| "-".into(), |percent| format!("{percent:+.1} %")),
            number(change.a.damping, ""),
            number(change.b.and_then(|b| b.damping), ""),
            change
                .level_db
                .map_or_else(|| "-".into(), |level| format!("{level:+.1} dB")),
        ]);
    }
    for feature in &entry.only_in_b {
        let mut row = vec!["-".to_owned(); 7];
        row[0] = feature.kind.name().to_owned();
        row[2] = number(Some(feature.frequency_hz), " Hz");
        row[5] = number(feature.damping, "");
        rows.push(row);
    }
    let Sides {
        a: a_phase,
        b: b_phase,
    } = entry.phase_range_deg;
    let mut text = table(&rows);
    text += &format!(
        "  over the band, B/A: median {:+.2} dB, median size {:.2} dB; phase spans {a_phase:.0} deg in A, {b_phase:.0} deg in B\n",
        entry.level_db, entry.difference_db
    );
    if entry.verdicts.is_empty() {
        text += "  verdict: nothing stands out\n";
    }
    entry.verdicts.iter().fold(text, |text, verdict| {
        format!("{text}  verdict: {verdict}\n")
    })
}
