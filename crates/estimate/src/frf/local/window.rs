//! Window: the lines of all pieces around a frequency, as equations of a local model.

use std::iter::zip;
use std::ops::Range;

use ndarray::Array2;
use num_complex::Complex64;

use crate::frf::local::pieces::{PieceSpectra, Pieces};
use crate::frf::matrices::Matrix;

/// Order of all polynomials: one mode needs a denominator of order two.
pub(super) const ORDER: usize = 2;
/// Coefficients of numerators and transients.
pub(super) const N_TERMS: usize = ORDER + 1;
/// Equations for each unknown of a row, at least: with fewer the residual says little of the errors.
const EQUATIONS_PER_UNKNOWN: f64 = 1.5;

/// Values of one channel on all lines of a window.
pub(crate) type Signal = Vec<Complex64>;

/// The lines around a frequency, piece after piece.
pub(crate) struct Window {
    /// Distance of each line from the frequency over the half width.
    pub(crate) places: Vec<f64>,
    /// The lines of each piece.
    pub(super) pieces: Vec<Range<usize>>,
    /// What drives: the reference, or the inputs in open loop.
    pub(super) drives: Vec<Signal>,
    /// What answers: the outputs, then the inputs where a reference drives.
    pub(super) answers: Vec<Signal>,
    /// How many of them are outputs.
    pub(super) n_outputs: usize,
    /// The inputs, `(channel, line)`.
    pub(super) inputs: Matrix,
}

impl Window {
    /// The lines around a frequency, `half_width` of the longest piece to either side; pieces with hardly more
    /// lines there than their transient has unknowns are left out.
    pub(super) fn around(pieces: &Pieces, hz: f64, half_width: usize) -> Self {
        let half_hz = half_width as f64 * pieces.finest_hz();
        let lines = pieces
            .all
            .iter()
            .map(|piece| (piece, piece.lines(hz, half_hz)));
        let lines: Vec<_> = lines
            .filter(|(_, lines)| lines.len() > N_TERMS + 1)
            .collect();
        let place =
            |(piece, lines): &(&PieceSpectra, Range<usize>)| piece.places(lines, hz, half_hz);
        let of = |signal: fn(&PieceSpectra) -> Option<&Array2<Complex64>>| {
            let parts = lines
                .iter()
                .filter_map(|(piece, lines)| Some((signal(piece)?, lines.clone())));
            joined(&parts.collect::<Vec<_>>())
        };
        let (u, y, r) = (
            of(|piece| Some(&piece.u)),
            of(|piece| Some(&piece.y)),
            of(|piece| piece.r.as_ref()),
        );
        let places = lines.iter().flat_map(place).collect();
        let pieces = ranges(lines.iter().map(|(_, lines)| lines.len()));
        let inputs = Self::of(places, pieces, u, y);
        match r.is_empty() {
            true => inputs,
            false => inputs.through(r),
        }
    }

    /// The same with a reference that drives both outputs and inputs.
    fn through(mut self, reference: Vec<Signal>) -> Self {
        let inputs = std::mem::replace(&mut self.drives, reference);
        self.answers.extend(inputs);
        self
    }

    /// Lines of records in open loop, piece after piece.
    pub(crate) fn of(
        places: Vec<f64>,
        pieces: Vec<Range<usize>>,
        inputs: Vec<Signal>,
        outputs: Vec<Signal>,
    ) -> Self {
        Self {
            places,
            pieces,
            n_outputs: outputs.len(),
            inputs: matrix(&inputs),
            drives: inputs,
            answers: outputs,
        }
    }

    /// Unknowns of a row.
    pub(crate) fn n_unknowns(&self) -> usize {
        ORDER + N_TERMS * (self.drives.len() + self.pieces.len())
    }

    /// Equations beyond the unknowns: complex degrees of freedom.
    pub(super) fn n_free(&self) -> usize {
        self.places.len().saturating_sub(self.n_unknowns())
    }

    /// Whether it has enough equations.
    pub(super) fn is_determined(&self) -> bool {
        let needed = EQUATIONS_PER_UNKNOWN * self.n_unknowns() as f64;
        !self.pieces.is_empty() && self.places.len() as f64 >= needed
    }
}

impl PieceSpectra {
    /// Distances of lines from a frequency over the half width.
    fn places(&self, lines: &Range<usize>, hz: f64, half_hz: f64) -> Vec<f64> {
        let line_hz = |line: usize| (line + 1) as f64 * self.spacing_hz;
        let places = lines.clone().map(|line| (line_hz(line) - hz) / half_hz);
        places.collect()
    }

    /// The places of the lines within `half_hz` of a frequency; at the ends of the band as many that are nearest.
    fn lines(&self, hz: f64, half_hz: f64) -> Range<usize> {
        let half = (half_hz / self.spacing_hz * (1.0 + 1e-9)) as usize;
        let nearest = (hz / self.spacing_hz).round() as usize;
        let most = self.n_lines().saturating_sub(2 * half + 1);
        let first = nearest.saturating_sub(half + 1).min(most);
        first..(first + 2 * half + 1).min(self.n_lines())
    }
}

/// Channel by channel, what the pieces have on their lines, one after the other.
fn joined(parts: &[(&Array2<Complex64>, Range<usize>)]) -> Vec<Signal> {
    let n_channels = parts.first().map_or(0, |(signal, _)| signal.nrows());
    let channel = |channel: usize| {
        let parts = parts.iter().flat_map(|(signal, lines)| {
            let row = signal.row(channel);
            lines.clone().map(move |line| row[line]).collect::<Vec<_>>()
        });
        parts.collect()
    };
    (0..n_channels).map(channel).collect()
}

/// Ranges of these lengths one after the other.
fn ranges(lengths: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    let mut end = 0;
    let next = |length: usize| {
        end += length;
        end - length..end
    };
    lengths.map(next).collect()
}

fn matrix(signals: &[Signal]) -> Matrix {
    let n_lines = signals.first().map_or(0, Vec::len);
    Matrix::from_fn(signals.len(), n_lines, |channel, line| {
        signals[channel][line]
    })
}

/// A signal times a power of the places.
pub(super) fn times_power(signal: &[Complex64], places: &[f64], power: usize) -> Signal {
    let pairs = zip(signal, places);
    pairs
        .map(|(value, place)| value * place.powi(power as i32))
        .collect()
}
