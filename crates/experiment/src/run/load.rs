//! Load of a run: what it asked of the robot at most.

use frfid_signals::power::{about_mean, crest_factor, rms, sample_peak};
use frfid_signals::{Peaks, Record};
use serde::Serialize;

/// Largest values of a run or a campaign.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Load {
    /// Beside the limits that bound them.
    #[serde(flatten)]
    pub peaks: Peaks,
    /// Root mean square of the motor torque about its mean in N m, one for each axis: against the
    /// Coulomb friction it tells whether the excitation is strong enough (SK15 footnote 2). What
    /// holds a constant velocity or a weight does not count.
    #[serde(rename = "effort_rms_nm")]
    pub torque_rms_nm: Vec<f64>,
}

impl Load {
    /// The load of one record that began `start_rad` from the pose `pose_rad`, one value for each
    /// axis. Where the robot counts its positions from does not matter.
    #[must_use]
    pub fn of(record: &Record, start_rad: &[f64], pose_rad: &[f64]) -> Self {
        Self {
            peaks: Peaks::of_record(record, start_rad, pose_rad),
            torque_rms_nm: of_torques(record, rms),
        }
    }

    /// The same with torque rate, acceleration and jerk of a simulation, from rest to rest: in a
    /// recording noise would be all that is left of them.
    #[must_use]
    pub fn with_changes(mut self, changes: Peaks) -> Self {
        self.peaks.extend(changes);
        self
    }

    /// The larger of two, axis by axis.
    #[must_use]
    pub fn larger(self, other: &Self) -> Self {
        Self {
            peaks: self.peaks.farther(&other.peaks),
            torque_rms_nm: larger(&self.torque_rms_nm, &other.torque_rms_nm),
        }
    }

    /// The largest of several, `None` of none.
    #[must_use]
    pub fn largest(loads: impl IntoIterator<Item = Self>) -> Option<Self> {
        loads
            .into_iter()
            .reduce(|largest, load| largest.larger(&load))
    }
}

/// A number of the torque about its mean, one for each axis.
fn of_torques(record: &Record, number: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let torques = record.u.rows().into_iter().map(about_mean);
    torques.map(|torque| number(&torque)).collect()
}

/// Crest factor of the torque about its mean, one for each axis.
pub(crate) fn crest_factors(record: &Record) -> Vec<f64> {
    of_torques(record, |torque| {
        crest_factor(sample_peak(torque), rms(torque))
    })
}

/// The larger of two values of every axis.
pub(crate) fn larger(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| x.max(*y)).collect()
}
