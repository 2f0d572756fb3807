//! Pieces of records as spectra, each on the lines of its own length.

use frfid_signals::{SignalError, checks::positive};
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::frf::local::Piece;
use crate::spectra::Transform;
use crate::spectra::line_dft::{LineDft, check_rising};

/// All pieces, of the same channels.
pub(super) struct Pieces {
    pub(super) all: Vec<PieceSpectra>,
    size: [usize; 2],
}

/// The spectra of one piece, `(channel, line)` with line 1 in front, over the root of its length: noise is alike
/// in pieces of any length.
pub(super) struct PieceSpectra {
    /// Distance of its lines in Hz.
    pub(super) spacing_hz: f64,
    pub(super) u: Array2<Complex64>,
    pub(super) y: Array2<Complex64>,
    pub(super) r: Option<Array2<Complex64>>,
}

impl Pieces {
    /// The spectra of pieces, for frequencies that rise inside their band.
    pub(super) fn of(
        pieces: &[Piece],
        sample_time_s: f64,
        frequency_hz: &[f64],
    ) -> Result<Self, EstimateError> {
        positive("sample_time_s", sample_time_s)?;
        let first = pieces.first().ok_or(EstimateError::EmptyList("pieces"))?;
        let size = [first.y.nrows(), first.u.nrows()];
        check_frequencies(frequency_hz, sample_time_s)?;
        let spectra = |piece: &Piece| {
            piece.check(size, first.r.is_some())?;
            PieceSpectra::of(piece, sample_time_s)
        };
        Ok(Self {
            all: pieces.iter().map(spectra).collect::<Result<_, _>>()?,
            size,
        })
    }

    /// Numbers of outputs and inputs.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Distance of the lines of the longest piece in Hz.
    pub(super) fn finest_hz(&self) -> f64 {
        let spacings = self.all.iter().map(|piece| piece.spacing_hz);
        spacings.fold(f64::INFINITY, f64::min)
    }
}

impl Piece<'_> {
    /// Refuses a piece of other channels than the first, or signals of other lengths.
    fn check(
        &self,
        [outputs, inputs]: [usize; 2],
        has_reference: bool,
    ) -> Result<(), EstimateError> {
        let n_samples = self.u.ncols();
        check_shape("u", self.u, (inputs, n_samples))?;
        check_shape("y", self.y, (outputs, n_samples))?;
        if self.r.is_some() != has_reference {
            let what = "some pieces have a reference, some have none; give it for all or for none";
            return Err(SignalError::unfit("r", what).into());
        }
        self.r
            .map_or(Ok(()), |r| check_shape("r", r, (inputs, n_samples)))
    }
}

fn check_shape(
    name: &'static str,
    signal: ArrayView2<f64>,
    needed: (usize, usize),
) -> Result<(), EstimateError> {
    if signal.dim() == needed && needed.0 > 0 {
        return Ok(());
    }
    let found = signal.dim();
    let what = format!("has shape {found:?}, needed {needed:?}, (channel, sample) as the others");
    Err(SignalError::unfit(name, what).into())
}

/// Refuses frequencies that do not rise from above 0 to below Nyquist.
fn check_frequencies(frequency_hz: &[f64], sample_time_s: f64) -> Result<(), EstimateError> {
    check_rising("frequencies", frequency_hz.iter().copied())?;
    let (first, last) = (frequency_hz.first(), frequency_hz.last());
    let ends = first
        .zip(last)
        .ok_or(EstimateError::EmptyList("frequencies"))?;
    let nyquist_hz = 0.5 / sample_time_s;
    if *ends.0 > 0.0 && *ends.1 < nyquist_hz {
        return Ok(());
    }
    let what = format!(
        "{} to {} Hz, needed above 0 and below {nyquist_hz} Hz",
        ends.0, ends.1
    );
    Err(SignalError::unfit("frequencies", what).into())
}

impl PieceSpectra {
    fn of(piece: &Piece, sample_time_s: f64) -> Result<Self, EstimateError> {
        let n_samples = piece.u.ncols();
        let last = n_samples.saturating_sub(1) / 2;
        let lines: Vec<usize> = (1..=last.max(1)).collect();
        let dft = LineDft::new(n_samples, &lines)?;
        let scale = Complex64::from((n_samples as f64).sqrt().recip());
        let spectra = |name, signal| Ok::<_, EstimateError>(dft.transform(name, signal)? * scale);
        Ok(Self {
            spacing_hz: 1.0 / (n_samples as f64 * sample_time_s),
            u: spectra("u", piece.u)?,
            y: spectra("y", piece.y)?,
            r: piece.r.map(|r| spectra("r", r)).transpose()?,
        })
    }

    /// Number of lines.
    pub(super) fn n_lines(&self) -> usize {
        self.u.ncols()
    }
}
