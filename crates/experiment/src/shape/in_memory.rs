//! Shaping in memory, on the description's own model, with nothing on disk.

use frfid_estimate::{Driver, Iteration, Shaped, Shaper};
use frfid_signals::{Record, Testbed};

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::parallel::{Progress, Steps, for_each_group, kept_each, silent};

/// Sees every iteration of a shaping.
pub(crate) type Look<'a> = dyn FnMut(&Iteration) -> Result<(), ExperimentError> + 'a;

impl Experiment {
    /// Shapes the chirp on the model; `look` and `progress` see every iteration.
    ///
    /// # Errors
    /// [`ExperimentError`] of the description, a run or the shaping, or an interruption.
    pub fn shape_in_memory(
        &self,
        jobs: usize,
        progress: Progress,
        look: &mut Look,
    ) -> Result<Shaped, ExperimentError> {
        let (shaper, options) = self.shaper()?;
        let n_iterations = options.n_iterations;
        let testbed = self.testbed();
        let mut model = Model {
            testbed: &*testbed,
            jobs,
            progress,
            n_iterations,
            look,
        };
        let shaped = shaper.drive(&mut model)?;
        progress(n_iterations, n_iterations);
        Ok(shaped)
    }
}

struct Model<'a, 'l> {
    testbed: &'a dyn Testbed,
    jobs: usize,
    progress: Progress<'a>,
    n_iterations: usize,
    look: &'a mut Look<'l>,
}

impl Driver for Model<'_, '_> {
    type Error = ExperimentError;

    fn records(&mut self, shaper: &Shaper) -> Result<Vec<Record>, ExperimentError> {
        let iteration = shaper.number();
        if !(self.progress)(iteration - 1, self.n_iterations) {
            return Err(ExperimentError::ShapingInterrupted { iteration });
        }
        let runs = shaper.runs();
        let steps = Steps {
            progress: &silent,
            before: 0,
            total: runs.len(),
        };
        let n_at_once = self.testbed.n_at_once();
        for_each_group(&runs, n_at_once, self.jobs, steps, |runs, _| {
            kept_each(runs, self.testbed, |_, record| Ok(record))
        })
    }

    fn iterated(&mut self, iteration: &Iteration) -> Result<bool, ExperimentError> {
        (self.look)(iteration)?;
        Ok(true)
    }
}
