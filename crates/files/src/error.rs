//! Errors of files: the path, what was found, what was needed, what to do.

use std::error::Error;
use std::fmt::Display;
use std::path::{Path, PathBuf};

use thiserror::Error as ThisError;

/// Errors of the `files` crate.
#[derive(Debug, ThisError)]
pub enum FileError {
    /// The operating system refused to open or read.
    #[error("{}: cannot {action}: {reason}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// The operating system's reason.
        reason: String,
    },
    /// The output exists and was not to be replaced.
    #[error("{} exists; choose another name or say that it may be replaced (--force, in Python overwrite=True)", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The output is there, and no regular file: nothing is put in its place, whatever was said.
    #[error("{} is {kind}, no file: it is not replaced; choose another name", path.display())]
    NoFile {
        /// What was to be written.
        path: PathBuf,
        /// What is there: a symbolic link, a folder, a device, a pipe or a socket.
        kind: &'static str,
    },
    /// The output is one of the files that it is made of.
    #[error("{} is what is read, and would be gone: it is not replaced; choose another name", path.display())]
    Input {
        /// What was to be written.
        path: PathBuf,
    },
    /// A half-written file of an earlier, killed run lies in the way.
    #[error(
        "{} is left from a run that did not finish; salvage it (frfid recover), delete it, or say that it may be replaced (--force, in Python overwrite=True)",
        path.display()
    )]
    Leftover {
        /// The half-written file.
        path: PathBuf,
    },
    /// Another process is writing the same file.
    #[error("{} is being written by another process", path.display())]
    Busy {
        /// The file being written.
        path: PathBuf,
    },
    /// Writing failed; what was written so far was kept.
    #[error("{}: cannot write: {reason}; the first {saved_bytes} bytes are kept in {}", path.display(), part.display())]
    Write {
        /// The file that was to be written.
        path: PathBuf,
        /// Where the bytes written so far are.
        part: PathBuf,
        /// How many bytes these are.
        saved_bytes: u64,
        /// The whole chain of reasons, down to the operating system's.
        reason: String,
    },
    /// The file is of another kind.
    #[error("{}: found {found}, needed {needed}; {advice}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What it is.
        found: String,
        /// What it should be.
        needed: &'static str,
        /// Which tool converts it, or what else to do.
        advice: String,
    },
    /// The content contradicts itself or what was asked for.
    #[error("{}: {what}: found {found}, needed {needed}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// Which part of it, down to topic, message and field.
        what: String,
        /// What was found.
        found: String,
        /// What was needed.
        needed: String,
    },
    /// What a file holds, or says that it holds, would take more memory than it may.
    #[error("{}: {what} would take {size}; {reason}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Which part of it.
        what: String,
        /// How much memory it would take.
        size: String,
        /// How much it may take, and what to do.
        reason: String,
    },
    /// Somebody asked to stop.
    #[error("{}: stopped while it was read", path.display())]
    Stopped {
        /// The file.
        path: PathBuf,
    },
    /// What was to be written does not fit together.
    #[error("{what}: found {found}, needed {needed}")]
    Shape {
        /// Which part.
        what: &'static str,
        /// What was given.
        found: String,
        /// What was needed.
        needed: String,
    },
}

impl FileError {
    /// Names the file and what was tried, for the reason that the operating system gives.
    pub fn cannot<E: Display>(action: &'static str, path: &Path) -> impl Fn(E) -> Self + Copy {
        move |reason| Self::Io {
            path: path.into(),
            action,
            reason: reason.to_string(),
        }
    }

    /// The error under the name of another file: the one that was given, where a copy of it was read.
    pub(crate) fn of_file(mut self, given: &Path) -> Self {
        match &mut self {
            Self::Io { path, .. }
            | Self::Format { path, .. }
            | Self::Content { path, .. }
            | Self::TooLarge { path, .. }
            | Self::Stopped { path } => {
                *path = given.into();
            }
            _ => {}
        }
        self
    }

    /// The error of a file that is damaged, too, which may be the reason; each is told once.
    pub(crate) fn beside(mut self, damage: Option<&str>) -> Self {
        if let (Self::Content { found, .. } | Self::Format { found, .. }, Some(reason)) =
            (&mut self, damage)
            && !found.contains(reason)
        {
            *found += &format!(" (the file is damaged: {reason})");
        }
        self
    }

    /// The file is of another kind.
    #[must_use]
    pub fn format(
        path: &Path,
        found: impl Into<String>,
        needed: &'static str,
        advice: impl Into<String>,
    ) -> Self {
        Self::Format {
            path: path.into(),
            found: found.into(),
            needed,
            advice: advice.into(),
        }
    }

    /// A part of the file contradicts itself or what was asked for.
    pub(crate) fn content(
        path: &Path,
        what: impl Into<String>,
        found: impl Into<String>,
        needed: impl Into<String>,
    ) -> Self {
        Self::Content {
            path: path.into(),
            what: what.into(),
            found: found.into(),
            needed: needed.into(),
        }
    }

    /// A part of what was to be written does not fit.
    pub(crate) fn shape(
        what: &'static str,
        found: impl Into<String>,
        needed: impl Into<String>,
    ) -> Self {
        Self::Shape {
            what,
            found: found.into(),
            needed: needed.into(),
        }
    }
}

/// An error with all its causes, outermost first: some libraries hide the operating system's reason
/// in the last one.
pub(crate) fn chain(error: &(dyn Error + 'static)) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let next = error.to_string();
        if !text.contains(&next) {
            text = format!("{text}: {next}");
        }
        cause = error.source();
    }
    text
}
