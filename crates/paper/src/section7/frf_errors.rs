//! Errors of FRFs against the truth and against each other, and the peaks of FRFs.

use std::iter::zip;

use frfid_signals::{Frf, median};
use num_complex::Complex64;

use crate::against_truth::levels_db;

/// |20 lg |G/P|| of the diagonal entries.
pub(crate) fn diagonal_errors_db(frf: &Frf, truth: &Frf) -> Vec<f64> {
    errors_db(frf, truth, |output, input| output == input)
}

/// |20 lg |G/P|| of the entries 1 to 2 and 2 to 1.
pub(crate) fn cross_errors_db(frf: &Frf, truth: &Frf) -> Vec<f64> {
    errors_db(frf, truth, |output, input| output + input == 1)
}

/// |20 lg |G/P|| of the chosen entries, where it is finite.
fn errors_db(frf: &Frf, truth: &Frf, chosen: impl Fn(usize, usize) -> bool) -> Vec<f64> {
    let entries = frf.response.indexed_iter().zip(&truth.response);
    let chosen = entries.filter(|(((_, output, input), _), _)| chosen(*output, *input));
    chosen
        .filter_map(|((_, g), p)| difference_db(*g, *p))
        .collect()
}

/// |20 lg |A/B||, where it is finite.
fn difference_db(a: Complex64, b: Complex64) -> Option<f64> {
    Some((20.0 * (a.norm() / b.norm()).log10()).abs()).filter(|difference| difference.is_finite())
}

/// Largest difference in dB between two estimates over the diagonal entries.
pub(crate) fn spikes_db(frf: &Frf, smooth: &Frf) -> f64 {
    diagonal_errors_db(frf, smooth)
        .into_iter()
        .fold(0.0, f64::max)
}

/// Median of |20 lg |G_ab / G_ba|| over the frequencies.
pub(crate) fn disagreement_db(frf: &Frf, a: usize, b: usize) -> f64 {
    let lines = frf.response.outer_iter();
    middle(lines.filter_map(|g| difference_db(g[[a, b]], g[[b, a]])))
}

/// Frequency in Hz and magnitude in dB of the highest peak of every diagonal entry.
pub(crate) fn peaks(frf: &Frf) -> Vec<(f64, f64)> {
    (0..frf.n_outputs()).map(|axis| peak(frf, axis)).collect()
}

/// The highest peak of a diagonal entry above 10 Hz, where the rigid robot's own slope no longer
/// reaches it.
fn peak(frf: &Frf, axis: usize) -> (f64, f64) {
    let levels = levels_db(frf, axis).filter(|(hz, _)| *hz > 10.0);
    levels.fold((f64::NAN, f64::NEG_INFINITY), |highest, level| {
        if level.1 > highest.1 { level } else { highest }
    })
}

/// By how many dB every peak lies below that of the truth.
pub(crate) fn levels_below(
    found: &[(f64, f64)],
    truth: &[(f64, f64)],
) -> impl Iterator<Item = f64> {
    zip(found, truth).map(|(found, truth)| truth.1 - found.1)
}

/// The median; NaN without values.
pub(crate) fn middle(values: impl IntoIterator<Item = f64>) -> f64 {
    median(values.into_iter().collect()).unwrap_or(f64::NAN)
}
