//! Run file of a record: what belongs to it, and the starts of its periods.

use frfid_files::RunFile;
use frfid_signals::{Event, EventKind, Plan, Record, RunId, RunKind};

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::provenance::Metadata;

/// A record with what belongs to it, ready to be written.
pub(crate) fn run_file(
    experiment: &Experiment,
    run: RunId,
    mut record: Record,
    metadata: Metadata,
) -> Result<RunFile, ExperimentError> {
    let starts = period_starts(&experiment.plan, run, &record)?;
    record.events.extend(starts);
    record.events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    Ok(RunFile {
        joint_names: experiment.joint_names.clone(),
        run,
        injection: experiment.plan.injection,
        record,
        metadata,
        experiment_toml: experiment.to_toml(),
    })
}

/// The starts of the measured periods that the record reaches.
fn period_starts(plan: &Plan, id: RunId, record: &Record) -> Result<Vec<Event>, ExperimentError> {
    let period_samples = plan.period_samples()?;
    let n_periods = match id.kind {
        RunKind::Glide => 0,
        RunKind::Excitation => plan.n_periods,
    };
    let starts =
        (0..n_periods).map(|period| (period, plan.lead_in_samples + period * period_samples));
    let reached = starts.filter(|(_, start)| *start < record.n_samples());
    let event = |(period, start)| Event {
        time_s: start as f64 * plan.sample_time_s,
        kind: EventKind::PeriodStart { period },
    };
    Ok(reached.map(event).collect())
}
