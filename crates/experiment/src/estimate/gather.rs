//! What the records of a campaign say: each is asked for once, several at a time, and only what
//! follows from it is kept, so that no campaign is too long for the memory.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use frfid_estimate::AxisStrength;
use frfid_files::Loss;
use frfid_signals::{Event, EventKind, Record, RunId, RunKind};

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::estimator::{Estimated, Estimator, Spectra};
use crate::estimate::strength::Strength;
use crate::experiment::Experiment;
use crate::run::load::Load;
use crate::run::parallel::{Progress, Steps, for_each};

/// Where the records of a plan come from: files, memory, or a testbed that does the runs.
pub(crate) trait Records: Sync {
    /// The runs that are there, in any order.
    fn runs(&self) -> &[RunId];

    /// The record of the run at a place of that list, and what was lost of it; asked for once.
    ///
    /// # Errors
    /// [`ExperimentError`] for a run that cannot be had.
    fn record(&self, place: usize) -> Result<(Cow<'_, Record>, Vec<Loss>), ExperimentError>;
}

/// What the records of a campaign say.
pub(crate) struct Gathered {
    /// The FRF by each way of estimating that was asked for.
    pub estimated: Vec<Estimated>,
    /// Largest values over all runs without a loss.
    pub load: Option<Load>,
    /// How the axes were driven and moved in those runs.
    pub strength: Option<Strength>,
    /// What was lost, by stops too, with the place of the run; the periods it hit were dropped.
    pub losses: Vec<(usize, Loss)>,
}

/// A record as it was read.
struct Read<'a> {
    place: usize,
    run: RunId,
    record: Cow<'a, Record>,
    /// What was lost of it.
    losses: Vec<Loss>,
    /// What a stopped run did not do.
    stop: Option<Loss>,
}

/// What one record says.
struct Digest {
    place: usize,
    run: RunId,
    /// One for each way.
    spectra: Vec<Spectra>,
    load: Option<Load>,
    strength: Option<Vec<AxisStrength>>,
    losses: Vec<Loss>,
}

impl Read<'_> {
    fn is_whole(&self) -> bool {
        self.losses.is_empty() && self.stop.is_none()
    }
}

impl Experiment {
    /// Estimates the FRF from all records in several ways at once, on `jobs` threads (0: one for
    /// each core).
    ///
    /// # Errors
    /// [`ExperimentError`] of a record or an estimate, or an interruption.
    pub(crate) fn gather(
        &self,
        records: &dyn Records,
        ways: &[&EstimateTable],
        jobs: usize,
        progress: Progress,
    ) -> Result<Gathered, ExperimentError> {
        let gathering = Gathering {
            experiment: self,
            records,
            jobs,
            progress,
        };
        let estimators = ways.iter().map(|way| Estimator::new(&self.plan, way));
        let (first, estimators) = gathering.first(estimators.collect::<Result<_, _>>()?)?;
        let digests = gathering.digests(&first, &estimators)?;
        self.pooled(digests, &estimators)
    }

    /// All digests as one.
    fn pooled(
        &self,
        digests: Vec<Digest>,
        estimators: &[Estimator],
    ) -> Result<Gathered, ExperimentError> {
        let mut spectra = vec![Spectra::default(); estimators.len()];
        let (mut loads, mut strengths, mut losses) = (Vec::new(), Vec::new(), Vec::new());
        for digest in digests {
            for (all, of_one) in spectra.iter_mut().zip(digest.spectra) {
                all.extend(of_one);
            }
            loads.extend(digest.load);
            strengths.extend(digest.strength);
            losses.extend(digest.losses.into_iter().map(|loss| (digest.place, loss)));
        }
        let estimates = estimators.iter().zip(spectra);
        Ok(Gathered {
            estimated: estimates
                .map(|(estimator, spectra)| estimator.estimate(spectra))
                .collect::<Result<_, _>>()?,
            load: Load::largest(loads),
            strength: self.strength(&strengths),
            losses,
        })
    }
}

/// The records of a campaign while they are read.
struct Gathering<'a> {
    experiment: &'a Experiment,
    records: &'a dyn Records,
    jobs: usize,
    progress: Progress<'a>,
}

impl<'a> Gathering<'a> {
    /// Reads what estimators need before anything else, glides and runs to learn the ripple from,
    /// and hands it to them.
    fn first(
        &self,
        estimators: Vec<Estimator>,
    ) -> Result<(Vec<Read<'a>>, Vec<Estimator>), ExperimentError> {
        let mut first = self.read(&self.places(RunKind::Glide), 0)?;
        let glides: Vec<&Record> = whole(&first).map(|(_, glide)| glide).collect();
        let set = |estimator: Estimator| estimator.with_glides(&glides);
        let estimators: Vec<Estimator> =
            estimators.into_iter().map(set).collect::<Result<_, _>>()?;
        if !estimators.iter().any(Estimator::learns_ripple) {
            return Ok((first, estimators));
        }
        let learning = self.learning(&mut first)?;
        let runs: Vec<(RunId, &Record)> = whole(&first)
            .filter(|(run, _)| group_of(*run) == Some(learning))
            .collect();
        let learn = |estimator: Estimator| estimator.with_ripple_of(&runs);
        let estimators = estimators
            .into_iter()
            .map(learn)
            .collect::<Result<_, _>>()?;
        Ok((first, estimators))
    }

    /// Reads one run of every experiment of the same realization, the first for which all are
    /// whole; returns its realization and repetition.
    fn learning(&self, first: &mut Vec<Read<'a>>) -> Result<(usize, usize), ExperimentError> {
        let mut groups: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
        for place in self.places(RunKind::Excitation) {
            if let Some(group) = group_of(self.records.runs()[place]) {
                groups.entry(group).or_default().push(place);
            }
        }
        groups.retain(|_, places| places.len() == self.experiment.plan.n_experiments());
        for (group, places) in groups {
            let before = first.len();
            first.extend(self.read(&places, before)?);
            if first[before..].iter().all(Read::is_whole) {
                return Ok(group);
            }
        }
        Err(ExperimentError::Logs {
            what: "runs to learn the ripple from",
            found: "no realization of which every experiment is whole".into(),
            needed: "one run of every experiment of one realization".into(),
            advice: "add the missing files, or set glide_subtraction = \"time\"",
        })
    }

    /// Places of the runs of a kind, in the order of the runs.
    fn places(&self, kind: RunKind) -> Vec<usize> {
        let runs = self.records.runs();
        let mut places: Vec<usize> = (0..runs.len()).collect();
        places.retain(|&place| runs[place].kind == kind);
        places.sort_by_key(|&place| runs[place]);
        places
    }

    /// The records at these places; `before` were read before.
    fn read(&self, places: &[usize], before: usize) -> Result<Vec<Read<'a>>, ExperimentError> {
        for_each(places, self.jobs, self.steps(before), |&place| {
            self.read_one(place)
        })
    }

    fn steps(&self, before: usize) -> Steps<'_> {
        let (progress, total) = (self.progress, self.records.runs().len());
        Steps {
            progress,
            before,
            total,
        }
    }

    fn read_one(&self, place: usize) -> Result<Read<'a>, ExperimentError> {
        let (record, losses) = self.records.record(place)?;
        let stop = stop_of(&record, self.experiment.plan.run_samples()?);
        let run = self.records.runs()[place];
        Ok(Read {
            place,
            run,
            record,
            losses,
            stop,
        })
    }

    /// Digests of all records, those read before included, in the order of the runs.
    fn digests(
        &self,
        first: &[Read<'a>],
        estimators: &[Estimator],
    ) -> Result<Vec<Digest>, ExperimentError> {
        let known: BTreeSet<usize> = first.iter().map(|read| read.place).collect();
        let mut rest = self.places(RunKind::Excitation);
        rest.retain(|place| !known.contains(place));
        let digest = |read: &Read| self.digest(read, estimators);
        let mut digests = first.iter().map(digest).collect::<Result<Vec<_>, _>>()?;
        let steps = self.steps(known.len());
        digests.extend(for_each(&rest, self.jobs, steps, |&place| {
            digest(&self.read_one(place)?)
        })?);
        digests.sort_by_key(|digest| digest.run);
        Ok(digests)
    }

    fn digest(&self, read: &Read, estimators: &[Estimator]) -> Result<Digest, ExperimentError> {
        let experiment = self.experiment;
        let plan = &experiment.plan;
        let sound = read.losses.is_empty();
        let losses: Vec<Loss> = read.losses.iter().chain(&read.stop).cloned().collect();
        let (start, pose) = (plan.start_rad()?, experiment.pose_rad.clone());
        let period = plan.period_samples()?;
        let sample = |time_s: f64| (time_s / plan.sample_time_s).round() as usize;
        let is_lost = |number: usize| {
            let from = plan.lead_in_samples + number * period;
            let hits =
                |loss: &Loss| sample(loss.from_s) < from + period && sample(loss.to_s) > from;
            losses.iter().any(hits)
        };
        let filled = if sound {
            None
        } else {
            Some(filled(&read.record))
        };
        let record = filled.as_ref().unwrap_or(&read.record);
        let spectra = |estimator: &Estimator| estimator.spectra(read.run, record, &is_lost);
        Ok(Digest {
            place: read.place,
            run: read.run,
            spectra: estimators.iter().map(spectra).collect::<Result<_, _>>()?,
            load: sound.then(|| Load::of(&read.record, &start, &pose)),
            strength: if sound {
                experiment.strength_of(read.run, &read.record)
            } else {
                None
            },
            losses,
        })
    }
}

/// Runs of the same reference pattern: the experiments of a realization, done once. None for a glide.
fn group_of(run: RunId) -> Option<(usize, usize)> {
    (run.kind == RunKind::Excitation).then_some((run.realization, run.repetition))
}

/// The whole ones among records.
fn whole<'a>(records: &'a [Read<'_>]) -> impl Iterator<Item = (RunId, &'a Record)> {
    let whole = records.iter().filter(|read| read.is_whole());
    whole.map(|read| (read.run, &*read.record))
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
fn stop_of(record: &Record, run_samples: usize) -> Option<Loss> {
    let why = |event: &Event| match &event.kind {
        EventKind::Stopped { reason, .. } => Some(reason.clone()),
        _ => None,
    };
    let reason = record.events.iter().find_map(why)?;
    let time_s = |samples: usize| samples as f64 * record.sample_time_s;
    let (from_s, to_s) = (time_s(record.n_steady_samples()), time_s(run_samples));
    let (topic, reason) = ("run".into(), format!("stopped: {reason}"));
    Some(Loss {
        topic,
        from_s,
        to_s,
        reason,
    })
}
