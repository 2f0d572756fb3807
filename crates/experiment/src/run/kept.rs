//! Runs that are kept: every record is in its folder as soon as it is measured, and a run that is there is not done
//! again.

use std::path::Path;

use frfid_files::{Overwrite, create_folder};
use frfid_signals::{GoOn, Record, Run, Testbed, TestbedError};

use crate::error::ExperimentError;
use crate::run::folder::Writer;
use crate::run::guard::Guarded;
use crate::run::planned_runs::PlannedRuns;

/// A testbed that keeps what another one measures, in the files of `frfid run`.
///
/// A run that is in the folder already, whole or stopped, is read and not done again, so that work which an error or
/// Ctrl-C ended goes on where it was; [`Overwrite::Replace`] does stopped runs again.
pub struct KeptRuns<'a> {
    writer: Writer<'a>,
    testbed: Guarded<'a>,
}

impl<'a> KeptRuns<'a> {
    /// Keeps the runs of a plan in a folder, which is made if need be.
    ///
    /// # Errors
    /// [`ExperimentError::File`] for a folder that cannot be made.
    pub fn new(
        planned: &'a PlannedRuns,
        testbed: &'a dyn Testbed,
        folder: &'a Path,
        overwrite: Overwrite,
    ) -> Result<Self, ExperimentError> {
        create_folder(folder)?;
        let writer = Writer::new(planned, folder, overwrite);
        let testbed = Guarded::of(&planned.experiment, testbed);
        Ok(Self { writer, testbed })
    }
}

impl Testbed for KeptRuns<'_> {
    fn n_inputs(&self) -> usize {
        self.testbed.n_inputs()
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        self.run_while(run, &|| true)
    }

    fn run_while(&self, run: &Run, go_on: GoOn) -> Result<Record, TestbedError> {
        if let Some(record) = self.writer.record_of(run.id) {
            self.testbed.see(run, &record);
            return Ok(record);
        }
        let record = self.testbed.run_while(run, go_on)?;
        let kept = self.writer.write(run.id, record);
        kept.map_err(|error| TestbedError::foreign(run.id, error))
    }
}
