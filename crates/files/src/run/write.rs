//! Writer of run files: one MCAP with the record of one run, its provenance and the experiment it
//! belongs to.
//!
//! | topic | content |
//! |---|---|
//! | `/joint_states` | velocity `y`, position, and `u` as effort if it was measured |
//! | `/joint_commands` | `u` as effort if it was commanded; the reference velocity in closed loop |
//! | `/frfid/excitation` | the reference `r`, in the field it acts on |
//! | `/frfid/events` | events as JSON |
//!
//! Row k of every signal belongs to `joint_names[k]`; where a signal has fewer rows than there are
//! joints, the rest is NaN, so that every array is as long as `name` or empty. Stamps and log times
//! are the sample times, from a fixed start.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use frfid_signals::{Event, EventKind, Injection, InputKind, Record, RunId};
use mcap::McapResult;
use ndarray::Array2;
use serde::{Deserialize, Serialize};

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::mcap::write::{RosWriter, Topic, time_ns};
use crate::run::sample::Sample;
use crate::run::{header, topics};

/// One run with everything that belongs to it.
#[derive(Debug, Clone, PartialEq)]
pub struct RunFile {
    /// Joint of every row of the signals: as many as the larger of inputs and outputs.
    pub joint_names: Vec<String>,
    /// Which run of the plan it is.
    pub run: RunId,
    /// What the reference `r` stands for.
    pub injection: Injection,
    /// What was measured.
    pub record: Record,
    /// Provenance: version, seed, hashes, ... (the metadata record `frfid`).
    pub metadata: BTreeMap<String, String>,
    /// The experiment's description (the attachment `experiment.toml`).
    pub experiment_toml: String,
}

/// What a reader must know before the first sample (the metadata record `frfid.run`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunStructure {
    pub(crate) version: u32,
    pub(crate) joint_names: Vec<String>,
    pub(crate) run: RunId,
    pub(crate) injection: Injection,
    pub(crate) input_kind: InputKind,
    pub(crate) sample_time_s: f64,
    pub(crate) n_samples: usize,
    pub(crate) n_inputs: usize,
    pub(crate) n_outputs: usize,
    pub(crate) has_reference: bool,
    pub(crate) has_position: bool,
    pub(crate) n_events: usize,
}

impl RunStructure {
    /// Bytes of all its signals.
    pub(crate) fn n_bytes(&self) -> u64 {
        let n_inputs = self
            .n_inputs
            .saturating_mul(1 + usize::from(self.has_reference));
        let n_outputs = self
            .n_outputs
            .saturating_mul(1 + usize::from(self.has_position));
        let n_values = n_inputs
            .saturating_add(n_outputs)
            .saturating_mul(self.n_samples);
        n_values.saturating_mul(size_of::<f64>()) as u64
    }
}

/// Version of the layout above.
pub(crate) const VERSION: u32 = 1;

/// Writes a run; the same content gives the same bytes.
///
/// # Errors
/// [`FileError::Shape`] if the record does not fit the joints, and those of writing (see
/// [`Overwrite`]).
pub fn write_run(path: &Path, overwrite: Overwrite, run: &RunFile) -> Result<(), FileError> {
    check(run)?;
    write_file(path, overwrite, |file| Ok(write_to(file, run)?))
}

/// Refuses a record that does not fit the joints, or whose signals do not fit each other.
fn check(run: &RunFile) -> Result<(), FileError> {
    let record = &run.record;
    header::check_joints(&run.joint_names)?;
    header::check_sample_time(record.sample_time_s)?;
    let joints = run.joint_names.len();
    let rows = record.u.nrows().max(record.y.nrows());
    if rows != joints {
        let needed = format!("{joints}, one for each of the joint names");
        return Err(FileError::shape(
            "rows of u and y",
            rows.to_string(),
            needed,
        ));
    }
    let shape_of_y = (record.y.nrows(), record.u.ncols());
    check_shape("shape of y", Some(&record.y), shape_of_y)?;
    check_shape("shape of r", record.r.as_ref(), record.u.dim())?;
    let position = record.position_rad.as_ref();
    check_shape("shape of position_rad", position, record.y.dim())
}

fn check_shape(
    what: &'static str,
    signal: Option<&Array2<f64>>,
    needed: (usize, usize),
) -> Result<(), FileError> {
    match signal.map(Array2::dim) {
        Some(found) if found != needed => {
            let (found, needed) = (format!("{found:?}"), format!("{needed:?}"));
            Err(FileError::shape(what, found, needed))
        }
        _ => Ok(()),
    }
}

pub(crate) fn structure_of(run: &RunFile) -> RunStructure {
    let record = &run.record;
    RunStructure {
        version: VERSION,
        joint_names: run.joint_names.clone(),
        run: run.run,
        injection: run.injection,
        input_kind: record.input_kind,
        sample_time_s: record.sample_time_s,
        n_samples: record.n_samples(),
        n_inputs: record.u.nrows(),
        n_outputs: record.y.nrows(),
        has_reference: record.r.is_some(),
        has_position: record.position_rad.is_some(),
        n_events: record.events.len(),
    }
}

/// Writes the MCAP itself: what describes the run first, so that a cut file still says what it is.
pub(crate) fn write_to<W: Write>(file: W, run: &RunFile) -> McapResult<()> {
    let mut writer = RosWriter::new(file)?;
    let structure = (header::RUN, &structure_of(run));
    header::write(&mut writer, &run.metadata, structure, &run.experiment_toml)?;
    let mut topics = RunTopics::announce(&mut writer, run)?;
    write_samples(&mut writer, &mut topics, run)?;
    writer.finish()
}

/// Writes every sample, and before it the events up to its time.
fn write_samples<W: Write>(
    writer: &mut RosWriter<W>,
    topics: &mut RunTopics,
    run: &RunFile,
) -> McapResult<()> {
    let mut pending = run.record.events.iter().peekable();
    for sample in 0..run.record.n_samples() {
        let time_s = sample as f64 * run.record.sample_time_s;
        while let Some(event) = pending.next_if(|event| event.time_s <= time_s) {
            write_event(writer, &mut topics.events, event)?;
        }
        write_sample(writer, topics, run, sample)?;
    }
    pending.try_for_each(|event| write_event(writer, &mut topics.events, event))
}

/// The topics of a run.
struct RunTopics {
    states: Topic,
    commands: Topic,
    /// `None` in a run without a reference.
    excitation: Option<Topic>,
    events: Topic,
}

impl RunTopics {
    fn announce<W: Write>(writer: &mut RosWriter<W>, run: &RunFile) -> McapResult<Self> {
        Ok(Self {
            states: writer.joint_topic(topics::STATES)?,
            commands: writer.joint_topic(topics::COMMANDS)?,
            excitation: match run.record.r {
                Some(_) => Some(writer.joint_topic(topics::EXCITATION)?),
                None => None,
            },
            events: writer.text_topic(topics::EVENTS)?,
        })
    }
}

fn write_sample<W: Write>(
    writer: &mut RosWriter<W>,
    topics: &mut RunTopics,
    run: &RunFile,
    sample: usize,
) -> McapResult<()> {
    let at = Sample { run, sample };
    let record = &run.record;
    let states = [
        Some(&record.y),
        record.position_rad.as_ref(),
        at.input_of(InputKind::Measured),
    ];
    if at.is_known(states) {
        writer.joint_state(&mut topics.states, &run.joint_names, &at.state())?;
    }
    let reference = record
        .r
        .as_ref()
        .filter(|_| run.injection == Injection::Velocity);
    if at.is_known([reference, at.input_of(InputKind::Commanded), None]) {
        writer.joint_state(&mut topics.commands, &run.joint_names, &at.command())?;
    }
    match &mut topics.excitation {
        Some(topic) if at.is_known([record.r.as_ref(), None, None]) => {
            writer.joint_state(topic, &run.joint_names, &at.injected())
        }
        _ => Ok(()),
    }
}

/// A period that has ended is safe on the disk before the next one begins.
fn write_event<W: Write>(
    writer: &mut RosWriter<W>,
    topic: &mut Topic,
    event: &Event,
) -> McapResult<()> {
    if matches!(event.kind, EventKind::PeriodStart { .. }) {
        writer.flush()?;
    }
    let told = serde_json::json!(event).to_string();
    writer.text(topic, time_ns(event.time_s.max(0.0)), &told)
}
