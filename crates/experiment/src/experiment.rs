//! An experiment: its description, read and checked, and the plan that follows from it.

use std::path::Path;

use frfid_signals::Plan;

use crate::description::config::Config;
use crate::description::text::{ConfigError, Source};
use crate::design::plan::design;

/// A description that was read and found sound.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// The text it was read from.
    pub source: Source,
    /// What the text says, the robot's file read in.
    pub config: Config,
    /// The runs that follow from it.
    pub plan: Plan,
}

impl Experiment {
    /// Reads `experiment.toml`.
    ///
    /// # Errors
    /// [`ConfigError`]: the file cannot be read, or the place and reason of what is wrong in it.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::new(Source::read(path)?, folder)
    }

    /// Reads a text; a robot file that it names is looked up in `folder`.
    ///
    /// # Errors
    /// As [`Experiment::load`].
    pub fn new(source: Source, folder: &Path) -> Result<Self, ConfigError> {
        let mut config: Config = source.parse()?;
        config.robot.read_files(&source, folder)?;
        Self::of(config, source)
    }

    /// Checks a configuration and makes its plan; `source` is where errors point.
    ///
    /// # Errors
    /// [`ConfigError`].
    pub fn of(config: Config, source: Source) -> Result<Self, ConfigError> {
        config.robot.check(&source)?;
        let n_axes = config.robot.n_axes();
        config
            .controller
            .iter()
            .try_for_each(|table| table.check(config.sample_time_s, n_axes, &source))?;
        let plan = design(&config, &source)?;
        let experiment = Self {
            source,
            config,
            plan,
        };
        experiment.check_feasible()?;
        Ok(experiment)
    }

    /// The description as one TOML text that stands alone: it travels with every plan, record and
    /// result.
    #[must_use]
    pub fn to_toml(&self) -> String {
        toml::to_string(&self.config)
            .expect("every table of a configuration can be written as TOML")
    }
}
