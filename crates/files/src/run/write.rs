//! A run as a file: one MCAP with the record of one run, its provenance and the experiment it
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
use crate::mcap::write::{RosWriter, START_NS, Topic, stamp_ns};
use crate::ros::joint_state::JointState;
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

fn check(run: &RunFile) -> Result<(), FileError> {
    let record = &run.record;
    header::check_joints(&run.joint_names)?;
    header::check_sample_time(record.sample_time_s)?;
    let joints = run.joint_names.len();
    let rows = record.u.nrows().max(record.y.nrows());
    if rows != joints {
        let needed = format!("{joints}, one for each of the joint names");
        return Err(FileError::Shape {
            what: "rows of u and y",
            found: rows.to_string(),
            needed,
        });
    }
    let pairs = [
        (
            "shape of y",
            Some(&record.y),
            (record.y.nrows(), record.u.ncols()),
        ),
        ("shape of r", record.r.as_ref(), record.u.dim()),
        (
            "shape of position_rad",
            record.position_rad.as_ref(),
            record.y.dim(),
        ),
    ];
    for (what, signal, needed) in pairs {
        if let Some(signal) = signal.filter(|signal| signal.dim() != needed) {
            return Err(FileError::Shape {
                what,
                found: format!("{:?}", signal.dim()),
                needed: format!("{needed:?}"),
            });
        }
    }
    Ok(())
}

fn structure_of(run: &RunFile) -> RunStructure {
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
    writer.metadata("frfid", &run.metadata)?;
    writer.metadata(header::RUN, &header::to_texts(&structure_of(run)))?;
    writer.attach(
        header::EXPERIMENT,
        "application/toml",
        run.experiment_toml.as_bytes(),
    )?;
    let mut states = writer.joint_topic(topics::STATES)?;
    let mut commands = writer.joint_topic(topics::COMMANDS)?;
    let mut excitation = run
        .record
        .r
        .as_ref()
        .map(|_| writer.joint_topic(topics::EXCITATION))
        .transpose()?;
    let mut events = writer.text_topic(topics::EVENTS)?;
    let mut pending = run.record.events.iter().peekable();
    for sample in 0..run.record.n_samples() {
        let time_s = sample as f64 * run.record.sample_time_s;
        while let Some(event) = pending.next_if(|event| event.time_s <= time_s) {
            write_event(&mut writer, &mut events, event)?;
        }
        let [state, command, injected] = messages(run, sample);
        writer.joint_state(&mut states, &run.joint_names, &state)?;
        writer.joint_state(&mut commands, &run.joint_names, &command)?;
        if let Some(topic) = &mut excitation {
            writer.joint_state(topic, &run.joint_names, &injected)?;
        }
    }
    for event in pending {
        write_event(&mut writer, &mut events, event)?;
    }
    writer.finish()
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
    let time_ns = START_NS.saturating_add((event.time_s.max(0.0) * 1e9).round() as u64);
    writer.text(topic, time_ns, &serde_json::json!(event).to_string())
}

/// What /joint_states, /joint_commands and /frfid/excitation say of one sample.
fn messages(run: &RunFile, sample: usize) -> [JointState; 3] {
    let record = &run.record;
    let stamp_ns = stamp_ns(sample, record.sample_time_s);
    let values = |signal: &Array2<f64>| {
        let mut values = signal.column(sample).to_vec();
        values.resize(run.joint_names.len(), f64::NAN);
        values
    };
    let reference = || record.r.as_ref().map(values).unwrap_or_default();
    let mut state = JointState {
        stamp_ns,
        position: record.position_rad.as_ref().map(values).unwrap_or_default(),
        velocity: values(&record.y),
        effort: vec![],
    };
    let mut command = JointState {
        stamp_ns,
        ..Default::default()
    };
    match record.input_kind {
        InputKind::Measured => state.effort = values(&record.u),
        InputKind::Commanded => command.effort = values(&record.u),
    }
    let mut injected = JointState {
        stamp_ns,
        ..Default::default()
    };
    match run.injection {
        Injection::Torque => injected.effort = reference(),
        Injection::Velocity => {
            command.velocity = reference();
            injected.velocity = reference();
        }
    }
    [state, command, injected]
}
