//! Summary of a result: inputs, outputs, frequencies and how far it may be from the truth.

use frfid_files::ResultFile;
use frfid_signals::format::significant;
use frfid_signals::{Frf, HarmonicLevel, Harmonics, Uncertainty};
use ndarray::Array3;
use serde::Serialize;

use crate::text::distortion::distortion_levels;

/// Inputs, outputs, frequencies and how well they are known.
pub(crate) fn summary(result: &ResultFile) -> Vec<(&'static str, String)> {
    let inputs = with_units(&result.input_names, &result.input_units);
    let outputs = with_units(&result.output_names, &result.output_units);
    let [noise, total] = Spread::noise_and_total(&result.frf);
    let noise_name = match (&noise, result.frf.relative_resolution) {
        (Some(_), Some(_)) => "noise and bias of excerpts",
        _ => "noise",
    };
    let mut rows = vec![
        ("inputs", inputs),
        ("outputs", outputs),
        ("frequencies", frequencies(&result.frf)),
        (noise_name, known(noise, "two periods")),
        ("noise and nonlinear", known(total, "two realizations")),
    ];
    let harmonics = result
        .harmonics
        .iter()
        .flat_map(|found| harmonics(found, &result.output_names));
    rows.extend(harmonics.map(|levels| ("harmonics", levels)));
    let distortion = result.distortion.iter();
    let distortion = distortion.flat_map(|found| distortion_levels(found, result));
    rows.extend(distortion.map(|levels| ("distortion", levels)));
    rows
}

/// The typical levels of the harmonics of every output: `joint_1 velocity: 2nd below -61 dB, 3rd -28 dB, ...`.
fn harmonics(found: &Harmonics, outputs: &[String]) -> Vec<String> {
    let of_output = |(channel, name): (usize, &String)| {
        let levels = found.output.levels(channel, &found.orders);
        let levels: Vec<String> = levels.iter().map(level).collect();
        let known = (!levels.is_empty()).then(|| levels.join(", "));
        known.map_or_else(
            || format!("{name}: not known, its fundamental does not stand out"),
            |levels| format!("{name}: {levels} of its fundamental (median)"),
        )
    };
    outputs.iter().enumerate().map(of_output).collect()
}

fn level(level: &HarmonicLevel) -> String {
    let suffix = match level.order {
        2 => "nd",
        3 => "rd",
        _ => "th",
    };
    let below = if level.is_bound { "below " } else { "" };
    format!("{}{suffix} {below}{:.0} dB", level.order, level.median_db)
}

/// Names with their units.
fn with_units(names: &[String], units: &[String]) -> String {
    let named = names
        .iter()
        .zip(units)
        .map(|(name, unit)| format!("{name} ({unit})"));
    named.collect::<Vec<_>>().join(", ")
}

/// How many frequencies there are, and from where to where.
fn frequencies(frf: &Frf) -> String {
    let n = frf.n_frequencies();
    match (frf.frequency_hz.first(), frf.frequency_hz.last()) {
        (Some(low), Some(high)) => {
            let (low, high) = (significant(*low, 5), significant(*high, 5));
            format!("{n}, {low} to {high} Hz")
        }
        _ => n.to_string(),
    }
}

/// The median relative standard deviation, or what it takes to know it.
fn known(spread: Option<Spread>, needed: &str) -> String {
    let Some(spread) = spread else {
        return format!("not available: it takes at least {needed}");
    };
    let degrees = match significant(spread.degrees_of_freedom, 3).as_str() {
        "1" => "1 degree of freedom".to_owned(),
        degrees => format!("{degrees} degrees of freedom"),
    };
    match spread.median_relative_deviation {
        Some(deviation) => {
            let percent = significant(100.0 * deviation, 2);
            format!("{percent} % of |G| (median), {degrees}")
        }
        None => format!("not a number, {degrees}"),
    }
}

/// How far an FRF may be from the true one.
#[derive(Serialize)]
pub(crate) struct Spread {
    degrees_of_freedom: f64,
    /// Median of standard deviation over magnitude, over all entries and frequencies.
    median_relative_deviation: Option<f64>,
}

impl Spread {
    /// That of the noise and that of noise and nonlinear distortion, where they are known.
    pub(crate) fn noise_and_total(frf: &Frf) -> [Option<Self>; 2] {
        [
            Self::of(frf, frf.noise.as_ref(), frf.noise_variance()),
            Self::of(frf, frf.total.as_ref(), frf.total_variance()),
        ]
    }

    fn of(frf: &Frf, known: Option<&Uncertainty>, variance: Option<Array3<f64>>) -> Option<Self> {
        let (known, variance) = (known?, variance?);
        Some(Self {
            degrees_of_freedom: known.degrees_of_freedom,
            median_relative_deviation: relative_deviation(frf, &variance),
        })
    }
}

fn relative_deviation(frf: &Frf, variance: &Array3<f64>) -> Option<f64> {
    let both = variance.iter().zip(&frf.response);
    let ratios = both.map(|(variance, g)| variance.sqrt() / g.norm());
    let mut ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.get(ratios.len() / 2).copied()
}
