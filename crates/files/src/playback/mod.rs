//! Playbacks in files: runs from rest to rest as the players of others take them.

pub(crate) mod columns;
pub(crate) mod csv;
pub(crate) mod exported;
mod float_array;
pub(crate) mod form;
pub(crate) mod formats;
mod joint_trajectory;
mod mat;
mod named;
pub(crate) mod order;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use frfid_signals::{Playback, Played};
use ndarray::Array2;

use crate::error::FileError;
use crate::playback::form::TableForm;
use crate::run::header::{MOST_VALUES, check_joints};

/// What a file of playbacks holds: one run, or all of them one after the other.
#[derive(Debug, Clone)]
pub struct PlaybackFile {
    /// Name of the run, as in `p000-m0-q0`, or of the whole campaign.
    pub name: String,
    /// Joint of every row of the signals.
    pub joint_names: Vec<String>,
    /// What a recording brings back to tell which plan was played: the first 32 bits of its hash.
    pub plan_id: u32,
    /// Unit of what is played where it is no motion, one for each joint: N m, or that of a channel.
    pub signal_units: Vec<String>,
    /// Where the machine rests, in rad, one for each joint.
    pub pose_rad: Vec<f64>,
    /// Played without a pause, in this order: each begins and ends at rest at the same pose. A run that is
    /// repeated is here as often as it is played.
    pub playbacks: Vec<Arc<Playback>>,
    /// How tables are written; messages of ROS are in SI units on the joint side whatever it says.
    pub form: TableForm,
}

impl PlaybackFile {
    /// Samples of the whole file.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        let all = self.playbacks.iter().map(|playback| playback.n_samples());
        all.fold(0, usize::saturating_add)
    }

    /// From the first sample to one sample after the last, in s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.n_samples() as f64 / self.rate_hz()
    }

    /// Samples a second.
    pub(crate) fn rate_hz(&self) -> f64 {
        let first = self.playbacks.first();
        1.0 / first.map_or(1.0, |playback| playback.sample_time_s)
    }

    /// Every sample with the playback that holds it.
    pub(crate) fn samples(&self) -> impl Iterator<Item = (&Playback, usize)> {
        let playbacks = self.playbacks.iter().map(|playback| &**playback);
        playbacks.flat_map(|playback| (0..playback.n_samples()).map(move |k| (playback, k)))
    }

    /// Whether torques are played, not motions.
    pub(crate) fn is_torque(&self) -> bool {
        let played = self.playbacks.first().map(|playback| &playback.played);
        matches!(played, Some(Played::Torque(_)))
    }

    /// Refuses names that do not tell the joints apart, nothing to play, playbacks of another size, clock or
    /// kind than the first, and gear ratios that do not fit.
    pub(crate) fn check(&self) -> Result<(), FileError> {
        check_joints(&self.joint_names)?;
        self.form.check(self.joint_names.len())?;
        self.check_pose()?;
        let Some(first) = self.playbacks.first() else {
            return Err(FileError::shape("playbacks", "none", "at least one run"));
        };
        self.check_size()?;
        let mut all = self.playbacks.iter();
        all.try_for_each(|playback| self.check_playback(playback, first))
    }

    fn check_pose(&self) -> Result<(), FileError> {
        let (found, needed) = (self.pose_rad.len(), self.joint_names.len());
        let told = format!("one position for each of {needed} joints");
        let found_told = format!("{found} positions");
        fits(found == needed, "pose_rad", found_told, &told)
    }

    /// Refuses more numbers than a recording of them could hold.
    fn check_size(&self) -> Result<(), FileError> {
        let n_samples = self.n_samples();
        let n_values = n_samples.saturating_mul(3 * self.joint_names.len());
        let found = format!("{n_samples} samples in one file");
        let needed = "at most 2^28 numbers: a file for each run, or a lower rate";
        fits(n_values <= MOST_VALUES, "playbacks", found, needed)
    }

    fn check_playback(&self, playback: &Playback, first: &Playback) -> Result<(), FileError> {
        let same_kind = signals(playback).len() == signals(first).len();
        let same_clock = playback.sample_time_s == first.sample_time_s;
        let (found, needed) = (signals(playback)[0].nrows(), self.joint_names.len());
        let is_fit = same_kind && same_clock && found == needed;
        let found = format!("{} of {found} channels", playback.id);
        let needed = format!("{needed} channels, all of one clock and one kind");
        fits(is_fit, "playbacks", found, &needed)
    }
}

/// Refuses a part that does not fit.
fn fits(is_fit: bool, what: &'static str, found: String, needed: &str) -> Result<(), FileError> {
    if is_fit {
        return Ok(());
    }
    Err(FileError::shape(what, found, needed))
}

/// The signals that are played: position, velocity and acceleration, or the torque alone.
pub(crate) fn signals(playback: &Playback) -> Vec<&Array2<f64>> {
    match &playback.played {
        Played::Motion(motion) => vec![
            &motion.position_rad,
            &motion.velocity_rad_s,
            &motion.acceleration_rad_s2,
        ],
        Played::Torque(torque) => vec![torque],
    }
}
