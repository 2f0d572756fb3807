//! Proposal of the next reference, with the peaks predicted for it, inside every limit.

use std::f64::consts::PI;
use std::iter::zip;

use frfid_signals::{Frf, Peaks};
use ndarray::{Array1, Array2, Array3, ArrayView1, Axis, s};

use crate::error::EstimateError;
use crate::frf::matrices::{Matrix, matrices};
use crate::shape::error::ShapeError;
use crate::shape::iteration::{Estimate, Iteration};
use crate::shape::limits::{
    Margins, exceeded, integral, peak_of, peaks_of_signals, share_of_sample,
};
use crate::shape::note::Note;
use crate::shape::options::ShapeOptions;
use crate::shape::spectra::Band;
use crate::shape::step::{answer, step};
use crate::shape::trace::{Trace, share_over_time, traces};

/// Length of the fades at both ends of a step, in periods of the lowest frequency.
const FADE_PERIODS: f64 = 0.25;
/// Share of the limits up to which a step is shortened around one moment: what is left of them
/// keeps the small rest that such a step moves elsewhere from blocking the whole of it.
const LOCAL_ROOM: f64 = 0.97;

/// A reference that has not been applied yet.
pub(super) struct Proposal {
    /// `(experiment, channel, sample)` in rad/s.
    pub reference: Array3<f64>,
    /// Peaks it is predicted to lead to, without margin.
    pub predicted: Peaks,
    /// What shortened the step.
    pub notes: Vec<Note>,
}

/// The iteration from which a step is taken, and what it says of the machine.
pub(super) struct Origin<'a> {
    pub iteration: &'a Iteration,
    pub estimate: &'a Estimate,
    pub band: &'a Band,
    pub options: &'a ShapeOptions,
}

impl Proposal {
    /// Refuses an initial reference that is itself beyond a limit of velocity or travel.
    pub(super) fn check_start(
        start: &Array3<f64>,
        options: &ShapeOptions,
    ) -> Result<(), ShapeError> {
        let travel = integral(start, options.sample_time_s);
        let peaks = peaks_of_signals([&Array3::zeros(start.dim()), start, &travel]);
        match exceeded(&options.limits, &peaks).first() {
            Some(&excess) => Err(ShapeError::StartTooLarge(excess)),
            None => Ok(()),
        }
    }

    /// The step towards the desired spectra, with the damping of every line and channel.
    ///
    /// Where a predicted signal would leave its limits the step of all axes is shortened around
    /// that moment, in every experiment alike: of a chirp that concerns the frequencies of that
    /// moment only. Should that not be enough, since what follows from a changed reference is not
    /// confined to a moment, the whole step is shortened.
    pub(super) fn after(
        from: &Origin,
        desired: &[Matrix],
        damping: &Array2<f64>,
        margins: &Margins,
    ) -> Result<Self, ShapeError> {
        let options = from.options;
        let mut change = from.step(desired, damping)?;
        let reference = &from.iteration.reference;
        let mut notes = limit_growth(reference, &mut change, options.largest_change);
        let mut traces = from.traces(change.clone())?;
        let (share, binding) = share_over_time(&traces, margins, LOCAL_ROOM, options);
        if binding.is_some() {
            notes.extend(binding);
            change *= &smooth_below(&share, samples_of_periods(1.0, options));
            traces = from.traces(change)?;
        }
        let (share, binding) = share_over_time(&traces, margins, 1.0, options);
        notes.extend(binding);
        let share = share.iter().copied().fold(1.0, f64::min);
        let signal = |trace: &Trace| &trace.from + &(&trace.change * share);
        let [torque, velocity, travel, reference, _] = traces.each_ref().map(signal);
        Ok(Self {
            reference,
            predicted: peaks_of_signals([&torque, &velocity, &travel]),
            notes,
        })
    }
}

impl Origin<'_> {
    /// The whole step, as a change of the reference that begins and ends at rest.
    fn step(
        &self,
        desired: &[Matrix],
        damping: &Array2<f64>,
    ) -> Result<Array3<f64>, EstimateError> {
        let target = self.options.target;
        let records = self.iteration.records.iter();
        let signals = records.map(|record| target.signal(record).view());
        let found = self.band.all(target.channel(), signals)?;
        let g = matrices(self.estimate.response_of(target));
        let step = step(self.band, &g, desired, &found, damping)?;
        let mut change = self.band.signals(&step);
        let n_fade = samples_of_periods(FADE_PERIODS, self.options);
        change *= &from_rest(change.len_of(Axis(2)), n_fade);
        Ok(change)
    }

    /// What must stay inside its limits, and how a change of the reference is predicted to change
    /// it.
    fn traces(&self, change: Array3<f64>) -> Result<[Trace; 5], EstimateError> {
        let spectra = self.band.all("step", change.axis_iter(Axis(0)))?;
        let answer = |g: &Frf| {
            let answer = answer(self.band, &matrices(g), &spectra);
            self.band.signals(&answer)
        };
        let answers = [&self.estimate.r_to_u, &self.estimate.r_to_y].map(answer);
        let sample_time_s = self.options.sample_time_s;
        Ok(traces(self.iteration, change, answers, sample_time_s))
    }
}

/// So many periods of the lowest frequency in samples.
fn samples_of_periods(n_periods: f64, options: &ShapeOptions) -> usize {
    (n_periods / (options.low_hz * options.sample_time_s)) as usize
}

/// Shortens the step of every axis until no peak of its reference grows by more than `factor`.
fn limit_growth(reference: &Array3<f64>, change: &mut Array3<f64>, factor: f64) -> Vec<Note> {
    let mut notes = Vec::new();
    for (axis, (reference, mut change)) in
        zip(reference.axis_iter(Axis(1)), change.axis_iter_mut(Axis(1))).enumerate()
    {
        let largest = factor * peak_of(reference);
        let shares = zip(&reference, &change).map(|(&r, &dr)| share_of_sample(r, dr, 1.0, largest));
        let share = shares.fold(1.0, f64::min);
        if share < 1.0 {
            change *= share;
            notes.push(Note::ChangeLimited { axis, share });
        }
    }
    notes
}

/// 1 but for half-cosine fades of `n_fade` samples at both ends. Spectra are periodic, a run begins
/// at rest: a reference that jumped at its first sample would be answered by a torque far outside
/// the band, which nothing here foresees.
fn from_rest(n_samples: usize, n_fade: usize) -> Array1<f64> {
    let n_fade = n_fade.max(1);
    let fade = |k: usize| {
        0.5 - 0.5 * (PI * k.min(n_samples - 1 - k).min(n_fade) as f64 / n_fade as f64).cos()
    };
    (0..n_samples).map(fade).collect()
}

/// A smooth function below the given one: the mean over `half` samples to both sides of the least
/// value over as many.
fn smooth_below(values: &Array1<f64>, half: usize) -> Array1<f64> {
    let half = half.min(values.len());
    let around = |k: usize| s![k.saturating_sub(half)..(k + half + 1).min(values.len())];
    let over = |values: &Array1<f64>, of: fn(ArrayView1<f64>) -> f64| -> Array1<f64> {
        (0..values.len())
            .map(|k| of(values.slice(around(k))))
            .collect()
    };
    let least = over(values, |part| {
        part.iter().copied().fold(f64::INFINITY, f64::min)
    });
    over(&least, |part| part.sum() / part.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reference_begins_and_ends_at_rest() {
        let fade = from_rest(100, 10);
        assert!(fade[0] == 0.0 && fade[99] == 0.0 && (fade[5] - 0.5).abs() < 1e-12);
        assert!(fade.iter().skip(10).take(80).all(|&fade| fade == 1.0));
        assert_eq!(
            from_rest(4, 0).to_vec(),
            [0.0, 1.0, 1.0, 0.0],
            "a band near the Nyquist frequency"
        );
    }

    #[test]
    fn the_share_over_time_dips_only_around_what_binds_it() {
        let mut share = Array1::ones(1000);
        share[500] = 0.2;
        let smooth = smooth_below(&share, 50);
        assert!(zip(&smooth, &share).all(|(smooth, share)| smooth <= share));
        assert!((smooth[500] - 0.2).abs() < 1e-12 && smooth[399] == 1.0 && smooth[601] == 1.0);
        assert!(zip(&smooth, smooth.iter().skip(1)).all(|(a, b)| (a - b).abs() < 0.01));
        assert!(
            smooth_below(&share, usize::MAX)
                .iter()
                .all(|&share| (share - 0.2).abs() < 1e-12)
        );
    }
}
