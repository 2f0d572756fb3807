//! Runs by files: references are written, the machine plays them whenever it suits, and its recordings are looked
//! for at the next call.

use std::fmt;
use std::path::{Path, PathBuf};

use frfid_files::{LogMap, create_folder};
use frfid_signals::{Record, Run, RunId, Testbed, TestbedError};

use crate::error::ExperimentError;
use crate::estimate::find_logs::recordings_among;
use crate::experiment::Experiment;
use crate::play::command::write_reference;
use crate::play::import::{check_map, imported_run};
use crate::shape::iteration_files::iteration_name;

/// References to be played, and where their recordings are expected: what a shaping by files ends with until
/// they are there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Awaited {
    /// Folder of the references.
    pub references: PathBuf,
    /// Folder for the recordings, whatever their names, one of each run or one of all.
    pub recordings: PathBuf,
    /// Why recordings that are there were not taken.
    pub refused: Vec<String>,
}

impl std::error::Error for Awaited {}

impl fmt::Display for Awaited {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            references,
            recordings,
            refused,
        } = self;
        for reason in refused {
            writeln!(f, "not used: {reason}")?;
        }
        write!(
            f,
            "play the references in {}, put the recordings into {}, and give the same command again",
            references.display(),
            recordings.display()
        )
    }
}

impl Awaited {
    /// What is awaited, if that is why a shaping could not go on.
    #[must_use]
    pub fn of(error: &ExperimentError) -> Option<&Self> {
        match error {
            ExperimentError::Testbed(TestbedError::Foreign { source, .. }) => source.downcast_ref(),
            _ => None,
        }
    }
}

/// A machine that is reached by files.
pub struct FilesTestbed<'a> {
    experiment: &'a Experiment,
    map: &'a LogMap,
    rate_hz: Option<f64>,
    folder: &'a Path,
}

impl<'a> FilesTestbed<'a> {
    /// The machine of an experiment: references go to `folder/references`, recordings are looked for in
    /// `folder/measured`.
    ///
    /// # Errors
    /// [`ExperimentError::Logs`] for a map that does not fit.
    pub fn new(
        experiment: &'a Experiment,
        map: &'a LogMap,
        rate_hz: Option<f64>,
        folder: &'a Path,
    ) -> Result<Self, ExperimentError> {
        check_map(experiment, map)?;
        Ok(Self {
            experiment,
            map,
            rate_hz,
            folder,
        })
    }

    /// The folder of a run's iteration within another.
    fn folder_of(&self, kind: &str, run: &Run) -> PathBuf {
        self.folder
            .join(kind)
            .join(iteration_name(run.id.realization))
    }

    fn write(&self, run: &Run) -> Result<(), ExperimentError> {
        let player = self.experiment.player(self.rate_hz);
        let playback = self.experiment.playback(run, &player)?;
        let folder = self.folder_of("references", run);
        create_folder(&folder)?;
        create_folder(&self.folder_of("measured", run))?;
        let path = folder.join(format!("{}.csv", run.id));
        write_reference(&path, self.experiment, run.id, playback)
    }

    fn awaited(&self, run: &Run, refused: Vec<String>) -> Awaited {
        Awaited {
            references: self.folder_of("references", run),
            recordings: self.folder_of("measured", run),
            refused,
        }
    }

    /// The record of a run from the recordings of its iteration, or why there is none.
    fn found(&self, run: &Run) -> Result<Record, Vec<String>> {
        let folder = self.folder_of("measured", run);
        let mut refused = Vec::new();
        for recording in recordings_among(&[folder]).unwrap_or_default() {
            match imported_run(self.experiment, run, &recording, self.map, self.rate_hz) {
                Ok(record) => return Ok(record),
                Err(error) => refused.push(error.to_string()),
            }
        }
        Err(refused)
    }
}

impl Testbed for FilesTestbed<'_> {
    fn n_inputs(&self) -> usize {
        self.experiment.plan.n_inputs
    }

    fn announce(&self, runs: &[&Run]) -> Result<(), TestbedError> {
        let foreign = |id: RunId| move |error| TestbedError::foreign(id, error);
        runs.iter()
            .try_for_each(|run| self.write(run).map_err(foreign(run.id)))
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        let found = self.found(run);
        found.map_err(|refused| TestbedError::foreign(run.id, self.awaited(run, refused)))
    }
}
