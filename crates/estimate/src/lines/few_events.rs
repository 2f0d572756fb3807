//! Periodic signals that are no multisines: squares, trapezoids, triangles and the like, whose
//! harmonics fall without an end.

use num_complex::Complex64;

use crate::lines::cycle::synthesised;
use crate::lines::line_levels::LineLevels;

/// How excited lines end: the level of the last ones over the strongest one behind them (dB).
const END_DB: f64 = 10.0;
/// So few lines may be the first of many that fall fast, if the others are so close (dB).
const FEW: usize = 6;
const NEAR_DB: f64 = 30.0;
/// Lines that tell the level of the last ones.
const LAST: usize = 5;
/// Largest fall of excited lines without such an end; what is 60 dB down is not looked at.
const ENDLESS_DB: f64 = 54.0;
/// Fall from which on the shape of the signal is looked at.
const FALL_DB: f64 = 20.0;
/// Share of the energy of a derivative in its loudest tenth; 0.44 for normal numbers.
const FEW_EVENTS: f64 = 0.7;
/// Derivatives that are looked at: jumps, kinks, and jumps of the acceleration and the jerk.
const DERIVATIVES: i32 = 4;

/// How far the lines fall, as a ratio of amplitudes, if the signal moves by a few jumps or kinks, so
/// that it has no set of lines.
pub(super) fn few_events(
    levels: &LineLevels,
    spectrum: &[Complex64],
    n_samples: usize,
) -> Option<f64> {
    let excited = levels.excited();
    let all = levels.above_noise();
    // one line alone may be the first harmonic of many
    let lines = if is_first_of_many(levels, &excited, &all) {
        &all
    } else {
        &excited
    };
    let fall_db = endless_fall(levels, lines)?;
    let concentrated = |order| concentration(spectrum, lines, n_samples, order) > FEW_EVENTS;
    let is_few = fall_db >= ENDLESS_DB || fall_db >= FALL_DB && (1..=DERIVATIVES).any(concentrated);
    is_few.then(|| 10_f64.powf(fall_db / 20.0))
}

/// Whether there are few excited lines, and others that are not far below.
fn is_first_of_many(levels: &LineLevels, excited: &[usize], all: &[usize]) -> bool {
    let level = |line: &usize| levels.level_db[*line];
    let weakest = excited.iter().map(level).fold(f64::INFINITY, f64::min);
    let others = all.iter().filter(|line| !excited.contains(line));
    let strongest = others.map(level).fold(f64::NEG_INFINITY, f64::max);
    excited.len() < FEW && weakest - strongest < NEAR_DB
}

/// How far lines fall, in dB, if they do not end: `None` if they do.
fn endless_fall(levels: &LineLevels, lines: &[usize]) -> Option<f64> {
    let level = |&line: &usize| levels.level_db[line];
    let last = *lines.last()?;
    let mut ends: Vec<f64> = lines.iter().rev().take(LAST).map(level).collect();
    ends.sort_unstable_by(f64::total_cmp);
    let end = ends[ends.len() / 2];
    let spacing = lines.iter().rev().nth(1).map_or(1, |before| last - before);
    let behind = levels
        .level_db
        .iter()
        .skip(last + 1)
        .take((last / 4).max(24));
    let strongest = behind.clone().copied().fold(f64::NEG_INFINITY, f64::max);
    let has_end = behind.len() > 2 * spacing && end - strongest >= END_DB;
    let top = lines.iter().map(level).fold(f64::NEG_INFINITY, f64::max);
    (!has_end).then_some(top - end)
}

/// Share of the energy of a derivative in its loudest tenth; `spectrum` begins with line 1.
fn concentration(spectrum: &[Complex64], excited: &[usize], n_samples: usize, order: i32) -> f64 {
    let samples = synthesised(spectrum, excited, n_samples, order);
    let mut energy: Vec<f64> = samples.iter().map(|value| value * value).collect();
    energy.sort_unstable_by(|a, b| b.total_cmp(a));
    let loudest: f64 = energy.iter().take(n_samples / 10).sum();
    loudest / energy.iter().sum::<f64>().max(f64::MIN_POSITIVE)
}
