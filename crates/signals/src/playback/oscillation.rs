//! Oscillation of a run: its reference without the constant velocity, with integral and
//! derivatives, from a ramp before its first sample to a ramp after its last.

use frfid_transforms::TransformPlanner;
use ndarray::{Array2, ArrayView1};

use crate::excitation::Injection;
use crate::plan::Plan;
use crate::plan::run::{Run, RunKind};
use crate::playback::series::Series;

/// Longest ramp in s.
pub(super) const LONGEST_RAMP_S: f64 = 8.0;

/// Samples at the player's rate, from `n_ramp` before the run's first sample.
pub(super) struct Oscillation {
    /// The player's sample time in s.
    pub(super) step_s: f64,
    /// Samples of the longest ramp.
    pub(super) n_ramp: usize,
    /// Samples of the run.
    pub(super) n_run: usize,
    /// Integral from the run's first sample, value, slope and bend, each `(channel, sample)`.
    pub(super) orders: [Array2<f64>; 4],
}

impl Oscillation {
    pub(super) fn of(plan: &Plan, run: &Run, rate_hz: f64) -> Self {
        let step_s = 1.0 / rate_hz;
        let run_s = run.reference.ncols() as f64 * run.sample_time_s;
        let n_run = (run_s * rate_hz - 1e-6).ceil() as usize;
        let n_ramp = (LONGEST_RAMP_S * rate_hz).ceil() as usize;
        let n = n_run + 2 * n_ramp + 1;
        let mut orders: [Array2<f64>; 4] =
            std::array::from_fn(|_| Array2::zeros((plan.n_inputs, n)));
        let mut planner = TransformPlanner::default();
        for channel in 0..plan.n_inputs {
            let Some(series) = series(plan, run, channel, rate_hz, &mut planner) else {
                continue;
            };
            for (order, values) in (0..).zip(&mut orders) {
                let sampled = series.sampled(order, step_s, -(n_ramp as isize), n, &mut planner);
                values.row_mut(channel).assign(&ArrayView1::from(&sampled));
            }
        }
        Self {
            step_s,
            n_ramp,
            n_run,
            orders,
        }
    }
}

/// The series of a channel by the time from the run's first sample; `None` of a glide.
fn series(
    plan: &Plan,
    run: &Run,
    channel: usize,
    rate_hz: f64,
    planner: &mut TransformPlanner,
) -> Option<Series> {
    if run.id.kind == RunKind::Glide {
        return None;
    }
    let beneath = match plan.injection {
        Injection::Velocity => run.velocity_rad_s[channel],
        Injection::Torque => 0.0,
    };
    let t = run.sample_time_s;
    let above: Vec<f64> = run
        .reference
        .row(channel)
        .iter()
        .map(|value| value - beneath)
        .collect();
    let goes_on = plan.excitation.waveform().is_periodic() && plan.ramp_samples == 0;
    if goes_on {
        let from = plan.lead_in_samples;
        let period = (above.len() - from) / plan.n_periods;
        let series = Series::through(&above[from..from + period], t, planner);
        return Some(series.advanced(-(from as f64 * t)));
    }
    let least = (LONGEST_RAMP_S / t).ceil() as usize + 1;
    let rest = rest_around(above.len(), least, t * rate_hz);
    let rests = vec![0.0; rest];
    let rested = [&rests[..], &above, &rests].concat();
    Some(Series::through(&rested, t, planner).advanced(rest as f64 * t))
}

/// Samples of rest before and after what is done once: `least` or a few more, so that together with it they are a
/// whole number of the player's samples, of which there are `ratio` in one of the plan's.
fn rest_around(n_samples: usize, least: usize, ratio: f64) -> usize {
    let samples = |rest: usize| (n_samples + 2 * rest) as f64 * ratio;
    let mut rests = least..least + 1000;
    rests.find(|rest| is_whole(samples(*rest))).unwrap_or(least)
}

fn is_whole(samples: f64) -> bool {
    (samples - samples.round()).abs() < 1e-9 * samples
}
