//! Periodic signals that are no multisines: squares, trapezoids, triangles and the like, whose
//! harmonics fall without an end.

use frfid_signals::median;
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
    let lines = lines_of_shape(levels);
    let fall_db = endless_fall(levels, &lines)?;
    let concentrated = |order| concentration(spectrum, &lines, n_samples, order) > FEW_EVENTS;
    let is_few = fall_db >= ENDLESS_DB || fall_db >= FALL_DB && (1..=DERIVATIVES).any(concentrated);
    is_few.then(|| 10_f64.powf(fall_db / 20.0))
}

/// The excited lines, or all above the noise: one line alone may be the first harmonic of many.
fn lines_of_shape(levels: &LineLevels) -> Vec<usize> {
    let (excited, all) = (levels.excited(), levels.above_noise());
    if is_first_of_many(levels, &excited, &all) {
        all
    } else {
        excited
    }
}

/// Whether there are few excited lines, and others that are not far below.
fn is_first_of_many(levels: &LineLevels, excited: &[usize], all: &[usize]) -> bool {
    let is_other = |line: &&usize| !excited.contains(line);
    let weakest = least(levels.of(excited));
    let strongest = largest(levels.of(all.iter().filter(is_other)));
    excited.len() < FEW && weakest - strongest < NEAR_DB
}

fn least(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::INFINITY, f64::min)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NEG_INFINITY, f64::max)
}

/// How far lines fall, in dB, if they do not end: `None` if they do.
fn endless_fall(levels: &LineLevels, lines: &[usize]) -> Option<f64> {
    let end = median(levels.of(lines.iter().rev().take(LAST)).collect())?;
    let top = largest(levels.of(lines));
    (!has_end(levels, lines, end)?).then_some(top - end)
}

/// Whether there are enough lines behind the last ones, and all far below their level `end_db`.
fn has_end(levels: &LineLevels, lines: &[usize], end_db: f64) -> Option<bool> {
    let last = *lines.last()?;
    let behind = levels.level_db.iter().skip(last + 1);
    let behind = behind.take((last / 4).max(24)).copied();
    let is_long = behind.len() > 2 * last_spacing(lines);
    Some(is_long && end_db - largest(behind) >= END_DB)
}

/// Between the last two lines.
fn last_spacing(lines: &[usize]) -> usize {
    match lines {
        [.., before, last] => last - before,
        _ => 1,
    }
}

/// Share of the energy of a derivative in its loudest tenth; `spectrum` begins with line 1.
fn concentration(spectrum: &[Complex64], excited: &[usize], n_samples: usize, order: i32) -> f64 {
    let samples = synthesised(spectrum, excited, n_samples, order);
    loudest_tenth(samples.iter().map(|value| value * value).collect())
}

/// Share of the sum.
fn loudest_tenth(mut energy: Vec<f64>) -> f64 {
    energy.sort_unstable_by(|a, b| b.total_cmp(a));
    let loudest: f64 = energy.iter().take(energy.len() / 10).sum();
    loudest / energy.iter().sum::<f64>().max(f64::MIN_POSITIVE)
}
