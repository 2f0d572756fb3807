//! JointTrajectory of playbacks: one message for a joint_trajectory_controller, in an MCAP.

use std::io::Write;
use std::path::Path;

use frfid_signals::Playback;
use mcap::McapResult;

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::mcap::write::{RosWriter, START_NS};
use crate::playback::{PlaybackFile, signals};
use crate::ros::trajectory::{JOINT_TRAJECTORY, TrajectoryPoint, encode_trajectory};
use crate::run::topics;

/// Where a controller of the usual name listens.
const TOPIC: &str = "/joint_trajectory_controller/joint_trajectory";

/// Writes one `trajectory_msgs/msg/JointTrajectory`: a point for each sample with positions, velocities and
/// accelerations, from which a controller interpolates by quintics; or with the pose and efforts.
///
/// Sample k is reached k + 1 sample times after the start. Of the rest that it begins with only the last sample
/// is a point: the controller takes the whole rest to get there from where the robot stands, not one sample.
///
/// # Errors
/// [`FileError::Shape`] for what does not fit together; those of writing (see [`Overwrite`]).
pub(crate) fn write_joint_trajectory(
    path: &Path,
    overwrite: Overwrite,
    file: &PlaybackFile,
) -> Result<(), FileError> {
    file.check()?;
    let (points, frame_id) = (file.points(), file.frame_id());
    write_file(path, overwrite, |to| {
        let mut writer = RosWriter::new(to)?;
        file.write_start(&mut writer)?;
        let mut topic = writer.topic(TOPIC, &JOINT_TRAJECTORY)?;
        writer.encoded(&mut topic, START_NS, |cdr| {
            encode_trajectory(&frame_id, &file.joint_names, &points, cdr);
        })?;
        Ok(writer.finish()?)
    })
}

impl PlaybackFile {
    /// The event of the first run.
    fn write_start<W: Write>(&self, writer: &mut RosWriter<W>) -> McapResult<()> {
        let mut events = writer.text_topic(topics::EVENTS)?;
        let named = self.named();
        let first = named.first().map(|run| self.told(run));
        writer.text(&mut events, START_NS, &first.unwrap_or_default())
    }

    /// Run and plan, in the only text of a trajectory that comes back.
    fn frame_id(&self) -> String {
        format!("frfid {} {}", self.name, self.plan_id)
    }

    fn points(&self) -> Vec<TrajectoryPoint> {
        let samples = self.samples().enumerate().skip(self.last_at_rest());
        samples
            .map(|(k, (playback, sample))| self.point(k, playback, sample))
            .collect()
    }

    fn point(&self, k: usize, playback: &Playback, sample: usize) -> TrajectoryPoint {
        let signals = signals(playback).into_iter();
        self.timed(k, signals.map(|signal| signal.column(sample).to_vec()))
    }

    /// A point of position, velocity and acceleration, or of the pose and an effort.
    fn timed(&self, k: usize, mut values: impl Iterator<Item = Vec<f64>>) -> TrajectoryPoint {
        let mut next = || values.next().unwrap_or_default();
        let effort = if self.is_torque() { next() } else { Vec::new() };
        let positions = if self.is_torque() {
            self.pose_rad.clone()
        } else {
            next()
        };
        TrajectoryPoint {
            positions,
            velocities: next(),
            accelerations: next(),
            effort,
            time_from_start_ns: self.reached_ns(k),
        }
    }

    /// When a sample is reached, after the start.
    fn reached_ns(&self, k: usize) -> u64 {
        ((k + 1) as f64 / self.rate_hz() * 1e9).round() as u64
    }

    /// The last sample of the rest that the file begins with.
    fn last_at_rest(&self) -> usize {
        let first = self.playbacks.first().map(|playback| signals(playback));
        let signals = first.unwrap_or_default();
        let is_first = |k: usize| {
            signals
                .iter()
                .all(|signal| signal.column(k) == signal.column(0))
        };
        let n = signals.first().map_or(0, |signal| signal.ncols());
        let n_rest = (0..n).take_while(|&k| is_first(k)).count();
        n_rest.saturating_sub(1)
    }
}

#[cfg(test)]
mod tests {
    use crate::playback::testing::{file, motion, resting};

    #[test]
    fn the_rest_before_a_run_is_the_time_to_get_there() {
        let file = file(vec![resting(5), motion(3)]);
        let points = file.points();
        let times: Vec<u64> = points
            .iter()
            .map(|point| point.time_from_start_ns)
            .collect();
        assert_eq!(times, [10_000_000, 12_000_000, 14_000_000, 16_000_000]);
        assert_eq!(points[0].velocities, [0.0, 0.0]);
        assert_eq!(file.frame_id(), "frfid p000-m0-q0 3735928559");
    }
}
