//! Why a recording is not periodic, as advice.

use std::fmt;

/// What the best period leaves unexplained; where that is little enough, too little of the recording
/// has it.
pub(super) fn tried(period: usize, residual: f64, limit: f64) -> String {
    if residual <= limit {
        return format!(
            "what can be compared repeats after {period} samples, but that is too little of the recording"
        );
    }
    format!(
        "the best period tried ({period} samples) leaves {residual:.1e} of the power unexplained, at most {limit:.1e} is allowed"
    )
}

/// Why a recording is not periodic.
#[derive(Debug, Clone, PartialEq)]
pub enum Aperiodic {
    /// No channel moves.
    Silent,
    /// The frequency of the signal rises, or falls, once from beginning to end.
    SingleSweep,
    /// Some of it repeats, but most of what moves does not.
    Partly {
        /// First sample of the longest run that repeats.
        first: usize,
        /// One past its last sample.
        end: usize,
        /// Periods in it.
        n_periods: usize,
    },
    /// A period that was given is not that of the recording.
    OtherPeriod,
    /// A period that was given, of which less than one is there to be compared.
    TooLittle,
    /// Nothing repeats.
    Nothing,
}

impl fmt::Display for Aperiodic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silent => write!(
                f,
                "no channel moves; record the excitation itself, or name the channel that holds it"
            ),
            Self::SingleSweep => write!(
                f,
                "it looks like one sweep, which is estimated as a whole record where nothing is asked for that takes \
                 periods"
            ),
            Self::Partly {
                first,
                end,
                n_periods,
            } => write!(
                f,
                "samples {first} to {end} hold {n_periods} periods, but most of what moves lies outside of them; \
                 cut it off with --start and --end"
            ),
            Self::OtherPeriod => write!(
                f,
                "the period that was given is not that of the recording; without --period it is searched for"
            ),
            Self::TooLittle => write!(
                f,
                "most of its periods are lost in part; record it again, or longer"
            ),
            Self::Nothing => write!(
                f,
                "no stretch is followed by its repetition; repeat the excitation back to back, give --period if the \
                 recording holds one period, or ask for nothing that takes periods: it is then estimated as a whole record"
            ),
        }
    }
}
