//! Oddities of a signal and their consequences.

/// Quantisation error is step/sqrt(12), for a step of one rms 29 % of the signal. From there on the
/// signal crosses a step or two only: what is lost is no noise that averages out over the periods
/// but a distortion, the same in each of them, which no spread over the periods sees.
const COARSE: f64 = 1.0;
/// Clipping a share p of a Gaussian signal, both sides together, leaves an error of about 0.5
/// sqrt(p) of its rms: 5 % for this one, far above the noise that is claimed for a usual estimate.
pub const MUCH_CLIPPED: f64 = 0.01;
/// Power of outliers over that of the signal (-20 dB) at which they count: theirs is spread over all
/// lines and the signal's is not, so that some per cent of a line are left of it.
const STRONG: f64 = 0.01;

/// What is odd about one signal of a recording.
#[derive(Debug, Clone, PartialEq)]
pub enum Oddity {
    /// No sample differs from the others by more than rounding.
    Constant {
        /// The value.
        value: f64,
    },
    /// So few values that the steps between them are no small part of the signal.
    FewValues {
        /// Number of values.
        n_values: usize,
        /// Usual distance between neighbouring values, in the signal's unit.
        step: f64,
        /// The same over the rms of the signal about its mean.
        step_over_rms: f64,
    },
    /// Changes at every n-th sample only, and holds its value in between.
    Held {
        /// Samples from one change to the next, 2 or more, the mean where they alternate; the true
        /// rate is that of the grid over this number.
        samples: f64,
        /// Of a whole number n: samples k n + phase, k = 0, 1, ..., are the new ones, 0 <= phase <
        /// n. `None` where the true rate is not a whole part of that of the grid.
        phase: Option<usize>,
    },
    /// Jumps by a turn when it leaves its range, as an angle does; `unwrapped` is the cure.
    Wrapped {
        /// The turn, in the signal's unit.
        turn: f64,
        /// Number of jumps.
        jumps: usize,
    },
    /// Stands at its highest or lowest level for longer than a smooth signal does.
    Saturated {
        /// The lowest level, if it is one.
        low: Option<Level>,
        /// The highest level, if it is one.
        high: Option<Level>,
    },
    /// Single samples, one or two in a row, far away from their neighbours on either side.
    Outliers {
        /// Number of such samples.
        count: usize,
        /// The first one.
        first_sample: usize,
        /// Distance of the farthest from its neighbours over the spread of the signal (half of what
        /// holds the middle 68 % of its samples).
        size_over_spread: f64,
        /// Sum of their squares over that of the signal, with its spread as rms.
        power_over_signal: f64,
    },
    /// Samples that are no numbers.
    Lost {
        /// Their share of all samples.
        share: f64,
    },
}

/// A level at which a signal stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// The level in the signal's unit.
    pub value: f64,
    /// Share of the samples at it.
    pub share: f64,
}

/// Share of the samples at those of the levels that there are.
pub(super) fn share_at(levels: [Option<Level>; 2]) -> f64 {
    levels.iter().flatten().map(|level| level.share).sum()
}

/// What an oddity asks for, rising.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Consequence {
    /// Worth a word.
    Told,
    /// Nothing is lost once the signal is mended.
    Cured,
    /// The FRF may be wrong beyond its stated uncertainty.
    Flagged,
    /// No FRF can be had from this signal.
    Refused,
}

impl Oddity {
    /// What follows for an estimate.
    #[must_use]
    pub fn consequence(&self) -> Consequence {
        match *self {
            Self::Constant { .. } | Self::Lost { share: 1.0 } => Consequence::Refused,
            Self::Wrapped { .. } => Consequence::Cured,
            _ if self.misleads() => Consequence::Flagged,
            _ => Consequence::Told,
        }
    }

    /// Share of the samples at the ends of the signal; 0 unless it is saturated.
    #[must_use]
    pub fn clipped_share(&self) -> f64 {
        match *self {
            Self::Saturated { low, high } => share_at([low, high]),
            _ => 0.0,
        }
    }

    /// Whether it makes an error that no spread over the periods shows.
    fn misleads(&self) -> bool {
        match *self {
            Self::Held { .. } => true,
            Self::FewValues { step_over_rms, .. } => step_over_rms >= COARSE,
            Self::Saturated { .. } => self.clipped_share() >= MUCH_CLIPPED,
            Self::Outliers {
                power_over_signal, ..
            } => power_over_signal >= STRONG,
            Self::Constant { .. } | Self::Wrapped { .. } | Self::Lost { .. } => false,
        }
    }
}
