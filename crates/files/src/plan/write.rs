//! Writer of plan files: the references of all runs on one time axis.

use std::io::Write;
use std::path::Path;

use frfid_signals::{Injection, Run, check_finite};
use serde::Serialize;

use crate::atomic_write::{BoxError, Overwrite, write_file};
use crate::error::FileError;
use crate::mcap::write::{RosWriter, Topic, stamp_ns};
use crate::plan::{INDEX, PlanEntry, PlanHead, PlanIndex, PlanStructure, PlannedRun, VERSION};
use crate::ros::joint_state::JointState;
use crate::run::{header, topics};

/// What is said on `/frfid/events`.
#[derive(Serialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
enum Told<'a> {
    RunStart(&'a PlanEntry),
}

/// Rest between two runs on the time axis in s.
const REST_S: f64 = 1.0;

/// Writes a plan run by run: the memory of one run, however many there are. The same content gives
/// the same bytes.
///
/// # Errors
/// [`FileError::Shape`] for a head that contradicts itself; [`FileError::Write`] also for a run
/// that does not fit it, or that could not be made: the plan then stays in `NAME.part`.
pub fn write_plan<E: Into<BoxError>>(
    path: &Path,
    overwrite: Overwrite,
    head: &PlanHead,
    runs: impl IntoIterator<Item = Result<PlannedRun, E>>,
) -> Result<(), FileError> {
    header::check_joints(&head.joint_names)?;
    header::check_sample_time(head.sample_time_s)?;
    write_file(path, overwrite, |file| write_to(file, head, runs))
}

pub(crate) fn write_to<W: Write, E: Into<BoxError>>(
    file: W,
    head: &PlanHead,
    runs: impl IntoIterator<Item = Result<PlannedRun, E>>,
) -> Result<(), BoxError> {
    let mut writer = RosWriter::new(file)?;
    let structure = PlanStructure {
        version: VERSION,
        head,
    };
    let structure = (header::PLAN, &structure);
    header::write(
        &mut writer,
        &head.metadata,
        structure,
        &head.experiment_toml,
    )?;
    let mut commands = writer.joint_topic(topics::COMMANDS)?;
    let mut events = writer.text_topic(topics::EVENTS)?;
    let rest = (REST_S / head.sample_time_s).ceil() as usize;
    let mut index = PlanIndex { runs: Vec::new() };
    let mut start_sample = 0;
    for planned in runs {
        let planned = planned.map_err(Into::into)?;
        let entry = entry_of(&planned, head, start_sample)?;
        let start_ns = stamp_ns(start_sample, head.sample_time_s);
        writer.flush()?; // a run begins with a chunk of its own, so that it can be read alone
        let told = serde_json::to_string(&Told::RunStart(&entry))?;
        writer.text(&mut events, start_ns, &told)?;
        write_reference(&mut writer, &mut commands, head, &planned.run, start_sample)?;
        start_sample += entry.n_samples + rest;
        index.runs.push(entry);
    }
    writer.metadata(INDEX, &header::to_texts(&index))?;
    Ok(writer.finish()?)
}

/// The run's place in the file.
fn entry_of(
    planned: &PlannedRun,
    head: &PlanHead,
    start_sample: usize,
) -> Result<PlanEntry, FileError> {
    let run = &planned.run;
    check(run, head)?;
    Ok(PlanEntry {
        id: run.id,
        n_repetitions: planned.n_repetitions,
        start_sample,
        n_samples: run.reference.ncols(),
        velocity_rad_s: run.velocity_rad_s.clone(),
        start_rad: run.start_rad.clone(),
    })
}

/// Refuses a run that does not fit the plan, or with a number that may not be sent to a robot.
fn check(run: &Run, head: &PlanHead) -> Result<(), FileError> {
    let refused = |found: String, needed: String| {
        FileError::shape(
            "planned run",
            format!("run {} with {found}", run.id),
            needed,
        )
    };
    let (channels, n_samples) = run.reference.dim();
    let (joints, velocities) = (head.joint_names.len(), run.velocity_rad_s.len());
    if (channels, velocities, run.sample_time_s) != (joints, joints, head.sample_time_s)
        || n_samples == 0
    {
        let found = format!(
            "{channels} channels, {velocities} velocities, {n_samples} samples every {} s",
            run.sample_time_s
        );
        let needed = format!(
            "{joints} joints, some samples every {} s",
            head.sample_time_s
        );
        return Err(refused(found, needed));
    }
    check_finite("reference", run.reference.view())
        .map_err(|error| refused(error.to_string(), "numbers".into()))
}

fn write_reference<W: Write>(
    writer: &mut RosWriter<W>,
    commands: &mut Topic,
    head: &PlanHead,
    run: &Run,
    start_sample: usize,
) -> mcap::McapResult<()> {
    for (k, values) in run.reference.columns().into_iter().enumerate() {
        let command = command(head, start_sample + k, values.to_vec());
        writer.joint_state(commands, &head.joint_names, &command)?;
    }
    Ok(())
}

/// The message of one sample on the file's time axis.
fn command(head: &PlanHead, sample: usize, values: Vec<f64>) -> JointState {
    let mut command = JointState {
        stamp_ns: stamp_ns(sample, head.sample_time_s),
        ..Default::default()
    };
    match head.injection {
        Injection::Torque => command.effort = values,
        Injection::Velocity => command.velocity = values,
    }
    command
}
