//! Records of a plan: where they come from, and those without files, of a testbed that does the runs now or in memory.

use std::borrow::Cow;

use frfid_files::Loss;
use frfid_signals::{Record, Run, RunId, Testbed};

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::gather::Gathered;
use crate::estimate::outcome::{Inventory, Outcome};
use crate::experiment::Experiment;
use crate::run::parallel::{Progress, kept_each, n_at_once};

/// Where the records of a plan come from: files, memory, or a testbed that does the runs.
pub(crate) trait Records: Sync {
    /// The runs that are there, in any order.
    fn runs(&self) -> &[RunId];

    /// How many records are best had at once.
    ///
    /// # Errors
    /// [`ExperimentError`] for runs that cannot be had.
    fn n_at_once(&self) -> Result<usize, ExperimentError> {
        Ok(1)
    }

    /// The records of the runs at places of that list, and what was lost of each; asked for once.
    ///
    /// # Errors
    /// [`ExperimentError`] for a run that cannot be had.
    fn records(&self, places: &[usize]) -> Result<Vec<Recorded<'_>>, ExperimentError>;
}

/// A record, and what was lost of it.
pub(crate) type Recorded<'a> = (Cow<'a, Record>, Vec<Loss>);

/// Records that come from a testbed when they are asked for.
struct Measuring<'a> {
    experiment: &'a Experiment,
    testbed: &'a dyn Testbed,
    runs: Vec<RunId>,
}

impl Records for Measuring<'_> {
    fn runs(&self) -> &[RunId] {
        &self.runs
    }

    fn n_at_once(&self) -> Result<usize, ExperimentError> {
        n_at_once(self.experiment, self.testbed)
    }

    fn records(&self, places: &[usize]) -> Result<Vec<Recorded<'_>>, ExperimentError> {
        let plan = &self.experiment.plan;
        let runs = places.iter().map(|&place| plan.run(self.runs[place]));
        let runs: Vec<Run> = runs.collect::<Result<_, _>>()?;
        kept_each(&runs, self.testbed, |_, record| {
            Ok((Cow::Owned(record), Vec::new()))
        })
    }
}

/// Records in memory.
struct Kept<'a> {
    records: &'a [(RunId, Record)],
    runs: Vec<RunId>,
}

impl Records for Kept<'_> {
    fn runs(&self) -> &[RunId] {
        &self.runs
    }

    fn records(&self, places: &[usize]) -> Result<Vec<Recorded<'_>>, ExperimentError> {
        let recorded = |&place: &usize| (Cow::Borrowed(&self.records[place].1), Vec::new());
        Ok(places.iter().map(recorded).collect())
    }
}

impl Experiment {
    /// Does every run of the plan on `testbed` and estimates the FRF; only spectra are kept.
    ///
    /// # Errors
    /// [`ExperimentError`] of a run or of the estimate, or an interruption.
    pub fn measure(
        &self,
        testbed: &dyn Testbed,
        jobs: usize,
        progress: Progress,
    ) -> Result<Outcome, ExperimentError> {
        let [outcome] = self.measure_each([&self.config.estimate], testbed, jobs, progress)?;
        Ok(outcome)
    }

    /// Does every run once and estimates the FRF in several ways, one for each table.
    ///
    /// # Errors
    /// As [`Experiment::measure`].
    pub fn measure_each<const N: usize>(
        &self,
        ways: [&EstimateTable; N],
        testbed: &dyn Testbed,
        jobs: usize,
        progress: Progress,
    ) -> Result<[Outcome; N], ExperimentError> {
        let measuring = Measuring {
            experiment: self,
            testbed,
            runs: self.plan.run_ids().collect(),
        };
        let outcomes = self.outcomes(&measuring, &ways, jobs, progress)?;
        Ok(outcomes.try_into().expect("one for each way"))
    }

    /// Estimates the FRF of the plan from records in memory, glides and runs.
    ///
    /// # Errors
    /// [`ExperimentError`] for records that do not fit the plan or do not make an estimate.
    pub fn estimate(&self, records: &[(RunId, Record)]) -> Result<Outcome, ExperimentError> {
        let runs = records.iter().map(|(run, _)| *run).collect();
        let kept = Kept { records, runs };
        let ways = [&self.config.estimate];
        let outcomes = self.outcomes(&kept, &ways, 0, &|_, _| true)?;
        Ok(outcomes.into_iter().next().expect("one for each way"))
    }

    fn outcomes(
        &self,
        records: &dyn Records,
        ways: &[&EstimateTable],
        jobs: usize,
        progress: Progress,
    ) -> Result<Vec<Outcome>, ExperimentError> {
        let gathered = self.gather(records, ways, jobs, progress)?;
        let inventory = inventory(records.runs(), &gathered);
        Ok(self.conclude(gathered, &inventory))
    }
}

/// What is there and what is not, losses by the names of their runs.
fn inventory(runs: &[RunId], gathered: &Gathered) -> Inventory {
    let losses = &gathered.losses;
    let mut flawed: Vec<RunId> = losses.iter().map(|(place, _)| runs[*place]).collect();
    flawed.dedup();
    let lost = |(place, loss): &(usize, Loss)| format!("run {}: {loss}", runs[*place]);
    Inventory {
        n_records: runs.len(),
        n_flawed: flawed.len(),
        losses: losses.iter().map(lost).collect(),
    }
}
