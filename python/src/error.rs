//! Errors of the crates as Python exceptions: `ValueError` for bad input, `NumericalError` for
//! singular or divergent.

use std::fmt::Display;
use std::fs::File;
use std::path::Path;

use frfid_estimate::{EstimateError, ShapeError};
use frfid_experiment::{ConfigError, ExperimentError};
use frfid_files::{FileError, visible};
use frfid_plant::PlantError;
use frfid_report::ReportError;
use frfid_signals::{SignalError, TestbedError};
use pyo3::PyErr;
use pyo3::exceptions::{
    PyArithmeticError, PyFileExistsError, PyKeyboardInterrupt, PyMemoryError, PyOSError,
    PyValueError,
};

pyo3::create_exception!(
    frfid,
    NumericalError,
    PyArithmeticError,
    "The numbers gave out: a matrix that cannot be inverted, a simulation that diverged, a search that found nothing."
);

/// A file that is not there, as `open` says it: with number and name.
pub(crate) fn check_there(path: &Path) -> Result<(), PyErr> {
    let opened = path.metadata().and_then(|found| match found.is_file() {
        true => File::open(path).map(drop),
        false => Ok(()), // a folder of recordings, or a pipe that waits for who writes
    });
    opened.map_err(|reason| refused(path, &reason.to_string()))
}

/// What the operating system refused: of the class that Python has for the number in the reason.
fn refused(path: &Path, reason: &str) -> PyErr {
    let (words, number) = reason.split_once(" (os error ").unwrap_or((reason, ""));
    match number.trim_end_matches(')').parse::<i32>() {
        Ok(number) => PyOSError::new_err((number, visible(words), path.to_path_buf())),
        Err(_) => PyOSError::new_err(visible(&format!("{}: {reason}", path.display()))),
    }
}

/// Bad input, in the words of the crate that found it.
pub(crate) fn signal(error: SignalError) -> PyErr {
    match error {
        SignalError::Memory { .. } => PyMemoryError::new_err(told(&error)),
        SignalError::Interrupted => PyKeyboardInterrupt::new_err(told(&error)),
        _ => PyValueError::new_err(told(&error)),
    }
}

/// A matrix that cannot be inverted is a matter of numbers, everything else of the recording that
/// was given.
pub(crate) fn estimate(error: EstimateError) -> PyErr {
    match error {
        EstimateError::RankDeficient(_) => NumericalError::new_err(told(&error)),
        EstimateError::Signal(error) => signal(error),
        _ => PyValueError::new_err(told(&error)),
    }
}

/// Whatever happens while a reference is shaped.
pub(crate) fn shape(error: ShapeError) -> PyErr {
    match error {
        ShapeError::Estimate(error) => estimate(error),
        ShapeError::Testbed(error) => testbed(error),
        _ => PyValueError::new_err(told(&error)),
    }
}

/// A simulation that diverged is a matter of numbers; what a testbed written in Python raised comes
/// back as it was.
pub(crate) fn testbed(error: TestbedError) -> PyErr {
    match error {
        TestbedError::Diverged { .. } => NumericalError::new_err(told(&error)),
        TestbedError::Run(error) => signal(error),
        TestbedError::Foreign { run, source } => match source.downcast::<PyErr>() {
            Ok(raised) => *raised,
            Err(source) if matches!(source.downcast_ref(), Some(PlantError::Chatter { .. })) => {
                NumericalError::new_err(format!("run {run}: {source}"))
            }
            Err(source) => PyValueError::new_err(format!("run {run}: {source}")),
        },
    }
}

/// What is wrong in a TOML file, with its place.
pub(crate) fn config(error: ConfigError) -> PyErr {
    PyValueError::new_err(told(&error))
}

/// Files that cannot be read or written are `OSError`s, files that say something wrong are not.
pub(crate) fn file(error: FileError) -> PyErr {
    match error {
        FileError::Exists { .. } | FileError::NoFile { .. } | FileError::Input { .. } => {
            PyFileExistsError::new_err(told(&error))
        }
        FileError::Format { .. } | FileError::Content { .. } | FileError::Shape { .. } => {
            PyValueError::new_err(told(&error))
        }
        FileError::Io {
            path,
            action,
            reason,
        } if reason.contains("(os error ") => refused(&path, &format!("cannot {action}: {reason}")),
        _ => PyOSError::new_err(told(&error)),
    }
}

/// What cannot be drawn.
pub(crate) fn report(error: ReportError) -> PyErr {
    PyValueError::new_err(told(&error))
}

/// Whatever happens on the way from a description to an FRF.
pub(crate) fn experiment(error: ExperimentError) -> PyErr {
    match error {
        ExperimentError::Config(error) => config(error),
        ExperimentError::File(error) => file(error),
        ExperimentError::Signal(error) => signal(error),
        ExperimentError::Plant(
            error @ (PlantError::Diverged { .. } | PlantError::Chatter { .. }),
        ) => NumericalError::new_err(told(&error)),
        ExperimentError::Testbed(error) => testbed(error),
        ExperimentError::Estimate(error) => estimate(error),
        ExperimentError::Interrupted { .. } => PyKeyboardInterrupt::new_err(told(&error)),
        _ => PyValueError::new_err(told(&error)),
    }
}

/// What an error says; names out of a file are shown, they do not act.
fn told(error: &impl Display) -> String {
    visible(&error.to_string())
}
