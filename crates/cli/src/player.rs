//! Player of somebody else: the command that plays references and records, from options.

use std::path::{Path, PathBuf};

use clap::Args;
use frfid_experiment::{CommandTestbed, Experiment, PlayerCommand, TomlText};
use frfid_files::LogMap;

use crate::exit::Failure;

/// Options for a machine behind a command.
#[derive(Debug, Args)]
#[command(next_help_heading = "A machine behind a command, in place of the simulation")]
pub(crate) struct PlayerOptions {
    /// Command that plays a run: it is given the file of the reference and the path for its recording
    #[arg(long, value_name = "CMD", requires = "map")]
    player: Option<String>,
    /// Which signal of its recordings is which
    #[arg(long, value_name = "MAP.toml")]
    map: Option<PathBuf>,
    /// Samples a second of the references, where they are not the plan's
    #[arg(long, value_name = "HZ", requires = "map")]
    rate: Option<f64>,
    /// Ending of its recordings
    #[arg(
        long,
        value_name = "SUFFIX",
        requires = "player",
        default_value = "csv"
    )]
    recording: String,
    /// Time in s that it may take for a run; two minutes and twice what it plays without it
    #[arg(long, value_name = "S", requires = "player")]
    player_timeout: Option<f64>,
}

impl PlayerOptions {
    /// Samples a second of the references, where they are not the plan's.
    pub(crate) fn rate_hz(&self) -> Option<f64> {
        self.rate
    }

    /// Which signal of the recordings is which, without a command that makes them: a machine that is reached by
    /// files.
    ///
    /// # Errors
    /// [`Failure`] for a map that cannot be read.
    pub(crate) fn map_alone(&self) -> Result<Option<LogMap>, Failure> {
        match (&self.player, &self.map) {
            (None, Some(map)) => Ok(Some(TomlText::read(map)?.parse()?)),
            _ => Ok(None),
        }
    }

    /// Refuses a map without a player, where nothing is done by files: a simulation would be taken for the machine.
    ///
    /// # Errors
    /// [`Failure`] that says so.
    pub(crate) fn check_alone(&self) -> Result<(), Failure> {
        let told = "--map is for the recordings of a player; needed: --player CMD beside it, or no map to simulate";
        match self.map {
            Some(_) => Err(Failure::usage(told)),
            None => Ok(()),
        }
    }

    /// The player, if one is given.
    ///
    /// # Errors
    /// [`Failure`] for a map that cannot be read.
    pub(crate) fn command(&self) -> Result<Option<PlayerCommand>, Failure> {
        let Some((command, map)) = self.player.clone().zip(self.map.as_ref()) else {
            return Ok(None);
        };
        Ok(Some(PlayerCommand {
            command,
            map: TomlText::read(map)?.parse()?,
            rate_hz: self.rate,
            recording_suffix: self.recording.trim_start_matches('.').to_owned(),
            timeout_s: self.player_timeout,
        }))
    }
}

/// The machine behind a player; what it is told and what it records stays in `folder/player`.
///
/// # Errors
/// [`Failure`] for a map without what the description needs, or a folder that cannot be made.
pub(crate) fn machine<'a>(
    experiment: &'a Experiment,
    player: &'a PlayerCommand,
    folder: &Path,
) -> Result<CommandTestbed<'a>, Failure> {
    Ok(CommandTestbed::new(
        experiment,
        player,
        &folder.join("player"),
    )?)
}
