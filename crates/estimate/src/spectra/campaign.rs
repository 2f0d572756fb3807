//! A campaign as spectra on lines: fed run by run in any order, so that no time series needs to
//! stay in memory.

use std::collections::{BTreeMap, BTreeSet};
use std::iter::zip;

use frfid_signals::checks::{all_finite, one_per_axis, require};

use crate::error::EstimateError;
use crate::period_index::PeriodIndex;
use crate::spectra::line_dft::check_rising;
use crate::spectra::run_spectra::{RunSpectra, Shapes, check_shape};

/// The spectra of a campaign, indexed by realization, period and experiment: the estimate does not
/// depend on the order in which runs were inserted. Memory is `lines x channels` complex numbers
/// per run.
#[derive(Debug, Clone, PartialEq)]
pub struct Campaign {
    pub(super) frequency_hz: Vec<f64>,
    /// Frequencies at which local models are evaluated; those of the lines without.
    at_hz: Option<Vec<f64>>,
    pub(super) runs: BTreeMap<PeriodIndex, RunSpectra>,
    /// Glides whose mean is not in the runs any more.
    pub(crate) glides: Vec<RunSpectra>,
    /// Coherence of their noise from run to run, line by line; empty: 1.
    pub(crate) glide_coherence: Vec<f64>,
}

/// All experiments of one period of one realization: the columns of U and Y.
pub(crate) type Block<'a> = Vec<&'a RunSpectra>;

impl Campaign {
    /// An empty campaign on `frequency_hz`, which must rise.
    ///
    /// # Errors
    /// [`EstimateError::NotRising`] or [`EstimateError::EmptyList`].
    pub fn new(frequency_hz: Vec<f64>) -> Result<Self, EstimateError> {
        check_rising("frequency_hz", frequency_hz.iter().copied())?;
        Ok(Self {
            frequency_hz,
            at_hz: None,
            runs: BTreeMap::new(),
            glides: Vec::new(),
            glide_coherence: Vec::new(),
        })
    }

    /// Frequencies in Hz.
    #[must_use]
    pub fn frequency_hz(&self) -> &[f64] {
        &self.frequency_hz
    }

    /// The same, evaluated at other frequencies than its lines, which must rise: by methods that look at many lines
    /// together.
    ///
    /// # Errors
    /// As [`Campaign::new`].
    pub fn evaluated_at(self, at_hz: Vec<f64>) -> Result<Self, EstimateError> {
        check_rising("frequency_hz", at_hz.iter().copied())?;
        Ok(Self {
            at_hz: Some(at_hz),
            ..self
        })
    }

    /// Frequencies in Hz at which local models are evaluated.
    pub(crate) fn at_hz(&self) -> &[f64] {
        self.at_hz.as_ref().unwrap_or(&self.frequency_hz)
    }

    /// Whether the runs hold the reference.
    pub(crate) fn has_reference(&self) -> bool {
        self.runs.values().all(|run| run.r.is_some())
    }

    /// Adds one run.
    ///
    /// # Errors
    /// [`EstimateError::Duplicate`], [`frfid_signals::SignalError::Shape`] if it does not fit the
    /// frequencies or the runs before it, [`frfid_signals::SignalError::NotFinite`].
    pub fn insert(&mut self, place: PeriodIndex, run: RunSpectra) -> Result<(), EstimateError> {
        self.check(&run)?;
        if self.runs.contains_key(&place) {
            return Err(EstimateError::Duplicate(place));
        }
        self.runs.insert(place, run);
        Ok(())
    }

    /// Adds a glide: the runs are those from which the mean of all glides is subtracted, whose noise
    /// is hence in every one of them and counts as noise of the FRF.
    ///
    /// # Errors
    /// As [`Campaign::insert`].
    pub fn insert_glide(&mut self, glide: RunSpectra) -> Result<(), EstimateError> {
        self.check(&glide)?;
        self.glides.push(glide);
        Ok(())
    }

    /// Says how coherent the noise of the glides is from one reference to another, line by line: 1 (as
    /// without) where they were subtracted in time, less where by position, which differs from one to
    /// the other.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError`] unless there is a number from 0 to 1 for each line.
    pub fn set_glide_coherence(&mut self, coherence: Vec<f64>) -> Result<(), EstimateError> {
        let n_lines = self.frequency_hz.len();
        one_per_axis("coherence", Some(&coherence), n_lines, |key, value| {
            require(key, value, (0.0..=1.0).contains(&value), "from 0 to 1")
        })?;
        self.glide_coherence = coherence;
        Ok(())
    }

    /// Whether it holds no run.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Every run with its place, in order.
    #[must_use]
    pub fn into_runs(self) -> BTreeMap<PeriodIndex, RunSpectra> {
        self.runs
    }

    /// Runs that are missing from periods of which other experiments are there, in order.
    #[must_use]
    pub fn missing(&self) -> Vec<PeriodIndex> {
        let n_experiments = self.n_experiments();
        let blocks: BTreeSet<_> = self.runs.keys().map(PeriodIndex::block).collect();
        let places = blocks.into_iter().flat_map(|b| places_of(b, n_experiments));
        let missing = places.filter(|place| !self.runs.contains_key(place));
        missing.collect()
    }

    /// Drops every period of which an experiment is missing and returns what was missing, so that
    /// the rest can be estimated.
    pub fn drop_incomplete(&mut self) -> Vec<PeriodIndex> {
        let missing = self.missing();
        let broken: BTreeSet<_> = missing.iter().map(PeriodIndex::block).collect();
        self.runs
            .retain(|place, _| !broken.contains(&place.block()));
        missing
    }

    /// Number of experiments: one more than the highest index given.
    pub(super) fn n_experiments(&self) -> usize {
        self.runs
            .keys()
            .map(|place| place.experiment + 1)
            .max()
            .unwrap_or(0)
    }

    /// Blocks by realization and period, complete, with at least as many experiments as inputs.
    pub(crate) fn realizations(&self) -> Result<Vec<Vec<Block<'_>>>, EstimateError> {
        self.check_complete()?;
        self.check_experiments()?;
        Ok(self.blocks())
    }

    fn check_complete(&self) -> Result<(), EstimateError> {
        let missing = self.missing();
        if missing.is_empty() {
            Ok(())
        } else {
            Err(EstimateError::Incomplete { missing })
        }
    }

    fn check_experiments(&self) -> Result<(), EstimateError> {
        let first = self.first().ok_or(EstimateError::EmptyList("runs"))?;
        let (found, needed) = (self.n_experiments(), first.u.nrows());
        if found < needed {
            return Err(EstimateError::TooFewExperiments { found, needed });
        }
        Ok(())
    }

    /// A run whose shapes all others have.
    fn first(&self) -> Option<&RunSpectra> {
        self.runs.values().next()
    }

    /// Blocks by realization and period, whatever is there of them.
    pub(crate) fn blocks(&self) -> Vec<Vec<Block<'_>>> {
        let mut blocks: BTreeMap<usize, BTreeMap<usize, Block>> = BTreeMap::new();
        for (place, run) in &self.runs {
            let realization = blocks.entry(place.realization).or_default();
            realization.entry(place.period).or_default().push(run);
        }
        let realizations = blocks.into_values();
        realizations
            .map(|periods| periods.into_values().collect())
            .collect()
    }

    /// The runs of a realization, in order.
    pub(super) fn of_realization(
        &self,
        realization: usize,
    ) -> impl DoubleEndedIterator<Item = (&PeriodIndex, &RunSpectra)> {
        let first = |realization| PeriodIndex {
            realization,
            period: 0,
            experiment: 0,
        };
        self.runs
            .range(first(realization)..first(realization.saturating_add(1)))
    }

    /// The periods of every experiment of every realization.
    pub(crate) fn by_experiment(&self) -> Vec<Vec<&RunSpectra>> {
        let mut experiments: BTreeMap<(usize, usize), Vec<&RunSpectra>> = BTreeMap::new();
        for (place, run) in &self.runs {
            let of = (place.realization, place.experiment);
            experiments.entry(of).or_default().push(run);
        }
        experiments.into_values().collect()
    }

    /// Refuses a run of another shape than those before it, or with values that are not finite.
    fn check(&self, run: &RunSpectra) -> Result<(), EstimateError> {
        for ((name, found), needed) in zip(run.signals(), self.needed_shapes(run)) {
            check_shape(name, found, needed)?;
            let entries = found.into_iter().flat_map(|found| found.indexed_iter());
            let bad = entries.filter(|(_, value)| !value.is_finite());
            all_finite(name, bad.map(|(place, _)| place))?;
        }
        Ok(())
    }

    /// Shapes that u, y and r of a run must have: those of the runs before it.
    fn needed_shapes(&self, run: &RunSpectra) -> Shapes {
        match self.first() {
            Some(first) => first.shapes(),
            None => run.needed_shapes(self.frequency_hz.len()),
        }
    }
}

/// The places of all experiments of a block, a realization and a period.
fn places_of(
    (realization, period): (usize, usize),
    n_experiments: usize,
) -> impl Iterator<Item = PeriodIndex> {
    (0..n_experiments).map(move |experiment| PeriodIndex {
        realization,
        period,
        experiment,
    })
}

#[cfg(test)]
mod tests {
    use frfid_signals::SignalError;
    use ndarray::Array2;

    use super::*;
    use crate::testing::refusal;

    fn run(inputs: usize) -> RunSpectra {
        RunSpectra {
            u: Array2::ones((inputs, 2)),
            y: Array2::ones((1, 2)),
            r: None,
        }
    }

    fn place(realization: usize, period: usize, experiment: usize) -> PeriodIndex {
        PeriodIndex {
            realization,
            period,
            experiment,
        }
    }

    #[test]
    fn missing_runs_are_named_and_their_periods_can_be_dropped() {
        let mut campaign = Campaign::new(vec![1.0, 2.0]).expect("rising");
        assert_eq!(
            campaign.realizations().err(),
            Some(EstimateError::EmptyList("runs"))
        );
        for (p, q, m) in [(0, 0, 0), (0, 0, 1), (0, 1, 1), (3, 0, 1), (3, 0, 0)] {
            campaign.insert(place(p, q, m), run(2)).expect("fits");
        }
        let missing = vec![place(0, 1, 0)];
        assert_eq!(
            campaign.realizations().err(),
            Some(EstimateError::Incomplete {
                missing: missing.clone()
            })
        );
        assert_eq!(campaign.drop_incomplete(), missing);
        let shape: Vec<usize> = campaign
            .realizations()
            .expect("complete")
            .iter()
            .map(Vec::len)
            .collect();
        assert_eq!(shape, [1, 1]);
    }

    /// What is missing, and which runs a realization has, is told in the time of the runs, not of their square.
    #[test]
    fn thousands_of_realizations_are_told_apart_in_no_time() {
        let mut campaign = Campaign::new(vec![1.0, 2.0]).expect("rising");
        let (n_realizations, n_periods) = (4096, 8);
        for realization in 0..n_realizations {
            for period in 0..n_periods {
                let place = place(realization, period, 0);
                campaign.insert(place, run(2)).expect("fits");
            }
        }
        let begin = std::time::Instant::now();
        assert_eq!(campaign.missing(), []);
        let counted = (0..n_realizations).map(|number| campaign.of_realization(number).count());
        assert_eq!(counted.sum::<usize>(), n_realizations * n_periods);
        assert!(begin.elapsed().as_secs_f64() < 2.0, "{:?}", begin.elapsed());
    }

    #[test]
    fn runs_that_do_not_fit_are_refused() {
        let mut campaign = Campaign::new(vec![1.0, 2.0]).expect("rising");
        let with_r = |r: usize| RunSpectra {
            r: Some(Array2::ones((r, 2))),
            ..run(2)
        };
        assert_eq!(
            refusal(campaign.insert(place(0, 0, 0), with_r(3))),
            "r has shape [3, 2], needed (2, 2) (channel, line)"
        );
        campaign.insert(place(0, 0, 0), run(2)).expect("fits");
        assert_eq!(
            campaign.insert(place(0, 0, 0), run(2)),
            Err(EstimateError::Duplicate(place(0, 0, 0)))
        );
        assert_eq!(
            refusal(campaign.insert(place(0, 0, 1), run(1))),
            "u has shape [1, 2], needed (2, 2) (channel, line)"
        );
        assert_eq!(
            refusal(campaign.insert(place(0, 0, 1), with_r(2))),
            "r has shape [2, 2], needed no r, as in the runs before"
        );
        let mut bad = run(2);
        bad.y[[0, 1]].im = f64::NAN;
        assert!(matches!(
            campaign.insert(place(0, 0, 1), bad),
            Err(EstimateError::Signal(SignalError::NotFinite {
                name: "y",
                ..
            }))
        ));
        assert_eq!(
            campaign.realizations().err(),
            Some(EstimateError::TooFewExperiments {
                found: 1,
                needed: 2
            })
        );
    }
}
