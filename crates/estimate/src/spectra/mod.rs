//! Spectra of time series, and the transform that makes them for each excitation.

pub(crate) mod campaign;
mod delay;
mod draw_glance;
mod draw_match;
pub(crate) mod draws;
mod dwells;
pub(crate) mod equal_draws;
pub(crate) mod excerpt;
mod excerpt_weights;
pub(crate) mod harmonic_fit;
pub(crate) mod line_dft;
pub(crate) mod run_spectra;
pub(crate) mod spread;
pub(crate) mod time_series;
pub(crate) mod whole_record;

use std::iter::zip;

use frfid_signals::checks::require_shape;
use frfid_signals::{Chirp, Excitation, Multisine, Plan, SignalError, log_spaced};
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::campaign::Campaign;
use crate::spectra::dwells::Dwells;
use crate::spectra::excerpt::{ExcerptOptions, Excerpts};
use crate::spectra::line_dft::LineDft;
use crate::spectra::whole_record::WholeRecord;

/// Lines of a whole chirp are taken so far beyond its band: what is excited there says something, too.
const BEYOND: f64 = 1.2;

/// What turns time series into spectra.
pub trait Transform: Send + Sync {
    /// Spectra of one run, `(channel, sample)` to `(channel, line)`, means removed.
    ///
    /// # Errors
    /// [`SignalError::Shape`](frfid_signals::SignalError::Shape) for another length,
    /// [`SignalError::NotFinite`](frfid_signals::SignalError::NotFinite); both say `name`.
    fn transform(
        &self,
        name: &'static str,
        signal: ArrayView2<f64>,
    ) -> Result<Array2<Complex64>, EstimateError>;
}

/// Refuses a signal of another length than the transform was planned for.
fn check_length(
    name: &'static str,
    signal: ArrayView2<f64>,
    n_samples: usize,
) -> Result<(), SignalError> {
    let fits = signal.ncols() == n_samples;
    let needed = format_args!("(channel, {n_samples})");
    require_shape(name, signal.shape(), fits, needed)
}

/// Spectra of which every line comes from a piece of the signal.
fn spectra_of_pieces<P>(
    signal: ArrayView2<f64>,
    pieces: &[P],
    value_of: impl Fn(&P, &[f64]) -> Complex64,
) -> Array2<Complex64> {
    let mut spectra = Array2::zeros((signal.nrows(), pieces.len()));
    for (channel, spectrum) in zip(signal.rows(), spectra.rows_mut()) {
        let samples = channel.to_vec();
        zip(spectrum, pieces).for_each(|(value, piece)| *value = value_of(piece, &samples));
    }
    spectra
}

/// Mean of at least one sample.
pub(crate) fn mean(samples: &[f64]) -> f64 {
    samples.iter().sum::<f64>() / samples.len() as f64
}

/// Where in frequency the periods of a plan are evaluated, and how.
pub struct Evaluation {
    /// Frequencies of the spectra in Hz, rising.
    pub frequency_hz: Vec<f64>,
    /// Frequencies of the FRF, where they are others.
    at_hz: Option<Vec<f64>>,
    /// From a period to spectra at these frequencies.
    pub transform: Box<dyn Transform>,
    /// Relative distance below which resonances cannot be told apart, where that is a property of
    /// the transform and not of the frequencies.
    pub relative_resolution: Option<f64>,
}

impl Evaluation {
    /// The DFT of a multisine on its excited lines; a chirp at `n_frequencies`, logarithmically spaced over its band,
    /// from excerpts; the DFT of each dwell of a stepped sine.
    ///
    /// # Errors
    /// [`EstimateError`] for an excitation that cannot be evaluated.
    pub fn of(plan: &Plan, n_frequencies: usize) -> Result<Self, EstimateError> {
        let (n_samples, sample_time_s) = (plan.period_samples()?, plan.sample_time_s);
        match &plan.excitation {
            Excitation::Multisine(Multisine { grid, .. }) => {
                let dft = LineDft::new(n_samples, &grid.excited)?;
                Ok(Self::on_frequencies(dft.frequency_hz(sample_time_s)?, dft))
            }
            Excitation::Chirp(chirp) => {
                let hz = log_spaced(chirp.low_hz, chirp.high_hz, n_frequencies)?;
                Self::by_excerpts(chirp, hz, sample_time_s, n_samples)
            }
            Excitation::SteppedSine(stepped) => {
                let dwells = Dwells::new(stepped, sample_time_s, n_samples)?;
                Ok(Self::on_frequencies(dwells.frequency_hz(), dwells))
            }
        }
    }

    /// Excerpts of a chirp that begins with the period.
    fn by_excerpts(
        chirp: &Chirp,
        hz: Vec<f64>,
        sample_time_s: f64,
        n_samples: usize,
    ) -> Result<Self, EstimateError> {
        let cut = ExcerptOptions::default();
        let excerpts = Excerpts::new(chirp, &hz, sample_time_s, 0.0, n_samples, &cut)?;
        Ok(Self {
            relative_resolution: Some(cut.relative_resolution(chirp)),
            ..Self::on_frequencies(hz, excerpts)
        })
    }

    /// The same for local models, which look at all lines around a frequency: a chirp by its whole record.
    ///
    /// # Errors
    /// As [`Evaluation::of`], and of a stepped sine.
    pub fn of_whole_records(plan: &Plan, n_frequencies: usize) -> Result<Self, EstimateError> {
        match &plan.excitation {
            Excitation::Multisine(_) => Self::of(plan, n_frequencies),
            Excitation::SteppedSine(_) => Err(no_lines_between()),
            Excitation::Chirp(chirp) => {
                let hz = log_spaced(chirp.low_hz, chirp.high_hz, n_frequencies)?;
                let n_samples = plan.period_samples()?;
                Self::by_whole_record(chirp, hz, plan.sample_time_s, n_samples)
            }
        }
    }

    /// Whole records of a chirp.
    pub(crate) fn by_whole_record(
        chirp: &Chirp,
        hz: Vec<f64>,
        sample_time_s: f64,
        n_samples: usize,
    ) -> Result<Self, EstimateError> {
        let band_hz = [chirp.low_hz / BEYOND, chirp.high_hz * BEYOND];
        let whole = WholeRecord::new(band_hz, sample_time_s, n_samples)?;
        Ok(Self {
            at_hz: Some(hz),
            ..Self::on_frequencies(whole.frequency_hz().to_vec(), whole)
        })
    }

    /// An empty campaign for the spectra.
    ///
    /// # Errors
    /// None of an evaluation that was planned.
    pub fn campaign(&self) -> Result<Campaign, EstimateError> {
        let campaign = Campaign::new(self.frequency_hz.clone())?;
        match &self.at_hz {
            Some(hz) => campaign.evaluated_at(hz.clone()),
            None => Ok(campaign),
        }
    }

    /// Evaluation that resolves whatever the frequencies do.
    fn on_frequencies(frequency_hz: Vec<f64>, transform: impl Transform + 'static) -> Self {
        Self {
            frequency_hz,
            at_hz: None,
            transform: Box::new(transform),
            relative_resolution: None,
        }
    }
}

/// Why a stepped sine has no local models.
fn no_lines_between() -> EstimateError {
    let what = "a stepped sine has no lines between its frequencies, local models need them: choose another method";
    SignalError::unfit("method", what).into()
}
