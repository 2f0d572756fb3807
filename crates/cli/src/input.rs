//! Input of a command: the kind of file that it needs, and what is said of any other.

use std::path::{Path, PathBuf};

use frfid_files::FileKind;

use crate::exit::Failure;

/// What a command needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Needed {
    /// `experiment.toml`.
    Description,
    /// A description or a plan.
    Runs,
    /// Logs of ours or of others, or folders of them.
    Logs,
    /// A log, whole or not.
    Log,
    /// A log, a plan or a result.
    Any,
    /// A result.
    Result,
    /// A result, a plan or a description.
    Exportable,
}

impl Needed {
    /// Whether a file of this kind is one, or may be: what cannot be told is left to the reader.
    fn takes(self, kind: FileKind, path: &Path) -> bool {
        let is_toml = path.extension().is_some_and(|ending| ending == "toml");
        match (self, kind) {
            (Self::Description, FileKind::Text | FileKind::Empty)
            | (Self::Result, FileKind::Result) => true,
            (Self::Description | Self::Result, _) => false,
            (Self::Exportable, FileKind::Result) => true,
            (Self::Runs | Self::Exportable, FileKind::Plan | FileKind::Recording) => true,
            (Self::Runs | Self::Exportable, FileKind::Text | FileKind::Empty) => is_toml,
            (Self::Runs | Self::Exportable, _) => false,
            (_, FileKind::Stream) | (Self::Log, FileKind::Folder) => false,
            (Self::Any, FileKind::Plan | FileKind::Result) => true,
            (Self::Any, FileKind::Empty) => false,
            (Self::Logs | Self::Any, FileKind::Text) => !is_toml,
            (
                Self::Logs | Self::Log | Self::Any,
                FileKind::Plan
                | FileKind::Result
                | FileKind::Shaping
                | FileKind::Json
                | FileKind::Urdf
                | FileKind::Page,
            ) => false,
            (Self::Logs | Self::Log | Self::Any, _) => true,
        }
    }

    fn in_words(self) -> &'static str {
        match self {
            Self::Description => "the description of an experiment (TOML)",
            Self::Runs => {
                "the description of an experiment (.toml) or a plan of frfid design (MCAP)"
            }
            Self::Logs => "logs, recordings (MCAP, rosbag2, CSV, MAT, NPZ) or folders of them",
            Self::Log => "a log (MCAP)",
            Self::Any => "logs, recordings (MCAP, rosbag2, CSV, MAT, NPZ), plans or results",
            Self::Result => "a result of frfid estimate (JSON)",
            Self::Exportable => {
                "a result of frfid estimate (JSON), a plan of frfid design (MCAP) or the description of an experiment (.toml)"
            }
        }
    }

    /// How one comes by it.
    fn made_by(self) -> &'static str {
        match self {
            Self::Description | Self::Runs => {
                "frfid init multisine -o experiment.toml writes a description to start from"
            }
            Self::Logs | Self::Log | Self::Any => "frfid run makes logs of a plan",
            Self::Result | Self::Exportable => "frfid estimate LOGS -o frf.json makes one of logs",
        }
    }

    /// What to do with a file of another kind.
    fn advice(self, kind: FileKind, path: &Path) -> String {
        let path = path.display();
        match (kind, self) {
            (FileKind::Folder, Self::Result | Self::Runs | Self::Exportable) => {
                format!(
                    "name a file in it; if it holds logs, frfid estimate {path} -o frf.json makes a result of them"
                )
            }
            (FileKind::Folder, _) => "name a file in it".into(),
            (FileKind::Stream, _) => "write it to a file first: it is read more than once".into(),
            (FileKind::Text, Self::Any) => format!("frfid check {path} looks into a description"),
            (FileKind::Plan, _) => format!("frfid run {path} -o logs does its runs"),
            (FileKind::Run, _) => format!("frfid estimate {path} -o frf.json makes a result of it"),
            (FileKind::Recording, Self::Result) => {
                format!(
                    "frfid estimate {path} -o frf.json makes a result of it, once it says which signal is which (--map)"
                )
            }
            (FileKind::Result, _) => {
                "frfid report, frfid compare and frfid export take results".into()
            }
            (FileKind::Shaping, _) => "the result of a shaping is frf.json beside it".into(),
            (FileKind::Urdf, _) => format!(
                "frfid init urdf {path} writes a description with it in its table [robot.urdf]"
            ),
            (FileKind::Page, Self::Result) => "give the result that it was made of".into(),
            _ => self.made_by().into(),
        }
    }
}

/// Refuses a file of another kind than `needed`. A file that cannot be looked into is left to its
/// reader, who says why.
pub(crate) fn check(path: &Path, needed: Needed) -> Result<(), Failure> {
    let Ok(kind) = FileKind::of(path) else {
        return Ok(());
    };
    if needed.takes(kind, path) {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "{}: found {}, needed {}; {}",
        path.display(),
        kind.name(),
        needed.in_words(),
        needed.advice(kind, path)
    )))
}

/// The same of several.
pub(crate) fn check_all(paths: &[PathBuf], needed: Needed) -> Result<(), Failure> {
    paths.iter().try_for_each(|path| check(path, needed))
}
