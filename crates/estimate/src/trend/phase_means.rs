//! Elimination of what is periodic in a run: means over the samples of equal phase are taken off.
//!
//! What is left of a run has no periodic part of whatever waveform, and neither have regressors that
//! are treated alike: least squares between them is that of the full model (fixed effects; Frisch and
//! Waugh, Econometrica 1 (1933) 387).

use ndarray::{Array1, ArrayView1};

/// Parts of a period of which the fastest decay that is looked for has six.
const PARTS: f64 = 32.0;

/// Samples that are numbers, in time order.
pub(super) fn numbers(signal: ArrayView1<f64>) -> Vec<f64> {
    signal.iter().copied().filter(|x| x.is_finite()).collect()
}

/// The samples of a run that are numbers, by their phase.
pub(super) struct PhaseMeans {
    pub(super) period: f64,
    /// Time of every such sample, in samples.
    pub(super) times: Vec<f64>,
    /// Phase of each, rounded to a sample.
    phases: Vec<usize>,
    /// One over the number of samples of each phase.
    shares: Vec<f64>,
    /// Samples beyond one for each phase.
    pub(super) n_free: usize,
}

impl PhaseMeans {
    /// The samples of `signal`, whose period is so many samples, not necessarily whole.
    pub(super) fn of(signal: ArrayView1<f64>, period: f64) -> Self {
        let n_phases = period.round() as usize;
        let times: Vec<f64> = (signal.iter().enumerate())
            .filter(|(_, value)| value.is_finite())
            .map(|(k, _)| k as f64)
            .collect();
        let phase = |time: &f64| time.rem_euclid(period).round() as usize % n_phases;
        let phases: Vec<usize> = times.iter().map(phase).collect();
        let mut counts = vec![0_usize; n_phases];
        phases.iter().for_each(|&phase| counts[phase] += 1);
        let n_met = counts.iter().filter(|&&count| count > 0).count();
        Self {
            period,
            n_free: times.len() - n_met,
            shares: counts.iter().map(|&count| 1.0 / count as f64).collect(),
            times,
            phases,
        }
    }

    /// Samples in a part of a period.
    pub(super) fn part_length(&self) -> f64 {
        (self.period / PARTS).max(1.0)
    }

    /// Means of `values` of those samples over equal parts of each period, and their phases: enough to
    /// tell slow trends by, and few. NaN where there is no sample.
    pub(super) fn condensed(&self, values: &[f64]) -> Array1<f64> {
        let length = self.part_length();
        let part = |time: f64| ((time + 0.5) / length) as usize;
        let n_parts = self.times.last().map_or(0, |&last| part(last) + 1);
        let mut sums = Array1::zeros(n_parts);
        let mut counts = Array1::<f64>::zeros(n_parts);
        for (&time, value) in self.times.iter().zip(values) {
            sums[part(time)] += value;
            counts[part(time)] += 1.0;
        }
        sums / counts
    }

    /// Values of those samples without their periodic part.
    pub(super) fn without(&self, mut values: Vec<f64>) -> Vec<f64> {
        let mut means = vec![0.0; self.shares.len()];
        for (&phase, value) in self.phases.iter().zip(&values) {
            means[phase] += value * self.shares[phase];
        }
        for (&phase, value) in self.phases.iter().zip(&mut values) {
            *value -= means[phase];
        }
        values
    }
}
