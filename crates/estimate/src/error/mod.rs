//! Errors of an estimate: found and needed values in every message.

pub(crate) mod aperiodic;
pub(crate) mod deficient_line;
pub(crate) mod unlined;

use frfid_signals::SignalError;
use thiserror::Error;

use crate::error::aperiodic::{Aperiodic, tried};
use crate::error::deficient_line::DeficientLine;
use crate::error::unlined::Unlined;
use crate::period_index::PeriodIndex;

/// Errors of the `estimate` crate. Every variant says what was found and what was needed. Channels,
/// experiments, periods and realizations count from 0.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EstimateError {
    /// Samples, shapes, lines or parameters that are already wrong as signals.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// Lines or frequencies that do not rise.
    #[error(
        "{name} must rise: entry {index} is {found} after {before}; sort them and drop duplicates"
    )]
    NotRising {
        /// Name of the list.
        name: &'static str,
        /// The first offending entry.
        index: usize,
        /// Its value.
        found: f64,
        /// The value before it.
        before: f64,
    },
    /// Fewer experiments than inputs: U has no right inverse.
    #[error(
        "{found} experiments for {needed} inputs; at least as many experiments as inputs are needed to tell the inputs apart line by line; from the lines around each frequency by the method local-rational"
    )]
    TooFewExperiments {
        /// Experiments given.
        found: usize,
        /// Inputs, the number needed.
        needed: usize,
    },
    /// Runs of the campaign that were never given.
    #[error("{} runs are missing, the first is realization {}, experiment {}, period {}; give them or drop the incomplete blocks", .missing.len(), .missing[0].realization, .missing[0].experiment, .missing[0].period)]
    Incomplete {
        /// Every missing run, in order; never empty.
        missing: Vec<PeriodIndex>,
    },
    /// A run was given twice.
    #[error("realization {}, experiment {}, period {} was given twice", .0.realization, .0.experiment, .0.period)]
    Duplicate(PeriodIndex),
    /// A width of a local model that leaves no freedom.
    #[error(
        "{half_width} lines to either side hold too few equations for a local model; {}",
        .needed.map_or("the record is too short for any".into(), |needed| format!("at least {needed} are needed"))
    )]
    NarrowWindow {
        /// Lines to either side.
        half_width: usize,
        /// Lines needed; `None` if the record is too short for any.
        needed: Option<usize>,
    },
    /// A record too short for a local model.
    #[error(
        "{n_lines} lines are too few for a local model of so many inputs; record longer, or more often"
    )]
    ShortRecord {
        /// Lines of the longest piece.
        n_lines: usize,
    },
    /// A list without entries.
    #[error("{0}: none was given, at least one is needed")]
    EmptyList(
        /// Name of the list.
        &'static str,
    ),
    /// On no line is every input excited and the experiments span the input space.
    #[error("{} of the lines cannot be inverted; {}", .0.len(), .0[0])]
    RankDeficient(
        /// Every such line, in order of frequency; never empty.
        Vec<DeficientLine>,
    ),
    /// A recording that had to be periodic is not.
    #[error(
        "not periodic: {}; {cause}", tried(*period, *residual, *limit)
    )]
    NotPeriodic {
        /// The best period found, in samples; 0 if there was no candidate.
        period: usize,
        /// Share of the power that does not repeat.
        residual: f64,
        /// Largest share allowed.
        limit: f64,
        /// What seems to be the reason.
        cause: Aperiodic,
    },
    /// A periodic reference of which no set of lines stands out.
    #[error(
        "no set of excited lines stands out: {cause}; the reference is no multisine, or --lines names its lines"
    )]
    NoLines {
        /// What seems to be the reason.
        cause: Unlined,
    },
    /// The response has not settled within the first half of the recording.
    #[error("the first {transient} of {n_periods} periods are still transient; record at least {} periods", 4 * .transient)]
    NotSettled {
        /// Periods recorded.
        n_periods: usize,
        /// Periods found to be transient, at least.
        transient: usize,
    },
    /// A frequency is no line of the period.
    #[error(
        "{frequency_hz} Hz is no line of a period of {n_samples} samples; the nearest line is {nearest_hz} Hz, and a period of {offered_samples} samples would have it"
    )]
    OffGrid {
        /// The frequency asked for, in Hz.
        frequency_hz: f64,
        /// Samples per period.
        n_samples: usize,
        /// Nearest line of this period in Hz.
        nearest_hz: f64,
        /// Nearest period, in samples, that has the frequency among its lines.
        offered_samples: usize,
    },
    /// Two FRFs that share too few frequencies to be compared.
    #[error("the FRFs cover {} to {} Hz and {} to {} Hz: {found} frequencies of one lie in the common band, at least 3 are needed", .a_hz.0, .a_hz.1, .b_hz.0, .b_hz.1)]
    NoCommonBand {
        /// Lowest and highest frequency of A in Hz.
        a_hz: (f64, f64),
        /// Lowest and highest frequency of B in Hz.
        b_hz: (f64, f64),
        /// Frequencies in the common band, of the FRF that has fewer there.
        found: usize,
    },
    /// A glide that moved the other way than the run.
    #[error(
        "axis {}: the glide moves at {glide_mean:.3e} on average, the run at {run_mean:.3e}; a glide in the direction of the run is needed",
        channel + 1
    )]
    OtherDirection {
        /// Output channel, from 0.
        channel: usize,
        /// Mean velocity of the run.
        run_mean: f64,
        /// Mean velocity of the glide.
        glide_mean: f64,
    },
    /// A record without positions, where torque over position was asked for.
    #[error(
        "the {0} has no motor position; record position_rad, or subtract the glide sample by sample"
    )]
    NoPosition(
        /// Which record.
        &'static str,
    ),
    /// A glide that turns back.
    #[error(
        "axis {}: the glide goes back by {back_rad:.3e} rad on a way of {way_rad:.3e} rad, so that a position has no one torque; \
         glide faster, or subtract the glide sample by sample",
        channel + 1
    )]
    NotMonotone {
        /// Axis, from 0.
        channel: usize,
        /// How far it goes back in rad.
        back_rad: f64,
        /// Its whole way in rad.
        way_rad: f64,
    },
    /// A run that goes further than its glide.
    #[error(
        "axis {}: the run goes {beyond_rad:.3e} rad beyond the glide's {low_rad:.4} to {high_rad:.4} rad, at most {allowed_rad:.3e} rad \
         are allowed; start both at the same place and let the glide last as long as the run",
        channel + 1
    )]
    BeyondGlide {
        /// Axis, from 0.
        channel: usize,
        /// How far beyond in rad.
        beyond_rad: f64,
        /// How far it may go in rad.
        allowed_rad: f64,
        /// Lowest position of the glide in rad.
        low_rad: f64,
        /// Highest position of the glide in rad.
        high_rad: f64,
    },
    /// A plant that has no inverse at a frequency.
    #[error(
        "the plant's FRF cannot be inverted at {frequency_hz} Hz; an estimate in which every axis responds is needed"
    )]
    SingularPlant {
        /// The frequency in Hz.
        frequency_hz: f64,
    },
    /// A signal that does not hold the chirp at a frequency.
    #[error(
        "{frequency_hz} Hz: the signal is zero there, so that harmonics have nothing to be compared with"
    )]
    NoFundamental {
        /// Frequency of the fundamental in Hz.
        frequency_hz: f64,
    },
    /// A frequency the chirp never reaches, or too close to the ends of the recording.
    #[error("{frequency_hz} Hz: {reason}; the recording holds {low_s} s to {high_s} s")]
    OutsideChirp {
        /// The frequency asked for, in Hz.
        frequency_hz: f64,
        /// What is wrong.
        reason: &'static str,
        /// Start of the recording in s.
        low_s: f64,
        /// End of the recording in s.
        high_s: f64,
    },
}

impl EstimateError {
    /// [`SignalError::Shape`] of a signal or an FRF.
    pub(crate) fn shape(name: &'static str, found: &[usize], needed: String) -> Self {
        SignalError::shape(name, found, needed).into()
    }

    /// [`SignalError::Parameter`] of a value out of range.
    pub(crate) fn parameter(key: &'static str, found: f64, needed: &'static str) -> Self {
        SignalError::parameter(key, found, needed).into()
    }
}
