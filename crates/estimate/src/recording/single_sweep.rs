//! Sweep that is there once: its frequency rises from part to part of the signal.

/// Parts that are compared.
const PARTS: usize = 8;
/// The last part must cross zero so many times more often than the first.
const RISE: f64 = 2.0;
/// A crossing counts when the signal goes as far beyond its mean, in rms: noise crosses more often.
const BEYOND: f64 = 0.5;

/// Whether the signal crosses its mean more and more often, from each eighth of it to the next.
pub(super) fn is_single_sweep(values: &[f64]) -> bool {
    let active = active(values);
    let counts: Vec<usize> = active
        .chunks(active.len().div_ceil(PARTS).max(1))
        .map(crossings)
        .collect();
    let rises = counts.windows(2).all(|pair| pair[0] < pair[1]);
    let (first, last) = (counts.first().copied(), counts.last().copied());
    let rise = first
        .zip(last)
        .is_some_and(|(first, last)| last as f64 >= RISE * first as f64);
    counts.len() == PARTS && rises && rise
}

/// What lies between the first and the last sample beyond half the rms.
fn active(values: &[f64]) -> &[f64] {
    let is_beyond = |value: &f64| value.abs() > BEYOND;
    let first = values.iter().position(is_beyond).unwrap_or(0);
    let last = values.iter().rposition(is_beyond).unwrap_or(0);
    values.get(first..=last).unwrap_or_default()
}

/// Changes between clearly above and clearly below the mean.
fn crossings(part: &[f64]) -> usize {
    let present = || part.iter().filter(|value| !value.is_nan());
    let count = present().count().max(1) as f64;
    let mean = present().sum::<f64>() / count;
    let rms = (present().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    let clear = present()
        .map(|value| value - mean)
        .filter(|value| value.abs() > BEYOND * rms);
    let signs: Vec<bool> = clear.map(|value| value > 0.0).collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}
