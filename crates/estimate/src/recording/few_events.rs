//! Periodic signals that are no multisines: squares, trapezoids, triangles and the like, whose
//! harmonics fall without an end.

use num_complex::Complex64;

use crate::recording::cycle::synthesised;
use crate::recording::line_levels::LineLevels;

/// How excited lines end: the level of the last ones over the strongest one behind them (dB).
const END_DB: f64 = 10.0;
/// Lines that tell the level of the last ones.
const LAST: usize = 5;
/// Largest fall of excited lines without such an end (60 dB).
const RANGE_DB: f64 = 60.0;
/// Fall from which on the shape of the signal is looked at.
const FALL_DB: f64 = 20.0;
/// Share of the energy of a derivative in its loudest tenth; 0.44 for normal numbers.
const FEW_EVENTS: f64 = 0.7;
/// Derivatives that are looked at: jumps, kinks, and jumps of the acceleration and the jerk.
const DERIVATIVES: i32 = 4;

/// How far excited lines fall, in dB, if they do not end: `None` if they do.
pub(super) fn endless_fall(levels: &LineLevels, excited: &[usize]) -> Option<f64> {
    let level = |&line: &usize| levels.level_db[line];
    let last = *excited.last()?;
    let mut ends: Vec<f64> = excited.iter().rev().take(LAST).map(level).collect();
    ends.sort_unstable_by(f64::total_cmp);
    let end = ends[ends.len() / 2];
    let reach = (last / 4).max(24);
    let spacing = excited.iter().rev().nth(1).map_or(1, |before| last - before);
    let behind = levels.level_db.iter().skip(last + 1).take(reach);
    let strongest = behind.clone().copied().fold(f64::NEG_INFINITY, f64::max);
    let has_end = behind.len() > 2 * spacing && end - strongest >= END_DB;
    let top = excited.iter().map(level).fold(f64::NEG_INFINITY, f64::max);
    (!has_end).then_some(top - end)
}

/// Whether excited lines that fall without an end are no set of lines, but those of a signal that
/// moves by a few jumps or kinks.
pub(super) fn is_few_events(fall_db: f64, spectrum: &[Complex64], excited: &[usize], n_samples: usize) -> bool {
    let concentrated = |order| concentration(spectrum, excited, n_samples, order) > FEW_EVENTS;
    fall_db >= RANGE_DB || fall_db >= FALL_DB && (1..=DERIVATIVES).any(concentrated)
}

/// Share of the energy of a derivative in its loudest tenth; `spectrum` begins with line 1.
fn concentration(spectrum: &[Complex64], excited: &[usize], n_samples: usize, order: i32) -> f64 {
    let samples = synthesised(spectrum, excited, n_samples, order);
    let mut energy: Vec<f64> = samples.iter().map(|value| value * value).collect();
    energy.sort_unstable_by(|a, b| b.total_cmp(a));
    let loudest: f64 = energy.iter().take(n_samples / 10).sum();
    loudest / energy.iter().sum::<f64>().max(f64::MIN_POSITIVE)
}
