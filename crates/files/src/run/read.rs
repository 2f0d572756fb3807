//! Reads a run back: bit for bit what was written, or NaN with a [`Loss`] that says where and why.

use std::collections::BTreeMap;
use std::io::{Read, Seek};
use std::path::Path;

use frfid_signals::{Event, Injection, InputKind, Record, RunId};
use ndarray::Array2;

use crate::error::FileError;
use crate::loss::{self, Loss};
use crate::mcap::chunk::Entry;
use crate::mcap::open::open_mcap;
use crate::mcap::read::{Part, scan};
use crate::mcap::record::Message;
use crate::mcap::write::{START_NS, stamp_ns};
use crate::ros::joint_state::JointState;
use crate::run::write::{RunFile, RunStructure, VERSION};
use crate::run::{header, topics};

/// Reads a run of ours. Samples that are lost are NaN in the record and listed as [`Loss`], so that
/// periods they hit can be dropped; an empty list means that every sample and event is as it was
/// written.
///
/// # Errors
/// [`FileError::Io`]; [`FileError::Format`] if it is not an MCAP; [`FileError::Content`] if it is
/// not a run of ours, or cut before it says what it holds.
pub fn read_run(path: &Path) -> Result<(RunFile, Vec<Loss>), FileError> {
    read_from(open_mcap(path)?, path)
}

/// What a file says of its run outside of the samples.
#[derive(Debug, Clone, PartialEq)]
pub struct RunLabel {
    /// Which run of the plan it is.
    pub run: RunId,
    /// Provenance (the metadata record `frfid`).
    pub metadata: BTreeMap<String, String>,
    /// The experiment's description; `None` where the attachment is missing or damaged.
    pub experiment_toml: Option<String>,
}

/// Which run a file holds, where it comes from and which experiment it belongs to; the samples are
/// not read.
///
/// # Errors
/// As [`read_run`].
pub fn read_run_label(path: &Path) -> Result<RunLabel, FileError> {
    let (mut run, mut metadata, mut experiment_toml) = (None, BTreeMap::new(), None);
    scan(open_mcap(path)?, path, Part::Description, &mut |entry| {
        match entry {
            Entry::Metadata { name, values } if name == header::PROVENANCE => metadata = values,
            Entry::Attachment(attachment)
                if attachment.name == header::EXPERIMENT && attachment.is_sound =>
            {
                experiment_toml = String::from_utf8(attachment.data.to_vec()).ok();
            }
            Entry::Metadata { name, values } if name == header::RUN => {
                let structure: RunStructure =
                    header::from_texts(&values).map_err(|error| not_a_run(path, error))?;
                run = Some(structure.run);
            }
            _ => {}
        }
        Ok(())
    })?;
    let run = run.ok_or_else(|| not_a_run(path, "an MCAP without it".into()))?;
    Ok(RunLabel {
        run,
        metadata,
        experiment_toml,
    })
}

pub(crate) fn read_from<R: Read + Seek>(
    file: R,
    path: &Path,
) -> Result<(RunFile, Vec<Loss>), FileError> {
    let mut reading = Reading::default();
    let damages = scan(file, path, Part::All, &mut |entry| {
        reading.take(entry, path)
    })?;
    let Some(mut samples) = reading.samples else {
        let found = damages
            .first()
            .map_or("an MCAP without it".into(), |damage| damage.reason.clone());
        return Err(not_a_run(path, found));
    };
    let mut losses: Vec<_> = damages
        .into_iter()
        .map(|damage| loss::of_file(damage, START_NS))
        .collect();
    losses.extend(samples.losses());
    losses.append(&mut reading.losses);
    if reading.experiment_toml.is_none() {
        losses.push(loss::of_nothing(
            "experiment.toml",
            "the attachment is missing or damaged",
        ));
    }
    let run = RunFile {
        joint_names: samples.structure.joint_names.clone(),
        run: samples.structure.run,
        injection: samples.structure.injection,
        record: samples.into_record(),
        metadata: reading.metadata,
        experiment_toml: reading.experiment_toml.unwrap_or_default(),
    };
    Ok((run, losses))
}

fn not_a_run(path: &Path, found: String) -> FileError {
    FileError::Content {
        path: path.into(),
        what: "metadata record frfid.run".into(),
        found,
        needed: "a run written by frfid; for any other recording say which topic is which (--map)"
            .into(),
    }
}

#[derive(Default)]
struct Reading {
    samples: Option<Samples>,
    metadata: BTreeMap<String, String>,
    experiment_toml: Option<String>,
    losses: Vec<Loss>,
}

impl Reading {
    fn take(&mut self, entry: Entry, path: &Path) -> Result<(), FileError> {
        match entry {
            Entry::Metadata { name, values } if name == header::PROVENANCE => {
                self.metadata = values;
            }
            Entry::Metadata { name, values } if name == header::RUN && self.samples.is_none() => {
                let structure =
                    header::from_texts(&values).map_err(|error| not_a_run(path, error))?;
                self.samples =
                    Some(Samples::new(structure).map_err(|found| not_a_run(path, found))?);
            }
            Entry::Attachment(attachment)
                if attachment.name == header::EXPERIMENT && attachment.is_sound =>
            {
                self.experiment_toml = String::from_utf8(attachment.data.to_vec()).ok();
            }
            Entry::Message {
                channel, message, ..
            } => {
                let Some(samples) = &mut self.samples else {
                    return Err(not_a_run(path, "messages before the metadata".into()));
                };
                samples
                    .take(&channel.topic, &message)
                    .map_err(|found| FileError::Content {
                        path: path.into(),
                        what: format!("{} message {}", channel.topic, message.sequence),
                        found,
                        needed: "the sample that the run's metadata announces".into(),
                    })?;
            }
            _ => {}
        }
        Ok(())
    }
}

/// The signals of the run while they fill up: NaN until their message comes.
struct Samples {
    structure: RunStructure,
    u: Array2<f64>,
    y: Array2<f64>,
    r: Array2<f64>,
    position_rad: Array2<f64>,
    events: Vec<Event>,
    lost_events: usize,
    /// Per joint topic: its name and which samples came.
    came: Vec<(&'static str, Vec<bool>)>,
}

impl Samples {
    fn new(structure: RunStructure) -> Result<Self, String> {
        let joints = structure.joint_names.len();
        if structure.version != VERSION {
            return Err(format!(
                "version {}, this frfid reads version {VERSION}",
                structure.version
            ));
        }
        header::check_joints(&structure.joint_names).map_err(|error| error.to_string())?;
        header::check_sample_time(structure.sample_time_s).map_err(|error| error.to_string())?;
        if structure.n_inputs.max(structure.n_outputs) != joints {
            return Err(format!(
                "{} inputs, {} outputs, {joints} joints",
                structure.n_inputs, structure.n_outputs
            ));
        }
        let n = structure.n_samples;
        if n.saturating_mul(joints) > header::MOST_VALUES {
            return Err(format!(
                "{n} samples of {joints} joints; the limit is {} values",
                header::MOST_VALUES
            ));
        }
        let unknown = |rows: usize, is_there: bool| {
            Array2::from_elem((if is_there { rows } else { 0 }, n), f64::NAN)
        };
        let mut came = vec![
            (topics::STATES, vec![false; n]),
            (topics::COMMANDS, vec![false; n]),
        ];
        if structure.has_reference {
            came.push((topics::EXCITATION, vec![false; n]));
        }
        Ok(Self {
            u: unknown(structure.n_inputs, true),
            y: unknown(structure.n_outputs, true),
            r: unknown(structure.n_inputs, structure.has_reference),
            position_rad: unknown(structure.n_outputs, structure.has_position),
            events: Vec::new(),
            lost_events: 0,
            came,
            structure,
        })
    }

    fn take(&mut self, topic: &str, message: &Message) -> Result<(), String> {
        if topic == topics::EVENTS {
            return self.take_event(message);
        }
        let Some((topic, came)) = self.came.iter_mut().find(|(name, _)| *name == topic) else {
            return Ok(());
        };
        let (state, names) = JointState::decode(message.data).map_err(|error| error.to_string())?;
        if names != self.structure.joint_names {
            return Err(format!("joints {names:?}"));
        }
        let sample_time_s = self.structure.sample_time_s;
        let sample = (state.stamp_ns.saturating_sub(START_NS) as f64 / (sample_time_s * 1e9))
            .round() as usize;
        match came.get_mut(sample) {
            Some(first @ false) if stamp_ns(sample, sample_time_s) == state.stamp_ns => {
                *first = true;
            }
            Some(true) => return Err(format!("sample {sample} a second time")),
            _ => {
                return Err(format!(
                    "stamp {} ns, which is no sample time",
                    state.stamp_ns
                ));
            }
        }
        let JointState {
            position,
            velocity,
            effort,
            ..
        } = &state;
        match (*topic, self.structure.input_kind, self.structure.injection) {
            (topics::STATES, kind, _) => {
                put(&mut self.y, sample, "velocity", velocity)?;
                put(&mut self.position_rad, sample, "position", position)?;
                if kind == InputKind::Measured {
                    put(&mut self.u, sample, "effort", effort)
                } else {
                    Ok(())
                }
            }
            (topics::COMMANDS, InputKind::Commanded, _) => {
                put(&mut self.u, sample, "effort", effort)
            }
            (topics::EXCITATION, _, Injection::Torque) => {
                put(&mut self.r, sample, "effort", effort)
            }
            (topics::EXCITATION, _, Injection::Velocity) => {
                put(&mut self.r, sample, "velocity", velocity)
            }
            _ => Ok(()),
        }
    }

    /// An event that cannot be read is counted; it must not cost the samples around it.
    fn take_event(&mut self, message: &Message) -> Result<(), String> {
        let mut cdr = crate::ros::cdr_read::CdrReader::new(message.data)
            .map_err(|error| error.to_string())?;
        match cdr
            .text()
            .ok()
            .and_then(|text| serde_json::from_str(text).ok())
        {
            Some(event) => self.events.push(event),
            None => self.lost_events += 1,
        }
        Ok(())
    }

    fn losses(&mut self) -> Vec<Loss> {
        let structure = &self.structure;
        let mut losses = Vec::new();
        for (topic, came) in &self.came {
            let n = structure.n_samples;
            losses.extend(loss::gaps(
                topic,
                n,
                structure.sample_time_s,
                "are missing",
                |sample| !came[sample],
            ));
        }
        if self.events.len() != structure.n_events {
            let reason = format!(
                "{} events, {} were written",
                self.events.len(),
                structure.n_events
            );
            losses.push(loss::of_nothing(topics::EVENTS, &reason));
        }
        losses
    }

    fn into_record(self) -> Record {
        Record {
            sample_time_s: self.structure.sample_time_s,
            u: self.u,
            y: self.y,
            r: self.structure.has_reference.then_some(self.r),
            position_rad: self.structure.has_position.then_some(self.position_rad),
            input_kind: self.structure.input_kind,
            events: self.events,
        }
    }
}

/// Stores one sample of a signal; a signal without rows was not recorded.
fn put(signal: &mut Array2<f64>, sample: usize, field: &str, values: &[f64]) -> Result<(), String> {
    if values.len() < signal.nrows() {
        return Err(format!(
            "{} values of {field} for {} channels",
            values.len(),
            signal.nrows()
        ));
    }
    for (place, value) in signal.column_mut(sample).iter_mut().zip(values) {
        *place = *value;
    }
    Ok(())
}
