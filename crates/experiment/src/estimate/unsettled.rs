//! Runs of a plan that have not settled, judged from period to period.

use std::collections::BTreeMap;
use std::iter::zip;

use frfid_estimate::{
    EstimateError, PeriodIndex, RunSpectra, Settling, judge_settling, without_input_changes,
};
use frfid_files::Check;
use frfid_signals::format::{count, significant};
use frfid_signals::{Excitation, Frf, Plan};
use ndarray::{Array2, ArrayView1};
use num_complex::Complex64;

use crate::error::ExperimentError;

/// Bias of a line, over the line, that is worth a failed check.
const WORTH_IT: f64 = 1e-3;
/// A single run may fail by chance, this share of them does not.
pub(crate) const MOST_UNSETTLED: f64 = 0.1;

/// What has not settled, over all runs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Unsettled {
    /// Runs with periods enough to tell.
    pub n_judged: usize,
    /// Runs with lines that have not settled.
    pub n_unsettled: usize,
    /// The same of each output.
    pub of_outputs: Vec<usize>,
    /// Largest bias of a line over the line.
    pub bias_over_line: f64,
    /// Runs that grow from period to period.
    pub n_growing: usize,
    /// Largest factor from period to period.
    pub growth_per_period: f64,
}

/// A run: realization, experiment, repetition.
type Run = (usize, usize, usize);

impl Unsettled {
    /// Judges the outputs of every run on the lines of a multisine; other excitations have no lines
    /// that repeat.
    ///
    /// # Errors
    /// [`ExperimentError`] for spectra that do not fit each other.
    pub(crate) fn of(
        periods: &[(PeriodIndex, RunSpectra)],
        plan: &Plan,
        frf: &Frf,
    ) -> Result<Self, ExperimentError> {
        let mut unsettled = Self {
            of_outputs: vec![0; frf.n_outputs()],
            ..Self::default()
        };
        let Excitation::Multisine(multisine) = &plan.excitation else {
            return Ok(unsettled);
        };
        let mut runs: BTreeMap<Run, Vec<&RunSpectra>> = BTreeMap::new();
        for (place, spectra) in periods {
            let repetition = place.period / plan.n_periods;
            let run = (place.realization, place.experiment, repetition);
            runs.entry(run).or_default().push(spectra);
        }
        for run in runs.values() {
            let rest = without_input_changes(run, frf).into_iter();
            let rest: Vec<Option<Array2<Complex64>>> = rest.map(Some).collect();
            match judge_settling(&rest, &multisine.grid.excited) {
                Ok(settling) => unsettled.add(settling.as_ref()),
                Err(EstimateError::NotSettled { .. }) => unsettled.add_transient(&rest),
                Err(error) => return Err(error.into()),
            }
        }
        Ok(unsettled)
    }

    fn add(&mut self, settling: Option<&Settling>) {
        let Some(settling) = settling else { return };
        let mut biases = vec![0.0; self.of_outputs.len()];
        for line in &settling.unsettled {
            if let Some(bias) = biases.get_mut(line.channel) {
                *bias = line.bias_over_line.max(*bias);
            }
        }
        let is_worth_it = self.add_biases(&biases);
        if let Some(growth) = settling.growth_per_period.filter(|_| is_worth_it) {
            self.n_growing += 1;
            self.growth_per_period = self.growth_per_period.max(growth);
        }
    }

    /// Adds a run by the largest bias of each output; returns whether any is worth it.
    fn add_biases(&mut self, biases: &[f64]) -> bool {
        let is_worth_it = |bias: &f64| *bias > WORTH_IT;
        for (n_unsettled, bias) in zip(&mut self.of_outputs, biases) {
            *n_unsettled += usize::from(is_worth_it(bias));
        }
        self.n_judged += 1;
        let is_unsettled = biases.iter().any(is_worth_it);
        self.n_unsettled += usize::from(is_unsettled);
        self.bias_over_line = biases.iter().copied().fold(self.bias_over_line, f64::max);
        is_unsettled
    }

    /// A run whose first half differs from the rest: what the first period adds to the mean.
    fn add_transient(&mut self, periods: &[Option<Array2<Complex64>>]) {
        let mut present = periods.iter().flatten();
        let (Some(first), Some(last)) = (present.next(), present.next_back()) else {
            return;
        };
        let norm = |spectrum: ArrayView1<Complex64>| spectrum.mapv(|x| x.norm_sqr()).sum().sqrt();
        let of_output = |(first, last): (ArrayView1<Complex64>, ArrayView1<Complex64>)| {
            norm((&first - &last).view()) / norm(last) / periods.len() as f64
        };
        let biases: Vec<f64> = zip(first.rows(), last.rows()).map(of_output).collect();
        self.add_biases(&biases);
    }

    /// Share of the runs in which each output had not settled; `None` where no run tells.
    pub(crate) fn shares(&self) -> Vec<Option<f64>> {
        let n_judged = self.n_judged;
        let share = |&n: &usize| (n_judged > 0).then(|| n as f64 / n_judged as f64);
        self.of_outputs.iter().map(share).collect()
    }

    /// A check that fails where runs grow or have not settled; `None` where nothing is known, and
    /// where all is well.
    pub(crate) fn check(&self) -> Option<Check> {
        let is_share = |n: usize| n as f64 > MOST_UNSETTLED * self.n_judged as f64;
        let growth = is_share(self.n_growing).then(|| Check {
            name: "stable".into(),
            passed: false,
            found: format!(
                "{} of {} grow from period to period, by a factor {} at most",
                self.n_growing,
                count(self.n_judged, "run"),
                significant(self.growth_per_period, 3)
            ),
            needed: "periods that are alike: the loop is unstable, or the machine drifts".into(),
            advice: "lower the gain of the controller, or the excitation".into(),
        });
        let transient = || {
            is_share(self.n_unsettled).then(|| Check {
                name: "settled".into(),
                passed: false,
                found: format!(
                    "{} of {} not, a line by {} %",
                    self.n_unsettled,
                    count(self.n_judged, "run"),
                    significant(100.0 * self.bias_over_line, 2)
                ),
                needed: "runs settled: what dies out is in every period and in no variance".into(),
                advice: "raise lead_in_s".into(),
            })
        };
        growth.or_else(transient)
    }
}
