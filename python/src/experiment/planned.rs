//! Runs behind a `Plan`: the description they come from, and the testbeds that they are done on.

use std::path::Path;

use frfid_experiment::{Experiment as Description, KeptRuns, PlannedRuns};
use frfid_signals::{Run as Planned, RunId, Testbed};
use pyo3::prelude::*;

use crate::choice::resume_unless;
use crate::error;
use crate::experiment::plan::Plan;
use crate::interrupt::interruptible;
use crate::signals::run::{LimitsByKey, by_key};
use crate::testbed::python_testbed::PythonTestbed;

impl From<Description> for Plan {
    fn from(description: Description) -> Self {
        Self {
            planned: PlannedRuns::of(description),
        }
    }
}

impl Plan {
    pub(super) fn description(&self) -> &Description {
        &self.planned.experiment
    }

    /// One run with its reference.
    pub(super) fn drawn(&self, py: Python<'_>, id: RunId) -> PyResult<Planned> {
        let run = interruptible(py, None, |progress| {
            self.planned.run_while(id, &|| progress.goes_on())
        })?;
        run.map_err(error::experiment)
    }

    pub(super) fn ids(&self) -> Vec<RunId> {
        self.planned.run_ids()
    }

    /// The testbed, with its records kept in a folder.
    pub(super) fn kept<'a>(
        &'a self,
        testbed: &'a dyn Testbed,
        folder: &'a Path,
        replaces: bool,
    ) -> PyResult<KeptRuns<'a>> {
        let overwrite = resume_unless(replaces);
        KeptRuns::new(&self.planned, testbed, folder, overwrite).map_err(error::experiment)
    }

    pub(super) fn python_testbed(&self, object: &Bound<'_, PyAny>) -> PyResult<PythonTestbed> {
        let n_inputs = self.description().plan().n_inputs;
        PythonTestbed::new(object, n_inputs, self.limits(), &self.reference_unit())
    }

    /// Every limit by its key, those of channels, too.
    pub(super) fn limits(&self) -> LimitsByKey {
        let description = self.description();
        let mut limits = by_key(description.limits());
        let of_signal = description.signal_limits();
        limits.extend(of_signal.map(|(key, values)| (key.to_owned(), values.to_vec())));
        limits
    }

    /// Unit of the references; of channels with several units all of them, in their order.
    pub(super) fn reference_unit(&self) -> String {
        let mut units = self.description().reference_units();
        units.dedup();
        units.join(", ")
    }
}
