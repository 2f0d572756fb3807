//! Formats of an exported plan: the table that the command line, its help and Python go by. A format is a
//! file of this folder and a row here.

use std::path::Path;

use crate::atomic_write::Overwrite;
use crate::error::FileError;
use crate::playback::PlaybackFile;
use crate::playback::csv::write_playback_csv;
use crate::playback::float_array::write_float_array;
use crate::playback::joint_trajectory::write_joint_trajectory;
use crate::playback::mat::write_playback_mat;

/// A format that plans are exported to.
#[derive(Debug)]
pub struct PlayFormat {
    /// Its name.
    pub name: &'static str,
    /// Ending of its files.
    pub suffix: &'static str,
    /// What it holds, and for whom.
    pub describes: &'static str,
    /// Whether it is a table, whose form can be chosen.
    pub is_table: bool,
    /// A file that goes with those of a folder: its name and its text.
    pub companion: Option<(&'static str, &'static str)>,
    /// Writes one run, or several one after the other.
    pub write: fn(&Path, Overwrite, &PlaybackFile) -> Result<(), FileError>,
}

impl PlayFormat {
    /// The format of this name.
    ///
    /// # Errors
    /// [`FileError::Shape`] with the names that there are.
    pub fn named(name: &str) -> Result<&'static Self, FileError> {
        let format = PLAY_FORMATS.iter().find(|format| format.name == name);
        format.ok_or_else(|| FileError::shape("format", name, format!("one of {}", Self::names())))
    }

    /// The names of all formats.
    #[must_use]
    pub fn names() -> String {
        PLAY_FORMATS.map(|format| format.name).join(", ")
    }

    /// The first format whose files end as this one does, in capitals or not.
    #[must_use]
    pub fn of_suffix(path: &Path) -> Option<&'static Self> {
        PLAY_FORMATS.iter().find(|format| format.is_ending_of(path))
    }

    /// Whether a file ends as those of this format do.
    #[must_use]
    pub fn is_ending_of(&self, path: &Path) -> bool {
        let ending = path.extension();
        ending.is_some_and(|ending| ending.eq_ignore_ascii_case(self.suffix))
    }
}

/// The formats that plans are exported to.
pub const PLAY_FORMATS: [PlayFormat; 4] = [
    PlayFormat {
        name: "csv",
        suffix: "csv",
        describes: "A row for each sample: PLCs, controllers, programs of all kinds",
        is_table: true,
        companion: None,
        write: write_playback_csv,
    },
    PlayFormat {
        name: "mat",
        suffix: "mat",
        describes: "The same for Simulink, MATLAB and Octave (level 5)",
        is_table: true,
        companion: None,
        write: write_playback_mat,
    },
    PlayFormat {
        name: "joint-trajectory",
        suffix: "mcap",
        describes: "A trajectory_msgs/JointTrajectory for each run, for ros2_control, with a node that plays them",
        is_table: false,
        companion: Some(("play.py", include_str!("play.py"))),
        write: write_joint_trajectory,
    },
    PlayFormat {
        name: "float64-array",
        suffix: "mcap",
        describes: "A std_msgs/Float64MultiArray on /commands for each sample, for ros2 bag play; the messages bear no time, so that \
                    timing is what the player makes of it",
        is_table: false,
        companion: None,
        write: write_float_array,
    },
];
