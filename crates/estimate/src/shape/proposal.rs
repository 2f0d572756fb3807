//! The next reference, with the peaks predicted for it, inside every limit.

use std::iter::zip;

use frfid_signals::Frf;
use nalgebra::DMatrix;
use ndarray::{Array3, Axis, s};
use num_complex::Complex64;

use super::iteration::{Iteration, Note, Peaks};
use super::limits::{Quantity, integral, largest_share, travel_of};
use super::shaper::{STUCK, stack};
use super::spectra::Band;
use super::step::{answer, step};
use super::{ShapeError, ShapeOptions, Target};

/// A reference that has not been applied yet.
pub(super) struct Proposal {
    /// `(experiment, channel, sample)` in rad/s.
    pub reference: Array3<f64>,
    /// Peaks it is predicted to lead to, without margin.
    pub predicted: Peaks,
    /// What shortened the step.
    pub notes: Vec<Note>,
}

/// A signal of the last runs, how the whole step is predicted to change it, and the factor by which its peak must stay below
/// the limit; `(experiment, axis, sample)`.
struct Trace {
    quantity: Quantity,
    from: Array3<f64>,
    change: Array3<f64>,
    margin: f64,
}

impl Proposal {
    /// Refuses an initial reference that is itself beyond a limit of velocity or travel.
    pub fn check_start(start: &Array3<f64>, options: &ShapeOptions) -> Result<(), ShapeError> {
        let travel = integral(start, options.sample_time_s);
        let peaks = Peaks::of_signals([&Array3::zeros(start.dim()), start, &travel]);
        match options.limits.exceeded(&peaks).first() {
            Some(&Note::Exceeded { axis, quantity, found, limit }) => {
                Err(ShapeError::StartTooLarge { axis, quantity, found, limit })
            }
            _ => Ok(()),
        }
    }

    /// The step from an iteration whose runs were complete.
    pub fn after(
        from: &Iteration,
        band: &Band,
        desired: &[DMatrix<Complex64>],
        damping: f64,
        margin: f64,
        options: &ShapeOptions,
    ) -> Result<Self, ShapeError> {
        let Some(estimate) = &from.estimate else { return Err(ShapeError::NothingMeasured) };
        let (g_u, g_y) = (matrices(&estimate.r_to_u), matrices(&estimate.r_to_y));
        let (g, found) = match options.target {
            Target::Torque => (&g_u, band.all("u", from.records.iter().map(|record| record.u.view()))?),
            Target::Velocity => (&g_y, band.all("y", from.records.iter().map(|record| record.y.view()))?),
        };
        let mut change = step(band, g, desired, &found, damping)?;
        let mut notes = limit_growth(from, band, &mut change, options.largest_change);
        let in_time = |g: &[DMatrix<Complex64>]| band.signals(&answer(band, g, &change));
        let traces = traces(from, band.signals(&change), [in_time(&g_u), in_time(&g_y)], margin, options);
        let (share, binding) = common_share(&traces, options);
        notes.extend(binding);
        let signal = |trace: &Trace| &trace.from + &(&trace.change * share);
        let [torque, velocity, travel, reference, _] = traces.each_ref().map(signal);
        Ok(Self { reference, predicted: Peaks::of_signals([&torque, &velocity, &travel]), notes })
    }
}

/// Torque, velocity and travel of the motor, velocity and travel of the reference.
fn traces(
    from: &Iteration,
    change: Array3<f64>,
    [torque_change, mut velocity_change]: [Array3<f64>; 2],
    margin: f64,
    options: &ShapeOptions,
) -> [Trace; 5] {
    let (torque, mut velocity) = (stack(&from.records, |record| &record.u), stack(&from.records, |record| &record.y));
    let mut travel = travel_of(&from.records, &velocity, options.sample_time_s);
    let reference_travel = integral(&from.reference, options.sample_time_s);
    for axis in (0..from.stuck_share.len()).filter(|&axis| from.stuck_share[axis] > STUCK) {
        // an axis that sticks tells nothing of how it will move; at most it follows the reference
        let of_axis = s![.., axis, ..];
        velocity.slice_mut(of_axis).assign(&from.reference.slice(of_axis));
        velocity_change.slice_mut(of_axis).assign(&change.slice(of_axis));
        travel.slice_mut(of_axis).assign(&reference_travel.slice(of_axis));
    }
    let travel_change = integral(&velocity_change, options.sample_time_s);
    let reference_travel_change = integral(&change, options.sample_time_s);
    let trace = |quantity, from, change, margin| Trace { quantity, from, change, margin };
    [
        trace(Quantity::Torque, torque, torque_change, margin),
        trace(Quantity::Velocity, velocity, velocity_change, margin),
        trace(Quantity::Travel, travel, travel_change, margin),
        trace(Quantity::Velocity, from.reference.clone(), change, 1.0),
        trace(Quantity::Travel, reference_travel, reference_travel_change, 1.0),
    ]
}

/// Shortens the step of every axis until no peak of its reference grows by more than `factor`.
fn limit_growth(from: &Iteration, band: &Band, change: &mut [DMatrix<Complex64>], factor: f64) -> Vec<Note> {
    let mut notes = Vec::new();
    let in_time = band.signals(change);
    for (axis, (reference, step)) in zip(from.reference.axis_iter(Axis(1)), in_time.axis_iter(Axis(1))).enumerate() {
        let peak = reference.iter().fold(0.0, |peak: f64, r| peak.max(r.abs()));
        let shares = zip(reference.rows(), step.rows()).map(|(r, dr)| largest_share(r, dr, factor * peak));
        let share = shares.fold(1.0, f64::min);
        if share < 1.0 {
            change.iter_mut().for_each(|change| change.row_mut(axis).scale_mut(share));
            notes.push(Note::ChangeLimited { axis, share });
        }
    }
    notes
}

/// The share of the step with which every trace stays inside its limit, and what binds it.
fn common_share(traces: &[Trace; 5], options: &ShapeOptions) -> (f64, Option<Note>) {
    let mut binding = (1.0, None);
    for Trace { quantity, from, change, margin } in traces {
        for (from, change) in zip(from.outer_iter(), change.outer_iter()) {
            for (axis, (from, change)) in zip(from.rows(), change.rows()).enumerate() {
                let share = largest_share(from, change, options.limits.of(*quantity, axis) / margin);
                if share < binding.0 {
                    binding = (share, Some(Note::LimitAhead { axis, quantity: *quantity, share }));
                }
            }
        }
    }
    binding
}

/// The matrices of an FRF.
fn matrices(frf: &Frf) -> Vec<DMatrix<Complex64>> {
    let matrix = |at: ndarray::ArrayView2<Complex64>| DMatrix::from_fn(at.nrows(), at.ncols(), |i, j| at[[i, j]]);
    frf.response.outer_iter().map(matrix).collect()
}
