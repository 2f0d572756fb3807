//! Exit of a command: its code, and what is said about a failure.

use std::error::Error;

use frfid_experiment::{ConfigError, ExperimentError};
use frfid_files::FileError;
use frfid_paper::PaperError;
use frfid_report::ReportError;
use frfid_signals::SignalError;
use serde_json::{Value, json};

/// Version of what `--json` prints: it grows when a key changes its meaning or leaves.
pub(crate) const VERSION: u32 = 1;

/// Exit codes, the same for every command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Exit {
    /// Done.
    Done = 0,
    /// Failed.
    Failed = 1,
    /// The command line, a description or another input must be changed first.
    Usage = 2,
    /// Done, but data was lost or a check failed.
    Flawed = 3,
    /// Stopped by the user: 128 + SIGINT.
    Interrupted = 130,
}

impl Exit {
    /// Done, with a flaw unless everything is sound.
    pub(crate) fn flawed_unless(is_sound: bool) -> Self {
        if is_sound { Self::Done } else { Self::Flawed }
    }
}

/// Why a command could not be done.
#[derive(Debug)]
pub(crate) struct Failure {
    /// The exit code.
    pub exit: Exit,
    /// What was found, what was needed, what to do; the causes below it, one to a line.
    pub message: String,
}

impl Failure {
    /// The failure as `--json` tells it.
    pub(crate) fn as_json(&self) -> Value {
        let told = json!({ "exit_code": self.exit as i32, "message": self.message });
        json!({ "version": VERSION, "error": told })
    }

    /// The command line asks for something impossible.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self {
            exit: Exit::Usage,
            message: message.into(),
        }
    }

    /// An error that no other command line would have avoided.
    pub(crate) fn failed(error: &(dyn Error + 'static)) -> Self {
        Self::of(Exit::Failed, error)
    }

    /// An error with the whole chain of its causes.
    pub(crate) fn of(exit: Exit, error: &(dyn Error + 'static)) -> Self {
        let mut message = error.to_string();
        let mut cause = error.source();
        while let Some(error) = cause {
            let reason = error.to_string();
            if !message.contains(&reason) {
                message = format!("{message}\n  because: {reason}");
            }
            cause = error.source();
        }
        Self { exit, message }
    }
}

impl From<ExperimentError> for Failure {
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Config(error) => error.into(),
            ExperimentError::File(error) => error.into(),
            ExperimentError::Interrupted { .. } | ExperimentError::ShapingInterrupted { .. } => {
                Self::of(Exit::Interrupted, &error)
            }
            ExperimentError::Trail { .. }
            | ExperimentError::Logs { .. }
            | ExperimentError::NoModel
            | ExperimentError::Exceeds { .. } => Self::of(Exit::Usage, &error),
            error => Self::failed(&error),
        }
    }
}

impl From<ConfigError> for Failure {
    fn from(error: ConfigError) -> Self {
        Self::of(Exit::Usage, &error)
    }
}

impl From<FileError> for Failure {
    /// An output in the way, and a file that is not there, of the wrong kind or contradicts itself,
    /// are answered by another command line or another file; anything else has failed.
    fn from(error: FileError) -> Self {
        let exit = match error {
            FileError::Exists { .. }
            | FileError::NoFile { .. }
            | FileError::Input { .. }
            | FileError::Leftover { .. }
            | FileError::Format { .. }
            | FileError::Content { .. }
            | FileError::Shape { .. }
            | FileError::TooLarge { .. }
            | FileError::Io { action: "open", .. } => Exit::Usage,
            FileError::Stopped { .. } => Exit::Interrupted,
            _ => Exit::Failed,
        };
        Self::of(exit, &error)
    }
}

impl From<SignalError> for Failure {
    fn from(error: SignalError) -> Self {
        Self::failed(&error)
    }
}

impl From<PaperError> for Failure {
    fn from(error: PaperError) -> Self {
        Self::failed(&error)
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        Self::failed(&error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{fmt, io};

    #[derive(Debug)]
    struct Outer(io::Error);
    impl fmt::Display for Outer {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "cannot write a.json")
        }
    }
    impl Error for Outer {
        fn source(&self) -> Option<&(dyn Error + 'static)> {
            Some(&self.0)
        }
    }

    #[test]
    fn the_last_cause_of_a_chain_is_told() {
        let error = Outer(io::Error::other("no space left"));
        assert_eq!(
            Failure::of(Exit::Failed, &error).message,
            "cannot write a.json\n  because: no space left"
        );
    }

    #[test]
    fn every_kind_of_error_has_its_exit_code() {
        let config = ConfigError {
            file: "x.toml".into(),
            place: None,
            message: "wrong".into(),
        };
        let code = |error: ExperimentError| Failure::from(error).exit;
        assert_eq!(code(config.into()), Exit::Usage);
        assert_eq!(
            code(FileError::Exists { path: "a".into() }.into()),
            Exit::Usage
        );
        assert_eq!(
            code(FileError::Busy { path: "a".into() }.into()),
            Exit::Failed
        );
        assert_eq!(
            code(ExperimentError::Interrupted { done: 1, total: 2 }),
            Exit::Interrupted
        );
    }
}
