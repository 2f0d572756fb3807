//! Clock of the plan: a run of a recording, its signals at the plan's own instants.

use frfid_estimate::{Logged, resampled};
use frfid_files::Log;
use frfid_signals::{Event, EventKind, Plan, Record};
use ndarray::{Array2, ArrayView1};

use crate::play::import::sought::FoundRun;

/// A recording that ends so soon after a run was last seen to move ended before the run did.
const SOON_S: f64 = 0.6;
/// Why a run ends before its end.
const ENDED: &str = "the recording ends before the run does";
const RESTED: &str = "the machine rests where the plan moves it";

/// True times of the samples of a recording.
pub(super) fn times_of(log: &Log) -> Vec<f64> {
    let step_s = log.record.sample_time_s;
    let even = || {
        (0..log.record.n_samples())
            .map(|k| k as f64 * step_s)
            .collect()
    };
    log.times_s.clone().unwrap_or_else(even)
}

/// The signal that follows the references: the reference itself where it was logged, else what it drives.
pub(super) fn followed<'a>(log: &'a Log, times_s: &'a [f64], plan: &Plan) -> Logged<'a> {
    let record = &log.record;
    let driven = match plan.injection {
        frfid_signals::Injection::Velocity => &record.y,
        frfid_signals::Injection::Torque => &record.u,
    };
    let values = record.r.as_ref().unwrap_or(driven).view();
    Logged { times_s, values }
}

/// The run at the plan's instants, NaN in holes that are too long to bridge; one that stopped ends there.
pub(super) fn on_plan_clock(log: &Log, times_s: &[f64], found: &FoundRun, plan: &Plan) -> Record {
    let step_s = plan.sample_time_s;
    let until_s = found
        .occurrence
        .stopped_s
        .unwrap_or(found.length_s)
        .clamp(0.0, found.length_s);
    let n_samples = (until_s / step_s).round() as usize;
    let alignment = &found.occurrence.alignment;
    let instant_s = |k: usize| alignment.start_s + alignment.clock_ratio * k as f64 * step_s;
    let instants_s: Vec<f64> = (0..n_samples).map(instant_s).collect();
    let high_hz = plan.excitation.waveform().band_hz()[1];
    let signal = |signal: &Array2<f64>| {
        let mut on_plan = Array2::zeros((signal.nrows(), n_samples));
        for (row, mut on_plan) in signal.rows().into_iter().zip(on_plan.rows_mut()) {
            let values = resampled(times_s, row, &instants_s, high_hz);
            on_plan.assign(&ArrayView1::from(&values));
        }
        on_plan
    };
    let record = &log.record;
    Record {
        sample_time_s: step_s,
        u: signal(&record.u),
        y: signal(&record.y),
        r: record.r.as_ref().map(signal),
        position_rad: record.position_rad.as_ref().map(signal),
        input_kind: record.input_kind,
        events: stops(found, times_s),
    }
}

/// The stop of a run that does not reach its end, with the reason that can be told.
fn stops(found: &FoundRun, times_s: &[f64]) -> Vec<Event> {
    let Some(stopped_s) = found.occurrence.stopped_s else {
        return Vec::new();
    };
    let alignment = &found.occurrence.alignment;
    let at_s = alignment.start_s + alignment.clock_ratio * stopped_s;
    let ends = times_s.last().is_none_or(|last| *last < at_s + SOON_S);
    let reason = if ends { ENDED } else { RESTED }.to_owned();
    let kind = EventKind::Stopped {
        reason,
        since_s: Some(stopped_s),
    };
    vec![Event {
        time_s: stopped_s,
        kind,
    }]
}
