//! Marks that point out places of Bode diagrams.

use crate::figure::ink::{Ink, Marker};

/// The shape of a [`Mark`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkShape {
    /// An open circle.
    Circle,
    /// A cross.
    Cross,
}

/// A point of a matrix of Bode diagrams that is pointed out, in the colour of a curve: a peak, or
/// where another entry has its.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Name in the legend; marks of one name share one entry, an empty name has none.
    pub label: String,
    /// Number of the curve it belongs to.
    pub curve: usize,
    /// Row of the matrix.
    pub output: usize,
    /// Column of the matrix.
    pub input: usize,
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Magnitude in dB.
    pub magnitude_db: f64,
    /// How it is drawn.
    pub shape: MarkShape,
}

impl Mark {
    /// Its output and input.
    pub(crate) fn entry(&self) -> (usize, usize) {
        (self.output, self.input)
    }

    /// Its frequency in Hz and magnitude in dB.
    pub(crate) fn place(&self) -> (f64, f64) {
        (self.frequency_hz, self.magnitude_db)
    }

    /// Its ink, in a figure with curves of these inks.
    pub(crate) fn ink(&self, curves: &[Ink]) -> Ink {
        let marker = match self.shape {
            MarkShape::Circle => Marker::Circle,
            MarkShape::Cross => Marker::Cross,
        };
        Ink::markers(marker, curves[self.curve].color)
    }
}
