//! Float64MultiArray of playbacks: a message for each sample, in an MCAP, for controllers that forward commands.

use std::io::Write;
use std::path::Path;

use frfid_signals::Playback;
use mcap::McapResult;
use ndarray::Array2;

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::mcap::write::{RosWriter, Topic, time_ns};
use crate::playback::{PlaybackFile, signals};
use crate::ros::trajectory::{FLOAT64_ARRAY, encode_array};
use crate::run::topics;

/// To be remapped to the `~/commands` of a controller.
const TOPIC: &str = "/commands";

/// Writes a `std_msgs/msg/Float64MultiArray` for each sample, velocities in rad/s or efforts in N m, and a text on
/// `/frfid/events` at the start of every run. The messages bear no time: what plays them sets the clock.
///
/// # Errors
/// [`FileError::Shape`] for what does not fit together; those of writing (see [`Overwrite`]).
pub(crate) fn write_float_array(
    path: &Path,
    overwrite: Overwrite,
    file: &PlaybackFile,
) -> Result<(), FileError> {
    file.check()?;
    write_file(path, overwrite, |to| {
        let mut writer = RosWriter::new(to)?;
        let mut events = writer.text_topic(topics::EVENTS)?;
        let mut commands = writer.topic(TOPIC, &FLOAT64_ARRAY)?;
        for run in file.named() {
            writer.text(&mut events, file.stamp_ns(run.first_k), &file.told(&run))?;
            file.write_commands(run.first_k, run.playback, &mut writer, &mut commands)?;
        }
        Ok(writer.finish()?)
    })
}

impl PlaybackFile {
    fn write_commands<W: Write>(
        &self,
        first_k: usize,
        playback: &Playback,
        writer: &mut RosWriter<W>,
        commands: &mut Topic,
    ) -> McapResult<()> {
        for (sample, values) in commanded(playback).columns().into_iter().enumerate() {
            let stamp_ns = self.stamp_ns(first_k + sample);
            writer.encoded(commands, stamp_ns, |cdr| encode_array(values, cdr))?;
        }
        Ok(())
    }

    fn stamp_ns(&self, k: usize) -> u64 {
        time_ns(k as f64 / self.rate_hz())
    }
}

/// The velocity of a motion, or the torque.
fn commanded(playback: &Playback) -> &Array2<f64> {
    let signals = signals(playback);
    signals.get(1).copied().unwrap_or(signals[0])
}
