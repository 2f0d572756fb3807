//! Limits of a shaping: peaks are predicted before a reference is applied, and looked at
//! afterwards.

use std::iter::zip;

use frfid_signals::{Excess, Limit, Limits, Peaks, Record};
use ndarray::{Array3, ArrayView2, ArrayViewMut1, Axis};

use crate::shape::measure::stack;

/// What is predicted and kept inside its limits: torque, what holds against gravity included;
/// velocity, of motor and reference; travel from the place where a run begins, of motor and
/// integrated reference.
pub(super) const KEPT: [Limit; 3] = [Limit::Torque, Limit::Velocity, Limit::Travel];

/// Whether a limit is among [`KEPT`].
fn is_kept(limit: Limit) -> bool {
    match limit {
        Limit::Torque | Limit::Velocity | Limit::Travel => true,
        // not predicted: the reference is changed inside a band, and ends smoothly
        Limit::TorqueRate | Limit::Acceleration | Limit::Jerk => false,
        // an experiment gives them as travel
        Limit::LowestPosition | Limit::HighestPosition => false,
    }
}

/// Factor on an observed ratio of growth to prediction: the next ratio may be that much larger.
const LEARNT_MARGIN: f64 = 1.25;

/// Factors on predicted changes, per quantity in the order of [`KEPT`], and axis.
pub(super) type Margins = [Vec<f64>; 3];

/// The peaks of torque, velocity and travel, each `(experiment, axis, sample)`.
pub(super) fn peaks_of_signals(signals: [&Array3<f64>; 3]) -> Peaks {
    let of_axes = |signal: &Array3<f64>| signal.axis_iter(Axis(1)).map(peak_of).collect();
    zip(KEPT, signals.map(of_axes)).collect()
}

/// The peak of an axis over all experiments, `(experiment, sample)`.
pub(super) fn peak_of(axis: ArrayView2<f64>) -> f64 {
    axis.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()))
}

/// Torque, velocity and travel that were measured, each `(experiment, axis, sample)`.
pub(super) fn signals_of(records: &[Record], sample_time_s: f64) -> [Array3<f64>; 3] {
    let torque = stack(records, |record| &record.u);
    let velocity = stack(records, |record| &record.y);
    let travel = travel_of(records, &velocity, sample_time_s);
    [torque, velocity, travel]
}

/// Every kept limit that the peaks exceed.
pub(super) fn exceeded(limits: &Limits, peaks: &Peaks) -> Vec<Excess> {
    let mut excesses = limits.exceeded(peaks);
    excesses.retain(|excess| is_kept(excess.limit));
    excesses
}

/// Learns margins from how much more the peaks found grew than predicted; nothing where they grew
/// by less than a twentieth of the limit.
pub(super) fn teach(
    margins: &mut Margins,
    [found, before, predicted]: [&Peaks; 3],
    limits: &Limits,
) {
    for (margins, limit) in zip(margins, KEPT) {
        let of = |peaks: &Peaks, axis: usize| peaks.get(limit).map_or(0.0, |values| values[axis]);
        for (axis, margin) in margins.iter_mut().enumerate() {
            let before = of(before, axis);
            let (grown, least) = (of(found, axis) - before, 0.05 * limits.of(limit, axis));
            if grown > least {
                let foreseen = (of(predicted, axis) - before).max(least);
                *margin = LEARNT_MARGIN * (grown / foreseen).max(1.0);
            }
        }
    }
}

/// Distance in rad from the first sample, `(experiment, axis, sample)`; from the velocity where the
/// position was not measured.
fn travel_of(records: &[Record], velocity: &Array3<f64>, sample_time_s: f64) -> Array3<f64> {
    let mut travel = velocity.clone();
    for (mut travel, record) in zip(travel.axis_iter_mut(Axis(0)), records) {
        let Some(position) = &record.position_rad else {
            for axis in travel.rows_mut() {
                integrate(axis, sample_time_s);
            }
            continue;
        };
        for (travel, position) in zip(travel.rows_mut(), position.rows()) {
            for (travel, at) in zip(travel, position) {
                *travel = at - position[0];
            }
        }
    }
    travel
}

/// The integral from 0, in place.
pub(super) fn integrate(mut signal: ArrayViewMut1<f64>, sample_time_s: f64) {
    let mut sum = 0.0;
    for value in &mut signal {
        let velocity = *value;
        *value = sum;
        sum += sample_time_s * velocity;
    }
}

/// The integral of every signal, `(experiment, axis, sample)`.
pub(super) fn integral(velocity: &Array3<f64>, sample_time_s: f64) -> Array3<f64> {
    let mut travel = velocity.clone();
    for lane in travel.lanes_mut(Axis(2)) {
        integrate(lane, sample_time_s);
    }
    travel
}

/// The largest share of a change, at most 1, with which `|from + margin share change| <= limit`
/// holds in one sample; 0 if `from` is beyond the limit already and the change leads further.
pub(super) fn share_of_sample(from: f64, change: f64, margin: f64, limit: f64) -> f64 {
    // |from + share change| is largest on the side to which the change points
    let room = limit - from * change.signum();
    if change == 0.0 {
        1.0
    } else {
        (room / (margin * change.abs())).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn every_limit_is_decided_on() {
        let kept = Limit::ALL.iter().copied().filter(|limit| is_kept(*limit));
        assert!(kept.eq(KEPT));
    }

    #[test]
    fn the_share_stops_exactly_at_the_limit() {
        assert_eq!(share_of_sample(0.5, 1.0, 1.0, 1.0), 0.5);
        assert_eq!(share_of_sample(-0.5, -2.0, 1.0, 1.0), 0.25);
        assert_eq!(share_of_sample(-0.5, -2.0, 2.0, 1.0), 0.125);
        assert_eq!(share_of_sample(0.5, 1.0, 1.0, 10.0), 1.0);
        assert_eq!(share_of_sample(0.5, 1.0, 1.0, f64::INFINITY), 1.0);
        assert_eq!(share_of_sample(2.0, 1.0, 1.0, 1.0), 0.0);
        assert_eq!(
            share_of_sample(2.0, -0.5, 2.0, 2.5),
            1.0,
            "away from the limit is allowed"
        );
    }

    #[test]
    fn the_travel_is_the_integral_of_a_held_velocity() {
        let travel = integral(&array![[[1.0, 1.0, -1.0, 0.0]]], 0.5);
        assert_eq!(travel, array![[[0.0, 0.5, 1.0, 0.5]]]);
    }

    #[test]
    fn margins_follow_growth_that_matters() {
        let peaks = |torque: f64| -> Peaks {
            zip(KEPT, [torque, 1.0, 1.0].map(|peak| vec![peak])).collect()
        };
        let limits: Limits = [(Limit::Torque, vec![100.0])].into_iter().collect();
        let learnt = |found, predicted| {
            let mut margins = [vec![2.0], vec![2.0], vec![2.0]];
            let all = [&peaks(found), &peaks(20.0), &peaks(predicted)];
            teach(&mut margins, all, &limits);
            assert_eq!((margins[1][0], margins[2][0]), (2.0, 2.0));
            margins[0][0]
        };
        assert_eq!(
            (learnt(24.0, 20.1), learnt(38.0, 40.0)),
            (2.0, LEARNT_MARGIN)
        );
        let (fast, faster) = (1.5 * LEARNT_MARGIN, 4.0 * LEARNT_MARGIN);
        assert_eq!((learnt(50.0, 40.0), learnt(40.0, 20.0)), (fast, faster));
        let beyond = Excess {
            axis: 0,
            limit: Limit::Torque,
            allowed: 100.0,
            found: 101.0,
        };
        assert_eq!(exceeded(&limits, &peaks(101.0)), [beyond]);
    }
}
