//! Errors of excitations, records and FRFs: found and needed values in every message.

use thiserror::Error;

use crate::limit::Limit;

/// Errors of the `signals` crate. Every variant says what was found and what was needed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SignalError {
    /// A parameter lies outside its range, is NaN or infinite.
    #[error("{key} is {found}, needed: {needed}")]
    Parameter {
        /// Name of the field, unit included; its key in files too.
        key: &'static str,
        /// The value given.
        found: f64,
        /// The range or property needed.
        needed: &'static str,
    },
    /// What follows from a parameter lies outside its range.
    #[error("{quantity} is {found}, needed: {needed}")]
    Derived {
        /// Name of the field it follows from.
        key: &'static str,
        /// What follows, in words, unit included.
        quantity: &'static str,
        /// Its value.
        found: f64,
        /// The range or property needed.
        needed: &'static str,
    },
    /// Values that do not go together.
    #[error("{what}")]
    Unfit {
        /// Name of the field that is wrong or missing.
        key: &'static str,
        /// What was found, what was needed and what to do.
        what: String,
    },
    /// Several realizations or periods of an excitation that is done once.
    #[error(
        "{key} is {found}, needed: 1 with a {excitation}: it has no random phases and no period"
    )]
    OnlyOnce {
        /// Which number.
        key: &'static str,
        /// Its value.
        found: usize,
        /// Name of the excitation.
        excitation: &'static str,
    },
    /// Limits that do not fit the axes.
    #[error("{} is {found:?}, needed: {number} for each of the {n_axes} axes", limit.key())]
    Limit {
        /// Which limit.
        limit: Limit,
        /// The values given.
        found: Vec<f64>,
        /// What each must be.
        number: &'static str,
        /// Number of axes.
        n_axes: usize,
    },
    /// One of several parts of the same kind has a parameter that does not fit.
    #[error("{part}: {source}")]
    In {
        /// Which part, in words.
        part: String,
        /// Where its fields are: keys of tables and numbers in lists.
        path: Vec<String>,
        /// What does not fit.
        source: Box<SignalError>,
    },
    /// The band reaches past the Nyquist frequency of the sampling.
    #[error(
        "high_hz = {high_hz} Hz is not below the Nyquist frequency {nyquist_hz} Hz of sample_time_s = {sample_time_s}; \
         lower high_hz or sample faster"
    )]
    AboveNyquist {
        /// Upper end of the band in Hz.
        high_hz: f64,
        /// Nyquist frequency in Hz.
        nyquist_hz: f64,
        /// Sample time in s.
        sample_time_s: f64,
    },
    /// The band holds no line of the grid.
    #[error(
        "no {grid} line lies between {low_hz} Hz and {high_hz} Hz at f0 = {fundamental_hz} Hz; widen the band or lower resolution_hz"
    )]
    EmptyBand {
        /// Kind of the grid.
        grid: &'static str,
        /// Lower end of the band in Hz.
        low_hz: f64,
        /// Upper end of the band in Hz.
        high_hz: f64,
        /// Line spacing in Hz.
        fundamental_hz: f64,
    },
    /// A line is not one of the period's DFT bins below Nyquist.
    #[error(
        "line {line} is not between 1 and {highest}, the lines of a period of {n_samples} samples below Nyquist"
    )]
    LineOffGrid {
        /// The line asked for.
        line: usize,
        /// Highest usable line.
        highest: usize,
        /// Samples per period.
        n_samples: usize,
    },
    /// An array has the wrong shape.
    #[error("{name} has shape {found:?}, needed {needed}")]
    Shape {
        /// Name of the array.
        name: &'static str,
        /// Its shape.
        found: Vec<usize>,
        /// What was needed, in words and numbers.
        needed: String,
    },
    /// Samples that are NaN or infinite.
    #[error(
        "{name}: {count} samples are NaN or infinite, the first in channel {channel} at sample {sample}; drop or repair them first"
    )]
    NotFinite {
        /// Name of the signal.
        name: &'static str,
        /// How many.
        count: usize,
        /// Channel of the first one.
        channel: usize,
        /// Sample of the first one.
        sample: usize,
    },
    /// Values for which the system has no memory.
    #[error("no memory for {n_values} values; ask for fewer, or free some")]
    Memory {
        /// How many.
        n_values: usize,
    },
    /// Work was ended because whoever asked for it said so.
    #[error("interrupted")]
    Interrupted,
    /// A plan was asked for a run that it does not hold.
    #[error(
        "the plan holds no run {id}; it has {n_realizations} realizations, {n_experiments} experiments, {n_repetitions} repetitions{glides}"
    )]
    NoSuchRun {
        /// The run asked for.
        id: String,
        /// Realizations of the plan.
        n_realizations: usize,
        /// Experiments of the plan.
        n_experiments: usize,
        /// Repetitions of the plan.
        n_repetitions: usize,
        /// Says whether glide runs exist.
        glides: &'static str,
    },
}

impl SignalError {
    /// [`SignalError::Parameter`] of a value out of range.
    #[must_use]
    pub fn parameter(key: &'static str, found: f64, needed: &'static str) -> Self {
        Self::Parameter { key, found, needed }
    }

    /// [`SignalError::Derived`] of a quantity that follows from a parameter.
    #[must_use]
    pub fn derived(
        key: &'static str,
        quantity: &'static str,
        found: f64,
        needed: &'static str,
    ) -> Self {
        Self::Derived {
            key,
            quantity,
            found,
            needed,
        }
    }

    /// [`SignalError::Unfit`] of values that do not go together.
    #[must_use]
    pub fn unfit(key: &'static str, what: impl Into<String>) -> Self {
        let what = what.into();
        Self::Unfit { key, what }
    }

    /// [`SignalError::Shape`] of an array or a list.
    #[must_use]
    pub fn shape(name: &'static str, found: &[usize], needed: impl Into<String>) -> Self {
        Self::Shape {
            name,
            found: found.to_vec(),
            needed: needed.into(),
        }
    }

    /// The same error of one of several parts, with the keys of the tables and the numbers in lists
    /// that lead to the part.
    #[must_use]
    pub fn within(self, part: impl Into<String>, path: Vec<String>) -> Self {
        let part = part.into();
        Self::In {
            part,
            path,
            source: Box::new(self),
        }
    }

    /// Where the value stands that is wrong: keys of tables and numbers in lists, the field last.
    /// Empty where no one value is wrong.
    #[must_use]
    pub fn path(&self) -> Vec<&str> {
        match self {
            Self::Parameter { key, .. }
            | Self::Derived { key, .. }
            | Self::Unfit { key, .. }
            | Self::OnlyOnce { key, .. } => vec![key],
            Self::Shape { name, .. } => vec![name],
            Self::Limit { limit, .. } => vec![limit.key()],
            Self::AboveNyquist { .. } | Self::EmptyBand { .. } => vec!["high_hz"],
            Self::In { path, source, .. } => {
                let within = path.iter().map(String::as_str);
                within.chain(source.path()).collect()
            }
            Self::LineOffGrid { .. }
            | Self::NotFinite { .. }
            | Self::Memory { .. }
            | Self::Interrupted
            | Self::NoSuchRun { .. } => Vec::new(),
        }
    }
}
