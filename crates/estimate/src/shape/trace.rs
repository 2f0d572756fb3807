//! Traces: signals that must stay inside their limits, with the change that a step is predicted to
//! bring.

use std::iter::zip;

use frfid_signals::Limit;
use ndarray::{Array1, Array3, Axis, s};

use crate::shape::iteration::Iteration;
use crate::shape::limits::{KEPT, Margins, integral, share_of_sample, signals_of};
use crate::shape::note::Note;
use crate::shape::options::ShapeOptions;

/// Stuck share of the sweep from which the response to the reference says nothing about how an axis
/// will move.
const MOSTLY_STUCK: f64 = 0.5;

/// A signal of the last runs and how the whole step is predicted to change it,
/// `(experiment, axis, sample)`.
pub(super) struct Trace {
    pub limit: Limit,
    pub from: Array3<f64>,
    pub change: Array3<f64>,
    /// Whether the change is known, as that of the reference is, or predicted.
    pub exact: bool,
}

impl Trace {
    fn predicted(limit: Limit, from: Array3<f64>, change: Array3<f64>) -> Self {
        Self {
            limit,
            from,
            change,
            exact: false,
        }
    }

    fn exact(limit: Limit, from: Array3<f64>, change: Array3<f64>) -> Self {
        Self {
            exact: true,
            ..Self::predicted(limit, from, change)
        }
    }

    /// Factors on the change per axis, where it is predicted.
    fn margins<'a>(&self, margins: &'a Margins) -> Option<&'a [f64]> {
        let kept = KEPT.iter().position(|kept| *kept == self.limit);
        (!self.exact).then(|| margins[kept.unwrap_or_default()].as_slice())
    }
}

/// Torque, velocity and travel of the motor, velocity and travel of the reference.
pub(super) fn traces(
    from: &Iteration,
    change: Array3<f64>,
    [torque_change, mut velocity_change]: [Array3<f64>; 2],
    sample_time_s: f64,
) -> [Trace; 5] {
    let [torque, mut velocity, mut travel] = signals_of(&from.records, sample_time_s);
    let reference_travel = integral(&from.reference, sample_time_s);
    for axis in (0..from.stuck_share.len()).filter(|&axis| from.stuck_share[axis] > MOSTLY_STUCK) {
        // an axis that sticks says little about how it will move; at most it follows the reference
        for (motor, reference) in [
            (&mut velocity, &from.reference),
            (&mut velocity_change, &change),
            (&mut travel, &reference_travel),
        ] {
            let of_axis = s![.., axis, ..];
            motor.slice_mut(of_axis).assign(&reference.slice(of_axis));
        }
    }
    let travel_change = integral(&velocity_change, sample_time_s);
    let reference_travel_change = integral(&change, sample_time_s);
    [
        Trace::predicted(Limit::Torque, torque, torque_change),
        Trace::predicted(Limit::Velocity, velocity, velocity_change),
        Trace::predicted(Limit::Travel, travel, travel_change),
        Trace::exact(Limit::Velocity, from.reference.clone(), change),
        Trace::exact(Limit::Travel, reference_travel, reference_travel_change),
    ]
}

/// The share of the step, sample by sample, with which every trace of every experiment stays inside
/// a share `room` of its limit, and what binds it most.
pub(super) fn share_over_time(
    traces: &[Trace; 5],
    margins: &Margins,
    room: f64,
    options: &ShapeOptions,
) -> (Array1<f64>, Option<Note>) {
    let mut shares = Array1::ones(traces[0].from.len_of(Axis(2)));
    let (mut least, mut binding) = (1.0, None);
    for trace in traces {
        let (limit, margins) = (trace.limit, trace.margins(margins));
        for (((_, axis, sample), &from), &change) in zip(trace.from.indexed_iter(), &trace.change) {
            let margin = margins.map_or(1.0, |margins| margins[axis]);
            let allowed = room * options.limits.of(limit, axis);
            let share = share_of_sample(from, change, margin, allowed);
            shares[sample] = share.min(shares[sample]);
            if share < least {
                least = share;
                binding = Some(Note::LimitAhead {
                    axis,
                    limit,
                    time_s: sample as f64 * options.sample_time_s,
                    share,
                });
            }
        }
    }
    (shares, binding)
}
