//! Sample of a run, and what each topic says of it.

use frfid_signals::{Injection, InputKind};
use ndarray::Array2;

use crate::mcap::write::stamp_ns;
use crate::ros::joint_state::JointState;
use crate::run::write::RunFile;

/// One sample of a run, and what each topic says of it.
pub(super) struct Sample<'r> {
    pub(super) run: &'r RunFile,
    pub(super) sample: usize,
}

impl Sample<'_> {
    /// /joint_states: position, velocity and the measured input.
    pub(super) fn state(&self) -> JointState {
        JointState {
            stamp_ns: self.stamp_ns(),
            position: self.values(self.run.record.position_rad.as_ref()),
            velocity: self.values(Some(&self.run.record.y)),
            effort: self.input(InputKind::Measured),
        }
    }

    /// /joint_commands: the commanded input, and the reference of a closed loop.
    pub(super) fn command(&self) -> JointState {
        JointState {
            stamp_ns: self.stamp_ns(),
            position: Vec::new(),
            velocity: self.reference(Injection::Velocity),
            effort: self.input(InputKind::Commanded),
        }
    }

    /// /frfid/excitation: the reference, in the field it acts on.
    pub(super) fn injected(&self) -> JointState {
        JointState {
            stamp_ns: self.stamp_ns(),
            position: Vec::new(),
            velocity: self.reference(Injection::Velocity),
            effort: self.reference(Injection::Torque),
        }
    }

    /// Whether every value of this sample was measured: one that was not is left out, and found missing
    /// by the reader.
    pub(super) fn is_known(&self, signals: [Option<&Array2<f64>>; 3]) -> bool {
        let mut signals = signals.into_iter().flatten();
        signals.all(|signal| {
            signal
                .column(self.sample)
                .iter()
                .all(|value| value.is_finite())
        })
    }

    /// The input, if it is of this kind.
    pub(super) fn input_of(&self, kind: InputKind) -> Option<&Array2<f64>> {
        let record = &self.run.record;
        (record.input_kind == kind).then_some(&record.u)
    }

    fn input(&self, kind: InputKind) -> Vec<f64> {
        self.values(self.input_of(kind))
    }

    /// The reference, if it acts in this way.
    fn reference(&self, injection: Injection) -> Vec<f64> {
        let reference = self.run.record.r.as_ref();
        self.values(reference.filter(|_| self.run.injection == injection))
    }

    /// The values of a signal, NaN for joints without one; none of a signal that is not there.
    fn values(&self, signal: Option<&Array2<f64>>) -> Vec<f64> {
        let Some(signal) = signal else {
            return Vec::new();
        };
        let mut values = signal.column(self.sample).to_vec();
        values.resize(self.run.joint_names.len(), f64::NAN);
        values
    }

    fn stamp_ns(&self) -> u64 {
        stamp_ns(self.sample, self.run.record.sample_time_s)
    }
}
