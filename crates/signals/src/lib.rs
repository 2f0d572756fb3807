//! Signals, those commanded and those measured: line grids, excitations, experiment plans, records
//! and the FRF type.
//!
//! The leaf of the house: no files, no clock, no global random state. Frequencies are in Hz,
//! everything else in SI units, the unit ends the name. Time series are `(channel, sample)`,
//! campaigns `(realization, experiment, period, channel, sample)`, FRFs
//! `(frequency, output, input)`. The DFT has no factor forward and 1/N back, so the physical
//! single-sided amplitude of a line is 2|X|/N. Equation numbers are those of Saupe and Knoblach,
//! MSSP 52-53 (2015) 60-72, cited SK15.

mod confidence;
mod distortion;
mod error;
mod excitation;
mod frf;
mod harmonics;
mod limit;
mod limits;
mod number;
mod peaks;
mod plan;
mod playback;
mod record;

pub use confidence::confidence_factor_95;
pub use distortion::{Distortion, DistortionLevel, SignalLevels, median_db};
pub use error::SignalError;
pub use excitation::*;
pub use frf::{Frf, Uncertainty};
pub use harmonics::{Amplitudes, HarmonicLevel, Harmonics};
pub use limit::Limit;
pub use limits::{Excess, Limits};
pub use number::divisor::greatest_common_divisor;
pub use number::median::median;
pub use number::spacing::log_spaced;
pub use number::{checks, format, power, random, room};
pub use peaks::{Peaks, largest_by_axis};
pub use plan::Plan;
pub use plan::run::{Run, RunId, RunKind};
pub use plan::testbed::{Testbed, TestbedError};
pub use playback::{Motion, Playback, Played, Player};
pub use record::{Event, EventKind, InputKind, Record, check_finite};
