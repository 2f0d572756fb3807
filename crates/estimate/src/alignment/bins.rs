//! Bins of time, each with the mean of the samples in it: signals on a coarse even clock.

use ndarray::{Array2, ArrayView2};

/// Bins in the shortest period of the band.
const PER_PERIOD: f64 = 6.0;

/// Length of a bin in s for a band up to `high_hz`.
pub(super) fn bin_s(high_hz: f64) -> f64 {
    1.0 / (PER_PERIOD * high_hz)
}

/// Means of the finite samples in bins from `begin_s`; a bin without any lies on the line between its
/// neighbours.
pub(super) fn binned(
    times_s: &[f64],
    values: ArrayView2<f64>,
    begin_s: f64,
    bin_s: f64,
    n_bins: usize,
) -> Array2<f64> {
    let mut bins = Array2::zeros((values.nrows(), n_bins));
    for (row, mut bins) in values.rows().into_iter().zip(bins.rows_mut()) {
        let (mut sums, mut counts) = (vec![0.0; n_bins], vec![0.0; n_bins]);
        for (time_s, value) in times_s
            .iter()
            .zip(row)
            .filter(|(_, value)| value.is_finite())
        {
            let bin = ((time_s - begin_s) / bin_s) as usize; // negative: 0
            if let Some(sum) = sums.get_mut(bin) {
                *sum += value;
                counts[bin] += 1.0;
            }
        }
        bridge(&mut sums, &counts);
        bins.iter_mut()
            .zip(sums)
            .for_each(|(bin, mean)| *bin = mean);
    }
    bins
}

/// Makes means of sums, and lines over empty bins.
fn bridge(sums: &mut [f64], counts: &[f64]) {
    let full: Vec<usize> = (0..sums.len()).filter(|bin| counts[*bin] > 0.0).collect();
    for &bin in &full {
        sums[bin] /= counts[bin];
    }
    for pair in full.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (low, rise) = (sums[from], sums[to] - sums[from]);
        let between = sums[from..to].iter_mut().enumerate();
        between.for_each(|(k, sum)| *sum = low + rise * k as f64 / (to - from) as f64);
    }
    if let (Some(&first), Some(&last)) = (full.first(), full.last()) {
        let (begin, end) = (sums[first], sums[last]);
        sums[..first].fill(begin);
        sums[last..].fill(end);
    }
}
