//! Window: the lines of all pieces around a frequency, as equations of a local model.

use std::iter::zip;
use std::ops::Range;

use ndarray::Array2;
use num_complex::Complex64;

use crate::frf::local::LocalModel;
use crate::frf::local::column::Column;
use crate::frf::local::pieces::{PieceSpectra, Pieces};
use crate::frf::local::repeats::{Repeats, Scatter};
use crate::frf::matrices::Matrix;
use crate::frf::singular::condition_of_finite;

/// Order of numerators and transients.
const ORDER: usize = 2;
/// Coefficients of numerators and transients.
pub(super) const N_TERMS: usize = ORDER + 1;
/// Equations for each unknown of a row, at least: with fewer the residual says little of the errors.
const EQUATIONS_PER_UNKNOWN: f64 = 1.5;

/// The lines around a frequency, piece after piece.
pub(crate) struct Window {
    /// Distance of each line from the frequency over the half width.
    pub(crate) places: Vec<f64>,
    /// For every piece 1 on its lines and 0 on the others: what its transient is a multiple of.
    pub(super) transients: Vec<Column>,
    /// What drives: the reference, or the inputs in open loop.
    pub(super) drives: Vec<Column>,
    /// What answers: the outputs, then the inputs where a reference drives.
    pub(super) answers: Vec<Column>,
    /// How many of them are outputs.
    pub(super) n_outputs: usize,
    /// Order of the denominator.
    pub(super) n_poles: usize,
    /// Largest distance of a line from the frequency.
    pub(super) half_hz: f64,
    /// Noise as repeats show it.
    pub(super) scatter: Option<Scatter>,
}

impl Window {
    /// The lines around a frequency, `half_width` of the piece with the finest to either side; pieces with hardly
    /// more lines there than their transient has unknowns are left out.
    pub(super) fn around(pieces: &Pieces, hz: f64, half_width: usize, model: LocalModel) -> Self {
        let half_hz = half_width as f64 * pieces.finest_hz();
        let parts = pieces.all.iter().map(|piece| Part::of(piece, hz, half_hz));
        let parts: Vec<Part> = parts
            .filter(|part| part.lines.len() > N_TERMS + 1)
            .collect();
        let distances = parts.iter().flat_map(Part::line_hz).map(|line| line - hz);
        let distances: Vec<f64> = distances.collect();
        let scale = distances.iter().copied().map(f64::abs).fold(0.0, f64::max);
        let inputs = Self {
            scatter: Repeats::scatter(parts.iter().map(Part::repeats)),
            half_hz: scale,
            ..Self::of(
                distances.iter().map(|distance| distance / scale).collect(),
                ranges(parts.iter().map(|part| part.lines.len())),
                joined(&parts, |piece| Some(&piece.mean.u)),
                joined(&parts, |piece| Some(&piece.mean.y)),
                model,
            )
        };
        match joined(&parts, |piece| piece.mean.r.as_ref()) {
            r if r.is_empty() => inputs,
            r => inputs.through(r),
        }
    }

    /// The same with a reference that drives both outputs and inputs.
    fn through(mut self, reference: Vec<Column>) -> Self {
        let inputs = std::mem::replace(&mut self.drives, reference);
        self.answers.extend(inputs);
        self
    }

    /// Lines of records in open loop, piece after piece.
    pub(crate) fn of(
        places: Vec<f64>,
        pieces: Vec<Range<usize>>,
        inputs: Vec<Column>,
        outputs: Vec<Column>,
        model: LocalModel,
    ) -> Self {
        Self {
            half_hz: 1.0,
            n_poles: model.n_poles(),
            scatter: None,
            transients: pieces
                .iter()
                .map(|piece| ones(piece, places.len()))
                .collect(),
            places,
            n_outputs: outputs.len(),
            drives: inputs,
            answers: outputs,
        }
    }

    /// The inputs, which answer where a reference drives.
    pub(super) fn inputs(&self) -> &[Column] {
        match &self.answers[self.n_outputs..] {
            [] => &self.drives,
            inputs => inputs,
        }
    }

    /// What stands in the equations of all answers: drives, then transients.
    pub(super) fn signals(&self) -> impl Iterator<Item = &Column> {
        self.drives.iter().chain(&self.transients)
    }

    /// Unknowns of a row.
    pub(crate) fn n_unknowns(&self) -> usize {
        self.n_poles + N_TERMS * (self.drives.len() + self.transients.len())
    }

    /// Equations beyond the unknowns: complex degrees of freedom.
    pub(crate) fn n_free(&self) -> usize {
        self.places.len().saturating_sub(self.n_unknowns())
    }

    /// Condition number of the inputs, each scaled to the same size, from their Gram matrix.
    pub(crate) fn condition(&self) -> f64 {
        let inputs = self.inputs();
        if let [input] = inputs {
            return if input.is_zero() { f64::INFINITY } else { 1.0 };
        }
        let size = |column: &Column| column.norm_squared().max(f64::MIN_POSITIVE).sqrt();
        let gram = Matrix::from_fn(inputs.len(), inputs.len(), |i, j| {
            inputs[i].dot(&inputs[j]) / (size(&inputs[i]) * size(&inputs[j]))
        });
        condition_of_finite(&gram).sqrt()
    }

    /// Whether it has enough equations.
    pub(super) fn is_determined(&self) -> bool {
        self.has_equations(EQUATIONS_PER_UNKNOWN)
    }

    /// Whether it has so many equations for each unknown.
    pub(crate) fn has_equations(&self, per_unknown: f64) -> bool {
        let needed = per_unknown * self.n_unknowns() as f64;
        !self.transients.is_empty() && self.places.len() as f64 >= needed
    }
}

/// The lines of one piece in a window.
struct Part<'p> {
    piece: &'p PieceSpectra,
    lines: Range<usize>,
}

impl<'p> Part<'p> {
    /// As many lines as fit within `half_hz` to either side of a frequency, those that are nearest.
    fn of(piece: &'p PieceSpectra, hz: f64, half_hz: f64) -> Self {
        let half = (half_hz / piece.spacing_hz() * (1.0 + 1e-9)) as usize;
        let half = half.min(piece.n_lines()); // a width may be any number
        let above = piece.line_hz.partition_point(|line| *line < hz);
        let is_nearer_below = above > 0
            && (above == piece.n_lines()
                || hz - piece.line_hz[above - 1] < piece.line_hz[above] - hz);
        let nearest = above - usize::from(is_nearer_below);
        let most = piece.n_lines().saturating_sub(2 * half + 1);
        let first = nearest.saturating_sub(half).min(most);
        let lines = first..(first + 2 * half + 1).min(piece.n_lines());
        Self { piece, lines }
    }

    fn line_hz(&self) -> impl Iterator<Item = f64> {
        self.piece.line_hz[self.lines.clone()].iter().copied()
    }

    fn repeats(&self) -> (Option<&'p Repeats>, Range<usize>) {
        (self.piece.repeats.as_ref(), self.lines.clone())
    }
}

/// Channel by channel, what a signal of the pieces is on their lines, one after the other; empty where they have
/// none.
fn joined<'p>(
    parts: &[Part<'p>],
    signal: impl Fn(&'p PieceSpectra) -> Option<&'p Array2<Complex64>>,
) -> Vec<Column> {
    let signals = parts.iter().map(|part| signal(part.piece));
    let Some(signals) = signals.collect::<Option<Vec<_>>>() else {
        return Vec::new();
    };
    let n_lines = parts.iter().map(|part| part.lines.len()).sum();
    let channel = |channel: usize| {
        let values = zip(parts, &signals).flat_map(|(part, signal)| {
            let lines = part.lines.clone();
            lines.map(move |line| signal[[channel, line]])
        });
        Column::of(n_lines, values)
    };
    let n_channels = signals.first().map_or(0, |signal| signal.nrows());
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

/// 1 on the lines of a piece, of so many.
fn ones(piece: &Range<usize>, n_lines: usize) -> Column {
    let is_of = |line: usize| Complex64::from(f64::from(u8::from(piece.contains(&line))));
    Column::of(n_lines, (0..n_lines).map(is_of))
}
