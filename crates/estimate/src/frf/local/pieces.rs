//! Pieces of records as spectra, each on lines of its own.

use frfid_signals::{SignalError, checks::positive};
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::frf::local::Piece;
use crate::frf::local::repeats::{Repeats, mean_of};
use crate::spectra::Transform;
use crate::spectra::campaign::Campaign;
use crate::spectra::line_dft::{LineDft, check_rising};
use crate::spectra::run_spectra::RunSpectra;

/// All pieces, of the same channels.
pub(super) struct Pieces {
    pub(super) all: Vec<PieceSpectra>,
    size: [usize; 2],
}

/// The spectra of one piece, `(channel, line)`.
pub(super) struct PieceSpectra {
    /// Its lines, rising.
    pub(super) line_hz: Vec<f64>,
    pub(super) mean: RunSpectra,
    /// How the records differ of which it is the mean; `None` of one record.
    pub(super) repeats: Option<Repeats>,
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

    /// A piece for every realization and experiment of a campaign, the mean of its periods.
    pub(super) fn of_campaign(campaign: &Campaign) -> Result<Self, EstimateError> {
        let experiments = campaign.by_experiment();
        let first = experiments.first().and_then(|periods| periods.first());
        let first = first.ok_or(EstimateError::EmptyList("runs"))?;
        let piece = |periods: &Vec<&RunSpectra>| PieceSpectra {
            line_hz: campaign.frequency_hz().to_vec(),
            mean: mean_of(periods),
            repeats: Repeats::of_runs(periods, &campaign.glides),
        };
        Ok(Self {
            size: [first.y.nrows(), first.u.nrows()],
            all: experiments.iter().map(piece).collect(),
        })
    }

    /// Numbers of outputs and inputs.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Distance of the lines of the longest piece in Hz.
    pub(super) fn finest_hz(&self) -> f64 {
        let spacings = self.all.iter().map(PieceSpectra::spacing_hz);
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
    /// The spectra on all lines over the root of the length: noise is alike in pieces of any length.
    fn of(piece: &Piece, sample_time_s: f64) -> Result<Self, EstimateError> {
        let n_samples = piece.u.ncols();
        let last = n_samples.saturating_sub(1) / 2;
        let lines: Vec<usize> = (1..=last.max(1)).collect();
        let dft = LineDft::new(n_samples, &lines)?;
        let scale = Complex64::from((n_samples as f64).sqrt().recip());
        let spectra = |name, signal| -> Result<Array2<Complex64>, EstimateError> {
            Ok(dft.transform(name, signal)? * scale)
        };
        Ok(Self {
            line_hz: dft.frequency_hz(sample_time_s)?,
            mean: RunSpectra {
                u: spectra("u", piece.u)?,
                y: spectra("y", piece.y)?,
                r: piece.r.map(|r| spectra("r", r)).transpose()?,
            },
            repeats: None,
        })
    }

    /// Number of lines.
    pub(super) fn n_lines(&self) -> usize {
        self.line_hz.len()
    }

    /// Distance of its lines in Hz, their mean.
    pub(super) fn spacing_hz(&self) -> f64 {
        match self.line_hz[..] {
            [first, .., last] => (last - first) / (self.n_lines() - 1) as f64,
            [only] => only,
            [] => f64::NAN,
        }
    }
}
