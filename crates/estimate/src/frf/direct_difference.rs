//! Difference of the direct estimate, y over u (H1), from the one through the reference: noise that runs
//! around a loop is in u and y alike, and pulls the direct one towards the controller's negative inverse (R.
//! Pintelon, J. Schoukens, System Identification, 2nd ed., section 2.6.4).

use std::fmt;

use frfid_signals::format::significant;
use frfid_signals::{Frf, median};

/// Share of the lines that must differ beyond their 95 % region: as many would by chance, were the two
/// estimates independent; their errors are nearly the same.
const SHARE: f64 = 0.05;

/// A difference below this share of the response is rounding.
const ROUNDING: f64 = 1e-9;

/// How far the direct estimate is off the one through the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectDifference {
    /// Lines on which they differ by more than the 95 % region of the latter.
    pub n_lines: usize,
    /// Of how many.
    pub n_all: usize,
    /// Median over those lines, as a share of the response.
    pub median: f64,
    /// The largest, and where it is in Hz.
    pub largest: f64,
    /// Frequency of the largest in Hz.
    pub frequency_hz: f64,
}

/// For people.
impl fmt::Display for DirectDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f64| significant(100.0 * share, 2);
        write!(
            f,
            "y over u alone (H1) differs from the estimate through the reference by more than its uncertainty on {} of \
             {} lines, by {} % in the median and {} % at {} Hz: noise runs around the loop; the latter is not biased by it",
            self.n_lines,
            self.n_all,
            percent(self.median),
            percent(self.largest),
            significant(self.frequency_hz, 4),
        )
    }
}

/// The difference, if it is beyond the uncertainty on more lines than chance makes it.
pub(crate) fn direct_difference(through_reference: &Frf, direct: &Frf) -> Option<DirectDifference> {
    let known = through_reference
        .total
        .as_ref()
        .or(through_reference.noise.as_ref())?;
    let of_total = || through_reference.total_variance();
    let variance = of_total().or_else(|| through_reference.noise_variance())?;
    let factor = known.confidence_factor_95();
    let exceeds = |((k, o, i), value): ((usize, usize, usize), &num_complex::Complex64)| {
        let squared = (direct.response[[k, o, i]] - value).norm_sqr();
        let rounding = (ROUNDING * value.norm()).powi(2);
        let is_beyond = squared > (factor * variance[[k, o, i]]).max(rounding);
        is_beyond.then(|| (k, squared.sqrt() / value.norm()))
    };
    let beyond: Vec<(usize, f64)> = through_reference
        .response
        .indexed_iter()
        .filter_map(exceeds)
        .collect();
    let mut lines: Vec<usize> = beyond.iter().map(|(k, _)| *k).collect();
    lines.dedup();
    let n_all = through_reference.n_frequencies();
    let (at, largest) = beyond.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let is_told = lines.len() as f64 > SHARE * n_all as f64;
    is_told.then_some(DirectDifference {
        n_lines: lines.len(),
        n_all,
        median: median(beyond.iter().map(|(_, share)| *share).collect()).unwrap_or(largest),
        largest,
        frequency_hz: through_reference.frequency_hz[at],
    })
}
