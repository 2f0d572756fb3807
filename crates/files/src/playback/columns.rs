//! Columns of a table of playbacks: every quantity of every joint, with unit and side.

use frfid_signals::Playback;

use crate::playback::{PlaybackFile, signals};

/// A quantity of a joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    /// Joint, side, quantity and unit: `joint_1 motor velocity [deg/s]`.
    pub(crate) name: String,
    /// Which of the signals that are played.
    signal: usize,
    joint: usize,
    factor: f64,
}

impl Column {
    /// The value of a sample, in the column's unit; no negative zero.
    pub(crate) fn value(&self, playback: &Playback, sample: usize) -> f64 {
        self.factor * signals(playback)[self.signal][[self.joint, sample]] + 0.0
    }
}

impl PlaybackFile {
    /// The columns, joint by joint.
    pub(crate) fn columns(&self) -> Vec<Column> {
        let joints = 0..self.joint_names.len();
        joints.flat_map(|joint| self.columns_of(joint)).collect()
    }

    fn columns_of(&self, joint: usize) -> Vec<Column> {
        let quantities = self.quantities(joint);
        let columns = quantities.into_iter().enumerate();
        let (name, side) = (&self.joint_names[joint], self.form.side());
        let column = |(signal, (quantity, unit, factor))| Column {
            name: format!("{name} {side}{quantity} [{unit}]"),
            signal,
            joint,
            factor,
        };
        columns.map(column).collect()
    }

    /// Name, unit and factor of every signal of a joint: angles grow with its gear ratio, torques shrink.
    fn quantities(&self, joint: usize) -> Vec<(&'static str, &str, f64)> {
        let ratio = self.form.ratio(joint);
        if self.is_torque() {
            return match self.signal_units[joint].as_str() {
                "N m" => vec![("effort", "N m", 1.0 / ratio)],
                unit => vec![("signal", unit, 1.0)],
            };
        }
        let names = ["position", "velocity", "acceleration"];
        let units = self.form.angle.units();
        let with_units = names.into_iter().zip(units);
        with_units
            .map(|(name, (unit, factor))| (name, unit, ratio * factor))
            .collect()
    }
}
