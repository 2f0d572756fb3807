//! Digest of one record: its spectra, its load, how it drove and moved the axes, and what is lost.

use std::borrow::Cow;
use std::ops::Range;

use frfid_estimate::AxisStrength;
use frfid_files::Loss;
use frfid_signals::{Event, EventKind, Plan, Record, RunId};

use crate::error::ExperimentError;
use crate::estimate::estimator::{Estimator, Spectra};
use crate::estimate::verdicts::clipped_shares;
use crate::experiment::Experiment;
use crate::run::load::Load;

/// A record as it was read.
pub(crate) struct ReadRecord<'a> {
    /// Place of the run in the list of records.
    pub place: usize,
    pub run: RunId,
    pub record: Cow<'a, Record>,
    /// What was lost of it.
    pub losses: Vec<Loss>,
    /// What a stopped run did not do.
    pub stop: Option<Loss>,
}

/// What one record says.
pub(crate) struct Digest {
    /// Place of the run in the list of records.
    pub place: usize,
    pub run: RunId,
    /// One for each way of estimating.
    pub spectra: Vec<Spectra>,
    pub load: Option<Load>,
    pub strength: Option<Vec<AxisStrength>>,
    /// Share of the samples of each axis at the ends of its signals.
    pub clipped: Option<Vec<f64>>,
    pub losses: Vec<Loss>,
}

impl ReadRecord<'_> {
    /// Whether nothing is lost and the run was not stopped.
    pub(crate) fn is_whole(&self) -> bool {
        self.losses.is_empty() && self.stop.is_none()
    }

    /// What the record says by each of the estimators. Load and strength are those of records
    /// without a loss alone.
    pub(crate) fn digest(
        &self,
        experiment: &Experiment,
        estimators: &[Estimator],
    ) -> Result<Digest, ExperimentError> {
        let losses: Vec<Loss> = self.losses.iter().chain(&self.stop).cloned().collect();
        let start = experiment.plan.start_rad()?;
        let mut digest = Digest {
            place: self.place,
            run: self.run,
            spectra: self.spectra(&experiment.plan, &losses, estimators)?,
            load: None,
            strength: None,
            clipped: None,
            losses,
        };
        if self.losses.is_empty() {
            let load = || Load::of(&self.record, &start, &experiment.pose_rad);
            digest.load = experiment.robot.as_ref().map(|_| load());
            digest.strength = experiment.strength_of(self.run, &self.record);
            digest.clipped = Some(clipped_shares(&self.record));
        }
        Ok(digest)
    }

    /// Spectra of the periods that no loss hits.
    fn spectra(
        &self,
        plan: &Plan,
        losses: &[Loss],
        estimators: &[Estimator],
    ) -> Result<Vec<Spectra>, ExperimentError> {
        let period_samples = plan.period_samples()?;
        let is_lost = |period: usize| {
            let from = plan.lead_in_samples + period * period_samples;
            let samples = from..from + period_samples;
            let mut losses = losses.iter();
            losses.any(|loss| hits(loss, &samples, plan.sample_time_s))
        };
        let filled = (!self.losses.is_empty()).then(|| filled(&self.record));
        let record = filled.as_ref().unwrap_or(&self.record);
        let spectra = |estimator: &Estimator| estimator.spectra(self.run, record, &is_lost);
        estimators.iter().map(spectra).collect()
    }
}

/// Whether a loss takes a sample of this range away.
fn hits(loss: &Loss, samples: &Range<usize>, sample_time_s: f64) -> bool {
    let sample = |time_s: f64| (time_s / sample_time_s).round() as usize;
    sample(loss.from_s) < samples.end && sample(loss.to_s) > samples.start
}

/// The record with zeros where samples are lost. They lie in periods that are not used: a number in
/// their place keeps the rest of the record usable.
fn filled(record: &Record) -> Record {
    let mut filled = record.clone();
    let Record {
        u,
        y,
        r,
        position_rad,
        ..
    } = &mut filled;
    for signal in [Some(u), Some(y), r.as_mut(), position_rad.as_mut()] {
        let samples = signal.into_iter().flatten();
        samples
            .filter(|sample| !sample.is_finite())
            .for_each(|sample| *sample = 0.0);
    }
    filled
}

/// What a run that was stopped did not do, as a loss.
pub(crate) fn stop_of(record: &Record, run_samples: usize) -> Option<Loss> {
    let reason = record.events.iter().find_map(reason_of_stop)?;
    let time_s = |samples: usize| samples as f64 * record.sample_time_s;
    Some(Loss {
        topic: "run".into(),
        from_s: time_s(record.n_steady_samples()),
        to_s: time_s(run_samples),
        reason: format!("stopped: {reason}"),
    })
}

/// Why a run was stopped, where the event says that it was.
fn reason_of_stop(event: &Event) -> Option<&str> {
    match &event.kind {
        EventKind::Stopped { reason, .. } => Some(reason),
        _ => None,
    }
}
