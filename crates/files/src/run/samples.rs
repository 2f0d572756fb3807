//! Samples of a run while its messages come in, and what is missing in the end.

use frfid_signals::{Event, Injection, InputKind, Record};
use ndarray::Array2;

use crate::loss::{self, Loss};
use crate::mcap::record::Message;
use crate::mcap::write::{START_NS, stamp_ns};
use crate::ros::cdr_read::CdrReader;
use crate::ros::joint_state::JointState;
use crate::run::write::{RunStructure, VERSION};
use crate::run::{header, topics};

/// The signals of the run while they fill up: NaN until their message comes.
pub(crate) struct Samples {
    pub(crate) structure: RunStructure,
    u: Array2<f64>,
    y: Array2<f64>,
    r: Array2<f64>,
    position_rad: Array2<f64>,
    events: Vec<Event>,
    /// Per joint topic: its name and which samples came.
    came: Vec<(&'static str, Vec<bool>)>,
}

impl Samples {
    /// Unknown samples of every signal that the structure announces, or what is wrong with it.
    pub(crate) fn new(structure: RunStructure) -> Result<Self, String> {
        check(&structure)?;
        let n = structure.n_samples;
        let unknown = |rows: usize| Array2::from_elem((rows, n), f64::NAN);
        let unknown_if = |is_there, rows| unknown(if is_there { rows } else { 0 });
        let mut came = vec![
            (topics::STATES, vec![false; n]),
            (topics::COMMANDS, vec![false; n]),
        ];
        if structure.has_reference {
            came.push((topics::EXCITATION, vec![false; n]));
        }
        Ok(Self {
            u: unknown(structure.n_inputs),
            y: unknown(structure.n_outputs),
            r: unknown_if(structure.has_reference, structure.n_inputs),
            position_rad: unknown_if(structure.has_position, structure.n_outputs),
            events: Vec::new(),
            came,
            structure,
        })
    }

    /// Stores what a message says, or tells what is wrong with it.
    pub(crate) fn take(&mut self, topic: &str, message: &Message) -> Result<(), String> {
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
        let sample = marked(came, state.stamp_ns, self.structure.sample_time_s)?;
        let topic = *topic;
        self.store(topic, sample, &state)
    }

    /// Puts the fields of a message where they belong.
    fn store(&mut self, topic: &str, sample: usize, state: &JointState) -> Result<(), String> {
        match (topic, self.structure.input_kind, self.structure.injection) {
            (topics::STATES, ..) => self.store_state(sample, state),
            (topics::COMMANDS, InputKind::Commanded, _) => {
                put(&mut self.u, sample, "effort", &state.effort)
            }
            (topics::EXCITATION, _, Injection::Torque) => {
                put(&mut self.r, sample, "effort", &state.effort)
            }
            (topics::EXCITATION, _, Injection::Velocity) => {
                put(&mut self.r, sample, "velocity", &state.velocity)
            }
            _ => Ok(()),
        }
    }

    /// Puts what was measured where it belongs.
    fn store_state(&mut self, sample: usize, state: &JointState) -> Result<(), String> {
        put(&mut self.y, sample, "velocity", &state.velocity)?;
        put(&mut self.position_rad, sample, "position", &state.position)?;
        if self.structure.input_kind == InputKind::Measured {
            put(&mut self.u, sample, "effort", &state.effort)?;
        }
        Ok(())
    }

    /// An event that cannot be read is left out, to be missed in the end; it must not cost the
    /// samples around it.
    fn take_event(&mut self, message: &Message) -> Result<(), String> {
        let mut cdr = CdrReader::new(message.data).map_err(|error| error.to_string())?;
        let text = cdr.text().ok();
        self.events
            .extend(text.and_then(|text| serde_json::from_str::<Event>(text).ok()));
        Ok(())
    }

    /// Samples and events that never came.
    pub(crate) fn losses(&self) -> Vec<Loss> {
        let structure = &self.structure;
        let mut losses = Vec::new();
        for (topic, came) in &self.came {
            let (n, step_s) = (structure.n_samples, structure.sample_time_s);
            let is_lost = |sample: usize| !came[sample];
            losses.extend(loss::gaps(topic, n, step_s, "are missing", is_lost));
        }
        losses.extend(self.loss_of_events());
        losses
    }

    fn loss_of_events(&self) -> Option<Loss> {
        let (came, written) = (self.events.len(), self.structure.n_events);
        let reason = format!("{came} events, {written} were written");
        (came != written).then(|| loss::of_no_sample(topics::EVENTS, 0.0, reason))
    }

    /// The record as it is by now.
    pub(crate) fn into_record(self) -> Record {
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

/// Refuses a structure that no run has.
fn check(structure: &RunStructure) -> Result<(), String> {
    header::check_version(structure.version, VERSION)?;
    header::check_joints(&structure.joint_names).map_err(|error| error.to_string())?;
    header::check_sample_time(structure.sample_time_s).map_err(|error| error.to_string())?;
    check_sizes(structure)
}

/// Refuses signals that do not fit the joints, and more values than a file may hold.
fn check_sizes(structure: &RunStructure) -> Result<(), String> {
    let joints = structure.joint_names.len();
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
    Ok(())
}

/// The number of the sample with this stamp, which is noted as one that came.
fn marked(came: &mut [bool], stamp: u64, sample_time_s: f64) -> Result<usize, String> {
    let sample = nearest_sample(stamp, sample_time_s);
    match came.get_mut(sample) {
        Some(first @ false) if stamp_ns(sample, sample_time_s) == stamp => {
            *first = true;
            Ok(sample)
        }
        Some(true) => Err(format!("sample {sample} a second time")),
        _ => Err(format!("stamp {stamp} ns, which is no sample time")),
    }
}

fn nearest_sample(stamp: u64, sample_time_s: f64) -> usize {
    let since_start_ns = stamp.saturating_sub(START_NS) as f64;
    (since_start_ns / (sample_time_s * 1e9)).round() as usize
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
