//! Recording of others while it is looked at, and what is not used of them.

mod cut;
mod looking;
mod losses;
pub(in crate::estimate::others) mod reading;
pub(in crate::estimate::others) mod units;

use std::fmt;
use std::path::PathBuf;

use frfid_estimate::{EstimateError, Oddity};
use frfid_files::{Log, Loss};
use ndarray::ArrayView2;

use crate::error::ExperimentError;

/// A recording that was read.
#[derive(Debug)]
pub(in crate::estimate::others) struct Recording {
    /// Place among all that were given, from 0.
    pub(in crate::estimate::others) place: usize,
    pub(in crate::estimate::others) name: String,
    pub(in crate::estimate::others) log: Log,
    /// What is odd about its signals, wraps and holds that were mended included.
    pub(in crate::estimate::others) odd: Vec<Odd>,
}

/// What is odd about a signal.
#[derive(Debug, Clone)]
pub(in crate::estimate::others) struct Odd {
    pub(in crate::estimate::others) signal: String,
    pub(in crate::estimate::others) channel: usize,
    pub(in crate::estimate::others) role: Role,
    pub(in crate::estimate::others) oddity: Oddity,
    /// Whether it was mended.
    pub(in crate::estimate::others) is_cured: bool,
}

/// What a signal is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::estimate::others) enum Role {
    Input,
    Output,
    Reference,
    Position,
}

/// A recording, or a part of one, that is not used.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::estimate::others) struct Unused {
    /// Place of the recording among all that were given, from 0.
    pub(in crate::estimate::others) place: usize,
    name: String,
    reason: String,
}

impl Unused {
    pub(in crate::estimate::others) fn new(
        place: usize,
        name: impl Into<String>,
        reason: impl Into<String>,
    ) -> Self {
        Self {
            place,
            name: name.into(),
            reason: reason.into(),
        }
    }
}

impl fmt::Display for Unused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, reason, .. } = self;
        match reason.strip_prefix(&format!("{name}: ")) {
            Some(reason) => write!(f, "{name}: not used: {reason}"),
            None => write!(f, "{name}: not used: {reason}"),
        }
    }
}

impl Recording {
    pub(in crate::estimate::others) fn new(place: usize, name: String, log: Log) -> Self {
        Self {
            place,
            name,
            log,
            odd: Vec::new(),
        }
    }

    /// An error of the estimate with the name of the recording, and what is lost of it: damage to the
    /// file before what is missing because of it.
    pub(in crate::estimate::others) fn complaint(
        &self,
    ) -> impl Fn(EstimateError) -> ExperimentError {
        let path = PathBuf::from(&self.name);
        let losses = self.log.losses.iter();
        let first = losses.min_by_key(|loss| loss.topic != "file");
        let lost = first.map(Loss::to_string);
        move |source| ExperimentError::Recording {
            path: path.clone(),
            source,
            lost: lost.clone(),
        }
    }

    /// That it is not used, and why.
    pub(in crate::estimate::others) fn unused(&self, reason: impl fmt::Display) -> Unused {
        Unused::new(self.place, &self.name, reason.to_string())
    }

    /// The reference, or the input where none was recorded.
    pub(in crate::estimate::others) fn reference(&self) -> ArrayView2<'_, f64> {
        let record = &self.log.record;
        record.r.as_ref().unwrap_or(&record.u).view()
    }
}
