//! The next reference, with the peaks predicted for it, inside every limit.

use std::f64::consts::PI;
use std::iter::zip;

use frfid_signals::{Frf, Limit, Peaks, Record};
use nalgebra::DMatrix;
use ndarray::{Array1, Array2, Array3, ArrayView1, Axis, s};
use num_complex::Complex64;

use crate::shape::error::ShapeError;
use crate::shape::iteration::{Estimate, Iteration, Note};
use crate::shape::limits::{
    KEPT, Margins, exceeded, integral, peaks_of_signals, share_of_sample, travel_of,
};
use crate::shape::measure::stack;
use crate::shape::options::{ShapeOptions, Target};
use crate::shape::spectra::Band;
use crate::shape::step::{answer, step};

/// Length of the fades at both ends of a step, in periods of the lowest frequency.
const FADE_PERIODS: f64 = 0.25;
/// Share of the limits up to which a step is shortened around one moment: what is left of them
/// keeps the small rest that such a step moves elsewhere from blocking the whole of it.
const LOCAL_ROOM: f64 = 0.97;
/// Stuck share of the sweep from which the response to the reference tells nothing of how an axis
/// will move.
const MOSTLY_STUCK: f64 = 0.5;

/// A reference that has not been applied yet.
pub(super) struct Proposal {
    /// `(experiment, channel, sample)` in rad/s.
    pub reference: Array3<f64>,
    /// Peaks it is predicted to lead to, without margin.
    pub predicted: Peaks,
    /// What shortened the step.
    pub notes: Vec<Note>,
}

/// A signal of the last runs and how the whole step is predicted to change it,
/// `(experiment, axis, sample)`.
struct Trace {
    limit: Limit,
    from: Array3<f64>,
    change: Array3<f64>,
    /// Whether the change is known, as that of the reference is, or predicted.
    exact: bool,
}

impl Proposal {
    /// Refuses an initial reference that is itself beyond a limit of velocity or travel.
    pub fn check_start(start: &Array3<f64>, options: &ShapeOptions) -> Result<(), ShapeError> {
        let travel = integral(start, options.sample_time_s);
        let peaks = peaks_of_signals([&Array3::zeros(start.dim()), start, &travel]);
        match exceeded(&options.limits, &peaks).first() {
            Some(&excess) => Err(ShapeError::StartTooLarge(excess)),
            None => Ok(()),
        }
    }

    /// The step from an iteration with its estimate, with the damping of every line and channel.
    ///
    /// Where a predicted signal would leave its limits the step of all axes is shortened around
    /// that moment, in every experiment alike: of a chirp that concerns the frequencies of that
    /// moment only. Should that not be enough, since what follows from a changed reference is not
    /// confined to a moment, the whole step is shortened.
    pub fn after(
        from: &Iteration,
        estimate: &Estimate,
        band: &Band,
        desired: &[DMatrix<Complex64>],
        damping: &Array2<f64>,
        margins: &Margins,
        options: &ShapeOptions,
    ) -> Result<Self, ShapeError> {
        let signals = |record: fn(&Record) -> &Array2<f64>| {
            from.records.iter().map(move |of| record(of).view())
        };
        let (g, found) = match options.target {
            Target::Torque => (
                &estimate.r_to_u,
                band.all("u", signals(|record| &record.u))?,
            ),
            Target::Velocity => (
                &estimate.r_to_y,
                band.all("y", signals(|record| &record.y))?,
            ),
        };
        let mut change = band.signals(&step(band, &matrices(g), desired, &found, damping)?);
        change *= &from_rest(
            change.len_of(Axis(2)),
            (FADE_PERIODS / (options.low_hz * options.sample_time_s)) as usize,
        );
        let mut notes = limit_growth(&from.reference, &mut change, options.largest_change);
        let predict = |change: Array3<f64>| -> Result<[Trace; 5], ShapeError> {
            let spectra = band.all("step", change.axis_iter(Axis(0)))?;
            let answer = |g| band.signals(&answer(band, &matrices(g), &spectra));
            Ok(traces(
                from,
                change,
                [answer(&estimate.r_to_u), answer(&estimate.r_to_y)],
                options,
            ))
        };
        let mut traces = predict(change.clone())?;
        let (share, binding) = share_over_time(&traces, margins, LOCAL_ROOM, options);
        if binding.is_some() {
            notes.extend(binding);
            change *= &smooth_below(
                &share,
                (1.0 / (options.low_hz * options.sample_time_s)) as usize,
            );
            traces = predict(change)?;
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

/// Torque, velocity and travel of the motor, velocity and travel of the reference.
fn traces(
    from: &Iteration,
    change: Array3<f64>,
    [torque_change, mut velocity_change]: [Array3<f64>; 2],
    options: &ShapeOptions,
) -> [Trace; 5] {
    let (torque, mut velocity) = (
        stack(&from.records, |record| &record.u),
        stack(&from.records, |record| &record.y),
    );
    let mut travel = travel_of(&from.records, &velocity, options.sample_time_s);
    let reference_travel = integral(&from.reference, options.sample_time_s);
    for axis in (0..from.stuck_share.len()).filter(|&axis| from.stuck_share[axis] > MOSTLY_STUCK) {
        // an axis that sticks tells little of how it will move; at most it follows the reference
        let of_axis = s![.., axis, ..];
        velocity
            .slice_mut(of_axis)
            .assign(&from.reference.slice(of_axis));
        velocity_change
            .slice_mut(of_axis)
            .assign(&change.slice(of_axis));
        travel
            .slice_mut(of_axis)
            .assign(&reference_travel.slice(of_axis));
    }
    let travel_change = integral(&velocity_change, options.sample_time_s);
    let reference_travel_change = integral(&change, options.sample_time_s);
    let trace = |limit, from, change, exact| Trace {
        limit,
        from,
        change,
        exact,
    };
    [
        trace(Limit::Torque, torque, torque_change, false),
        trace(Limit::Velocity, velocity, velocity_change, false),
        trace(Limit::Travel, travel, travel_change, false),
        trace(Limit::Velocity, from.reference.clone(), change, true),
        trace(
            Limit::Travel,
            reference_travel,
            reference_travel_change,
            true,
        ),
    ]
}

/// Shortens the step of every axis until no peak of its reference grows by more than `factor`.
fn limit_growth(reference: &Array3<f64>, change: &mut Array3<f64>, factor: f64) -> Vec<Note> {
    let mut notes = Vec::new();
    for (axis, (reference, mut change)) in
        zip(reference.axis_iter(Axis(1)), change.axis_iter_mut(Axis(1))).enumerate()
    {
        let peak = reference.iter().fold(0.0, |peak: f64, r| peak.max(r.abs()));
        let shares =
            zip(&reference, &change).map(|(&r, &dr)| share_of_sample(r, dr, 1.0, factor * peak));
        let share = shares.fold(1.0, f64::min);
        if share < 1.0 {
            change *= share;
            notes.push(Note::ChangeLimited { axis, share });
        }
    }
    notes
}

/// The share of the step, sample by sample, with which every trace of every experiment stays inside
/// a share `room` of its limit, and what binds it most.
fn share_over_time(
    traces: &[Trace; 5],
    margins: &Margins,
    room: f64,
    options: &ShapeOptions,
) -> (Array1<f64>, Option<Note>) {
    let mut shares = Array1::ones(traces[0].from.len_of(Axis(2)));
    let mut binding = (1.0, None);
    for &Trace {
        limit,
        ref from,
        ref change,
        exact,
    } in traces
    {
        let kept = KEPT
            .iter()
            .position(|kept| *kept == limit)
            .unwrap_or_default();
        for (((_, axis, sample), &from), &change) in zip(from.indexed_iter(), change) {
            let margin = if exact { 1.0 } else { margins[kept][axis] };
            let share =
                share_of_sample(from, change, margin, room * options.limits.of(limit, axis));
            shares[sample] = share.min(shares[sample]);
            if share < binding.0 {
                let time_s = sample as f64 * options.sample_time_s;
                binding = (
                    share,
                    Some(Note::LimitAhead {
                        axis,
                        limit,
                        time_s,
                        share,
                    }),
                );
            }
        }
    }
    (shares, binding.1)
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

/// The matrices of an FRF.
fn matrices(frf: &Frf) -> Vec<DMatrix<Complex64>> {
    let matrix = |at: ndarray::ArrayView2<Complex64>| {
        DMatrix::from_fn(at.nrows(), at.ncols(), |i, j| at[[i, j]])
    };
    frf.response.outer_iter().map(matrix).collect()
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
