//! Player as a command: each run's reference in a file, somebody else's program that plays it and records, its
//! recording as the run's record.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use frfid_files::{LogMap, Overwrite, PlaybackFile, create_folder, write_playback_csv};
use frfid_signals::{Playback, Record, Run, RunId, Testbed, TestbedError};

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::play::import::{check_map, imported_run};
use crate::play::process::played;

/// A player may take so many times as long as it plays, ..
const SLOWER: f64 = 2.0;
/// .. and so many seconds more: to start, to move, to write its recording.
const BESIDE_S: f64 = 120.0;

/// Somebody else's program that plays references and records.
///
/// For each run the command is given to the shell with two arguments, the file of the reference and the path of
/// the recording that it is to write. The environment says the same (`FRFID_REFERENCE`, `FRFID_LOG`), the run
/// (`FRFID_RUN`) and the rate (`FRFID_RATE_HZ`). It ends with 0 once the recording is complete; whatever else
/// ends the campaign.
#[derive(Debug, Clone)]
pub struct PlayerCommand {
    /// The command, as a shell takes it.
    pub command: String,
    /// Which signal of its recordings is which.
    pub map: LogMap,
    /// Samples a second of the references; the plan's without it.
    pub rate_hz: Option<f64>,
    /// Ending of its recordings.
    pub recording_suffix: String,
    /// Time in s that it may take for a run; without it two minutes and twice what it plays.
    pub timeout_s: Option<f64>,
}

/// A player as a testbed: references and recordings stay in a folder.
pub struct CommandTestbed<'a> {
    experiment: &'a Experiment,
    player: &'a PlayerCommand,
    folder: PathBuf,
    /// Held by frfid and by its player: two at a time would both send runs to the machine.
    lock: File,
}

impl<'a> CommandTestbed<'a> {
    /// The testbed of an experiment whose references and recordings are kept in `folder`.
    ///
    /// # Errors
    /// [`ExperimentError`] for a map that does not fit, or a folder that cannot be made.
    pub fn new(
        experiment: &'a Experiment,
        player: &'a PlayerCommand,
        folder: &Path,
    ) -> Result<Self, ExperimentError> {
        check_map(experiment, &player.map)?;
        let kinds = ["references", "recordings"];
        let made = |kind| create_folder(&folder.join(kind));
        kinds.into_iter().try_for_each(made)?;
        Ok(Self {
            experiment,
            player,
            folder: folder.into(),
            lock: locked(folder)?,
        })
    }

    fn played(&self, run: &Run) -> Result<Record, ExperimentError> {
        let player = self.experiment.player(self.player.rate_hz);
        let playback = self.experiment.playback(run, &player)?;
        let timeout_s = self.player.timeout_s.unwrap_or_else(|| {
            SLOWER * playback.n_samples() as f64 * playback.sample_time_s + BESIDE_S
        });
        let reference = self.reference_of(run.id);
        write_reference(&reference, self.experiment, run.id, playback)?;
        let recording = self.recording_of(run.id);
        remove(&recording)?;
        self.play(run.id, &reference, &recording, player.rate_hz, timeout_s)?;
        check_written(&recording)?;
        let (map, rate_hz) = (&self.player.map, self.player.rate_hz);
        imported_run(self.experiment, run, &recording, map, rate_hz)
    }

    fn reference_of(&self, run: RunId) -> PathBuf {
        self.folder.join("references").join(format!("{run}.csv"))
    }

    fn recording_of(&self, run: RunId) -> PathBuf {
        let name = format!("{run}.{}", self.player.recording_suffix);
        self.folder.join("recordings").join(name)
    }

    /// Starts the player and waits for its end.
    fn play(
        &self,
        run: RunId,
        reference: &Path,
        recording: &Path,
        rate_hz: f64,
        timeout_s: f64,
    ) -> Result<(), ExperimentError> {
        let command = format!("{} \"$@\"", self.player.command);
        let lock = self.lock.try_clone();
        let lock = lock.map_err(|error| failed("player", error.to_string(), "a file to lock"))?;
        let mut shell = Command::new("sh");
        shell
            .args(["-c", &command, "player"])
            .args([reference, recording])
            .env("FRFID_REFERENCE", reference)
            .env("FRFID_LOG", recording)
            .env("FRFID_RUN", run.to_string())
            .env("FRFID_RATE_HZ", rate_hz.to_string())
            .stdin(Stdio::from(lock)) // empty, and held as long as the player lives
            .stdout(Stdio::from(std::io::stderr()));
        let status = played(&mut shell, timeout_s)?;
        if status.success() {
            return Ok(());
        }
        Err(failed(
            "player",
            format!("{status}"),
            "exit code 0: played and recorded",
        ))
    }
}

impl Testbed for CommandTestbed<'_> {
    fn n_inputs(&self) -> usize {
        self.experiment.plan.n_inputs
    }

    fn announce(&self, runs: &[&Run]) -> Result<(), TestbedError> {
        let player = self.experiment.player(self.player.rate_hz);
        let kept = |run: &&Run| {
            let playback = self.experiment.playback(run, &player).map(drop);
            playback.map_err(|error| TestbedError::foreign(run.id, error))
        };
        runs.iter().try_for_each(kept)
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        let played = self.played(run);
        played.map_err(|error| TestbedError::foreign(run.id, error))
    }
}

/// Writes the file of a reference.
pub(crate) fn write_reference(
    path: &Path,
    experiment: &Experiment,
    run: RunId,
    playback: Playback,
) -> Result<(), ExperimentError> {
    let file = PlaybackFile {
        name: run.to_string(),
        joint_names: experiment.joint_names.clone(),
        plan_id: experiment.plan_id(),
        signal_units: experiment.reference_units(),
        pose_rad: experiment.pose_rad.clone(),
        playbacks: vec![playback.into()],
        form: frfid_files::TableForm::default(),
    };
    Ok(write_playback_csv(path, Overwrite::Replace, &file)?)
}

/// Checks that a player wrote its recording.
fn check_written(recording: &Path) -> Result<(), ExperimentError> {
    let needed = "one at the path that it is given";
    match recording.exists() {
        true => Ok(()),
        false => {
            let found = format!("none at {}", recording.display());
            Err(failed("recording of the player", found, needed))
        }
    }
}

/// The lock of a folder of a player.
fn locked(folder: &Path) -> Result<File, ExperimentError> {
    let path = folder.join("lock");
    let file = File::create(&path).map_err(|error| failed("lock", error.to_string(), "a file"))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(_) => Err(ExperimentError::AtWork { lock: path }),
    }
}

/// Removes what an earlier try left.
fn remove(recording: &Path) -> Result<(), ExperimentError> {
    let removed = match recording.symlink_metadata() {
        Err(_) => Ok(()),
        Ok(metadata) if metadata.is_dir() => std::fs::remove_dir_all(recording),
        Ok(_) => std::fs::remove_file(recording),
    };
    let needed = "a recording of an earlier try that can be removed";
    removed.map_err(|error| failed("recording of the player", error.to_string(), needed))
}

pub(super) fn failed(what: &'static str, found: String, needed: &str) -> ExperimentError {
    let advice =
        "the next run is not sent; once the cause is removed, the same command goes on from here";
    ExperimentError::logs(what, found, needed, advice)
}
