//! `frfid compare`: what moved between two FRFs, and what that says about the machine.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use frfid_estimate::{
    Change, CompareOptions, Comparison, EntryComparison, Feature, FeatureKind, Side, compare,
};
use frfid_files::{ResultFile, read_result};
use serde_json::{Value, json};

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::{Options, existing_path};
use crate::table::{significant, table};

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
    #[arg(long, value_enum, value_name = "WHICH")]
    stronger: Option<Stronger>,
    /// Least height of a resonance, or depth of an antiresonance, in dB
    #[arg(long, value_name = "DB", default_value_t = CompareOptions::default().prominence_db)]
    prominence_db: f64,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Stronger {
    A,
    B,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let (a, b) = (read_result(&arguments.a)?, read_result(&arguments.b)?);
    let stronger = match arguments.stronger {
        Some(Stronger::A) => Some(Side::A),
        Some(Stronger::B) => Some(Side::B),
        None => stronger(&a, &b),
    };
    let settings = CompareOptions {
        stronger,
        prominence_db: arguments.prominence_db,
        ..CompareOptions::default()
    };
    let comparison =
        compare(&a.frf, &b.frf, &settings).map_err(|error| Failure::of(Exit::Failed, &error))?;
    if options.json {
        console.json(&as_json(&comparison))?;
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
    let rms = |result: &ResultFile| -> Option<Vec<f64>> {
        serde_json::from_str(result.provenance.get("effort_rms_nm")?).ok()
    };
    let (a, b) = (rms(a)?, rms(b)?);
    let larger =
        |x: &[f64], y: &[f64]| x.len() == y.len() && x.iter().zip(y).all(|(x, y)| *x > CLEARLY * y);
    match (larger(&a, &b), larger(&b, &a)) {
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
            kind(&change.a).to_owned(),
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
        row[0] = kind(feature).to_owned();
        row[2] = number(Some(feature.frequency_hz), " Hz");
        row[5] = number(feature.damping, "");
        rows.push(row);
    }
    let (a_phase, b_phase) = entry.phase_range_deg;
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

fn kind(feature: &Feature) -> &'static str {
    match feature.kind {
        FeatureKind::Resonance => "resonance",
        FeatureKind::Antiresonance => "antiresonance",
    }
}

fn as_json(comparison: &Comparison) -> Value {
    let entries = comparison.entries.iter().map(|entry| {
        let (a_phase, b_phase) = entry.phase_range_deg;
        json!({
            "output": entry.output,
            "input": entry.input,
            "changes": entry.changes.iter().map(change_as_json).collect::<Vec<_>>(),
            "only_in_b": entry.only_in_b.iter().map(feature_as_json).collect::<Vec<_>>(),
            "level_db": entry.level_db,
            "difference_db": entry.difference_db,
            "phase_range_deg": { "a": a_phase, "b": b_phase },
            "verdicts": entry.verdicts.iter().map(ToString::to_string).collect::<Vec<_>>(),
        })
    });
    let (low, high) = comparison.band_hz;
    json!({ "low_hz": low, "high_hz": high, "entries": entries.collect::<Vec<_>>() })
}

fn change_as_json(change: &Change) -> Value {
    json!({
        "a": feature_as_json(&change.a),
        "b": change.b.as_ref().map(feature_as_json),
        "shift_hz": change.shift_hz(),
        "shift_percent": change.shift_percent(),
        "damping_ratio": change.damping_ratio(),
        "level_db": change.level_db,
        "has_moved": change.has_moved(),
    })
}

fn feature_as_json(feature: &Feature) -> Value {
    json!({
        "kind": kind(feature),
        "frequency_hz": feature.frequency_hz,
        "resolution_hz": feature.resolution_hz,
        "magnitude_db": feature.magnitude_db,
        "prominence_db": feature.prominence_db,
        "damping": feature.damping,
    })
}
