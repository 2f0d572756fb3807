//! Reasons why a periodic signal has no set of excited lines.

use std::fmt;

/// Why no lines stand out.
#[derive(Debug, Clone, PartialEq)]
pub enum Unlined {
    /// No channel moves.
    Silent,
    /// Nothing is above the noise, known from how periods differ.
    Noise,
    /// The amplitudes fall from line to line and do not end: a square, a trapezoid, a triangle.
    Endless {
        /// How far they fall, as a ratio of amplitudes.
        range: f64,
    },
}

impl Unlined {
    /// The reason of two that says more.
    pub(crate) fn or(self, other: Self) -> Self {
        match (&self, &other) {
            (Self::Endless { .. }, _) | (_, Self::Silent) => self,
            _ => other,
        }
    }
}

impl fmt::Display for Unlined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Silent => write!(f, "no channel moves"),
            Self::Noise => write!(
                f,
                "no amplitude is 13 dB above the noise, by which periods differ"
            ),
            Self::Endless { range } => write!(
                f,
                "the amplitudes fall by a factor {range:.1e} from line to line and do not end, as those of \
                 a square, a trapezoid or a triangle do"
            ),
        }
    }
}
