//! Gathering of a campaign's records: each is asked for once, several at a time, and only what
//! follows from it is kept, so that no campaign is too long for the memory.

use std::collections::{BTreeMap, BTreeSet};
use std::iter::zip;

use frfid_files::Loss;
use frfid_signals::{Record, RunId, RunKind};

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::digest::{Digest, ReadRecord, stop_of};
use crate::estimate::estimator::estimated::Estimated;
use crate::estimate::estimator::{Estimator, Spectra};
use crate::estimate::records::{Recorded, Records};
use crate::experiment::Experiment;
use crate::run::load::Load;
use crate::run::parallel::{Progress, Steps, for_each_group};
use crate::run::strength::Strength;

/// Largest relative difference between the sample times of a record and its plan: rounding of
/// decimal digits, far below what any clock keeps.
const SAME_SAMPLE_TIME: f64 = 1e-9;

/// Realization and repetition of runs: with every experiment they make one estimate.
type Realization = (usize, usize);

/// What the records of a campaign say.
pub(crate) struct Gathered {
    /// The FRF by each way of estimating that was asked for.
    pub estimated: Vec<Estimated>,
    /// Largest values over all runs without a loss.
    pub load: Option<Load>,
    /// How the axes were driven and moved in those runs.
    pub strength: Option<Strength>,
    /// Largest share of the samples of each axis at the ends of its signals, over those runs.
    pub clipped: Vec<f64>,
    /// What was lost, by stops too, with the place of the run; the periods it hit were dropped.
    pub losses: Vec<(usize, Loss)>,
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

    /// All digests as one, an estimate for each way.
    fn pooled(
        &self,
        digests: Vec<Digest>,
        estimators: &[Estimator],
    ) -> Result<Gathered, ExperimentError> {
        let mut spectra = vec![Spectra::default(); estimators.len()];
        let (mut loads, mut strengths, mut losses) = (Vec::new(), Vec::new(), Vec::new());
        let mut clipped = Vec::new();
        for digest in digests {
            for (all, of_one) in zip(&mut spectra, digest.spectra) {
                all.extend(of_one);
            }
            loads.extend(digest.load);
            strengths.extend(digest.strength);
            clipped.extend(digest.clipped);
            losses.extend(digest.losses.into_iter().map(|loss| (digest.place, loss)));
        }
        let estimates = zip(estimators, spectra);
        let estimated = estimates.map(|(estimator, spectra)| estimator.estimate(spectra));
        Ok(Gathered {
            estimated: estimated
                .collect::<Result<_, _>>()
                .map_err(|error| error.beside(losses.first()))?,
            load: Load::largest(loads),
            strength: self.strength(&strengths),
            clipped: clipped
                .into_iter()
                .reduce(larger_shares)
                .unwrap_or_default(),
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
    ) -> Result<(Vec<ReadRecord<'a>>, Vec<Estimator>), ExperimentError> {
        let mut first = self.read(&self.places(RunKind::Glide), 0)?;
        let estimators = with_glides(estimators, &first)?;
        if !estimators.iter().any(Estimator::learns_ripple) {
            return Ok((first, estimators));
        }
        let realization = self.read_realization(&mut first)?;
        let estimators = with_ripple(estimators, &first, realization)?;
        Ok((first, estimators))
    }

    /// Reads one run of every experiment of the same realization, the first for which all are
    /// whole; returns its realization and repetition.
    fn read_realization(
        &self,
        first: &mut Vec<ReadRecord<'a>>,
    ) -> Result<Realization, ExperimentError> {
        for (realization, places) in self.complete_realizations() {
            let before = first.len();
            first.extend(self.read(&places, before)?);
            if first[before..].iter().all(ReadRecord::is_whole) {
                return Ok(realization);
            }
        }
        Err(no_realization())
    }

    /// Places of the runs of each realization and repetition of which every experiment is there.
    fn complete_realizations(&self) -> BTreeMap<Realization, Vec<usize>> {
        let mut groups: BTreeMap<Realization, Vec<usize>> = BTreeMap::new();
        for place in self.places(RunKind::Excitation) {
            if let Some(realization) = realization_of(self.records.runs()[place]) {
                groups.entry(realization).or_default().push(place);
            }
        }
        groups.retain(|_, places| places.len() == self.experiment.plan.n_experiments());
        groups
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
    fn read(
        &self,
        places: &[usize],
        before: usize,
    ) -> Result<Vec<ReadRecord<'a>>, ExperimentError> {
        self.for_each_group(places, before, |places| self.read_group(places))
    }

    /// Does `work` on the records at places, as many at once as they are best had.
    fn for_each_group<T: Send>(
        &self,
        places: &[usize],
        before: usize,
        work: impl Fn(&[usize]) -> Result<Vec<T>, ExperimentError> + Sync,
    ) -> Result<Vec<T>, ExperimentError> {
        let n_at_once = self.records.n_at_once()?;
        let steps = Steps {
            progress: self.progress,
            before,
            total: self.records.runs().len(),
        };
        for_each_group(places, n_at_once, self.jobs, steps, |places, _| {
            work(places)
        })
    }

    fn read_group(&self, places: &[usize]) -> Result<Vec<ReadRecord<'a>>, ExperimentError> {
        let records = self.records.records(places)?;
        let read = places.iter().zip(records);
        read.map(|(&place, recorded)| self.read_one(place, recorded))
            .collect()
    }

    fn read_one(
        &self,
        place: usize,
        (record, losses): Recorded<'a>,
    ) -> Result<ReadRecord<'a>, ExperimentError> {
        let run = self.records.runs()[place];
        check_sample_time(run, &record, self.experiment.plan.sample_time_s)?;
        Ok(ReadRecord {
            place,
            run,
            stop: stop_of(&record, self.experiment.plan.run_samples()?),
            record,
            losses,
        })
    }

    /// Digests of all records, those read before included, in the order of the runs.
    fn digests(
        &self,
        first: &[ReadRecord<'a>],
        estimators: &[Estimator],
    ) -> Result<Vec<Digest>, ExperimentError> {
        let known: BTreeSet<usize> = first.iter().map(|read| read.place).collect();
        let mut rest = self.places(RunKind::Excitation);
        rest.retain(|place| !known.contains(place));
        let digest = |read: &ReadRecord| read.digest(self.experiment, estimators);
        let mut digests = first.iter().map(digest).collect::<Result<Vec<_>, _>>()?;
        let rest = self.for_each_group(&rest, known.len(), |places| {
            let read = self.read_group(places)?;
            read.iter().map(digest).collect()
        });
        digests.extend(rest?);
        digests.sort_by_key(|digest| digest.run);
        Ok(digests)
    }
}

/// The larger share of each axis.
fn larger_shares(a: Vec<f64>, b: Vec<f64>) -> Vec<f64> {
    zip(a, b).map(|(a, b)| a.max(b)).collect()
}

/// Refuses a record that was not sampled as the plan says: its frequencies would be others.
fn check_sample_time(run: RunId, record: &Record, plan_s: f64) -> Result<(), ExperimentError> {
    let found_s = record.sample_time_s;
    if (found_s / plan_s - 1.0).abs() <= SAME_SAMPLE_TIME {
        return Ok(());
    }
    Err(ExperimentError::logs(
        "sample time of a record",
        format!("{found_s} s in run {run}"),
        format!("{plan_s} s, as in the plan"),
        "estimate each record with the plan that it was made by",
    ))
}

fn no_realization() -> ExperimentError {
    ExperimentError::logs(
        "runs to learn the ripple from",
        "no realization of which every experiment is whole",
        "one run of every experiment of one realization",
        "add the missing files, or set glide_subtraction = \"time\"",
    )
}

/// Estimators that subtract what the whole ones among the records read say of the glides.
fn with_glides(
    estimators: Vec<Estimator>,
    read: &[ReadRecord],
) -> Result<Vec<Estimator>, ExperimentError> {
    let glides: Vec<&Record> = whole(read).map(|(_, glide)| glide).collect();
    let estimators = estimators.into_iter();
    estimators
        .map(|estimator| estimator.with_glides(&glides))
        .collect()
}

/// Estimators that know the ripple from the runs of a realization among the records read.
fn with_ripple(
    estimators: Vec<Estimator>,
    read: &[ReadRecord],
    realization: Realization,
) -> Result<Vec<Estimator>, ExperimentError> {
    let runs = whole(read).filter(|(run, _)| realization_of(*run) == Some(realization));
    let runs: Vec<(RunId, &Record)> = runs.collect();
    let estimators = estimators.into_iter();
    estimators
        .map(|estimator| estimator.with_ripple_of(&runs))
        .collect()
}

/// The realization of a run; `None` for a glide.
fn realization_of(run: RunId) -> Option<Realization> {
    (run.kind == RunKind::Excitation).then_some((run.realization, run.repetition))
}

/// The whole ones among records.
fn whole<'a>(records: &'a [ReadRecord<'_>]) -> impl Iterator<Item = (RunId, &'a Record)> {
    records
        .iter()
        .filter(|read| read.is_whole())
        .map(|read| (read.run, &*read.record))
}
