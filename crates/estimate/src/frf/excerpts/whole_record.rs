//! Bias of the excerpts of a chirp, seen from the whole record, as part of what is uncertain.
//!
//! An excerpt holds what rings on from the frequencies passed before, the less of it the more the
//! plant is damped: the same in every repeat, so that no spread over repeats shows it. The spectra of
//! the whole record know of no excerpts. From them the FRF follows by the local rational method
//! ([`crate::frf::local`]), G_w with covariance C_w, and
//!
//! ```text
//! b = vec(G - G_w),   covariance = noise covariance + b b^H + C_w
//! ```
//!
//! so that the 95 % region about G, whose radius is at least 1.73 times its standard deviation,
//! reaches beyond G_w. Harmonics, which excerpts leave out and the whole record does not, widen it.

use std::ops::Range;

use frfid_signals::checks::positive;
use frfid_signals::{Chirp, Frf, Uncertainty};
use nalgebra::DVector;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::frf::local::fitted::Fitted;
use crate::frf::local::window::{Signal, Window};
use crate::frf::matrices::{Matrix, matrix};
use crate::spectra::Transform;
use crate::spectra::campaign::{Block, Campaign};
use crate::spectra::line_dft::LineDft;

/// Lines of the whole record around a frequency that are fitted. Fewer leave too little beyond the
/// unknowns to average noise, more hold several modes: of 21, 31 and 41 the region of 21 held the truth
/// most often on 2x2 and 3x3 plants and the shortest sweep; 15 was compared on single joints alone.
const N_LINES: usize = 21;
/// Least number of equations for each unknown.
const EQUATIONS_PER_UNKNOWN: usize = 2;

/// The lines of whole recordings of a chirp around the frequencies of its excerpts.
#[derive(Clone)]
pub struct WholeRecord {
    dft: LineDft,
    line_hz: Vec<f64>,
    /// First of the lines around every frequency.
    starts: Vec<usize>,
}

impl WholeRecord {
    /// Plans the lines for recordings of `n_samples` around rising `frequencies_hz`; only lines
    /// that the chirp excites are taken, at the ends of its band those that are nearest.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError`] for a sample time that is not above zero or recordings of
    /// fewer than three samples, [`EstimateError::EmptyList`] without frequencies.
    pub fn new(
        chirp: &Chirp,
        frequencies_hz: &[f64],
        sample_time_s: f64,
        n_samples: usize,
    ) -> Result<Self, EstimateError> {
        positive("sample_time_s", sample_time_s)?;
        let length_s = n_samples as f64 * sample_time_s;
        let highest = n_samples.saturating_sub(1) / 2;
        let last = ((chirp.high_hz * length_s) as usize).clamp(1, highest.max(1));
        let first = ((chirp.low_hz * length_s).ceil() as usize).clamp(1, last);
        let window = |hz: f64| {
            let from = (hz * length_s).round() as usize;
            let from = from.saturating_sub(N_LINES / 2);
            from.min((last + 1).saturating_sub(N_LINES)).max(first)
        };
        let windows: Vec<usize> = frequencies_hz.iter().map(|&hz| window(hz)).collect();
        let mut lines: Vec<usize> = Vec::new();
        for &from in &windows {
            let new = lines.last().map_or(from, |&last| from.max(last + 1));
            lines.extend(new..=(from + N_LINES - 1).min(last));
        }
        let dft = LineDft::new(n_samples, &lines)?;
        Ok(Self {
            starts: windows
                .iter()
                .map(|from| lines.partition_point(|line| line < from))
                .collect(),
            line_hz: dft.frequency_hz(sample_time_s)?,
            dft,
        })
    }

    /// An empty campaign for the spectra of whole recordings.
    ///
    /// # Errors
    /// [`EstimateError::EmptyList`] without frequencies.
    pub fn campaign(&self) -> Result<Campaign, EstimateError> {
        Campaign::new(self.line_hz.clone())
    }

    /// Adds the bias to the covariances of `frf`, the estimate by excerpts of the recordings in
    /// `whole`; where it cannot be told they become NaN. What is `None` remains so.
    ///
    /// # Errors
    /// As [`Campaign::estimate_lines`], for recordings that are missing.
    pub fn add_bias(&self, frf: &mut Frf, whole: &Campaign) -> Result<(), EstimateError> {
        if frf.noise.is_none() && frf.total.is_none() {
            return Ok(());
        }
        let means = Means::of(&whole.realizations()?);
        for (k, &start) in self.starts.iter().enumerate() {
            let window = self.around(frf.frequency_hz[k], start, &means);
            let response = matrix(frf.response.index_axis(Axis(0), k));
            let bias = fit(&window).map(|fit| uncertain(&response, fit));
            for known in [&mut frf.noise, &mut frf.total].into_iter().flatten() {
                add_to(known, k, bias.as_ref());
            }
        }
        Ok(())
    }

    /// The lines around a frequency, of one experiment after the other.
    fn around(&self, hz: f64, start: usize, means: &Means) -> Window {
        let lines = start..(start + N_LINES).min(self.line_hz.len());
        let distances = self.line_hz[lines.clone()].iter().map(|line| line - hz);
        let half = distances.clone().map(f64::abs).fold(0.0, f64::max);
        let (n_lines, n_experiments) = (lines.len(), means.u.len());
        let places: Vec<f64> = distances.map(|distance| distance / half).collect();
        let piece = |experiment: usize| experiment * n_lines..(experiment + 1) * n_lines;
        Window::of(
            places.repeat(n_experiments),
            (0..n_experiments).map(piece).collect(),
            on_lines(&means.u, lines.clone()),
            on_lines(&means.y, lines),
        )
    }
}

/// The fit to a window with enough lines.
fn fit(window: &Window) -> Option<Fitted> {
    let is_enough = window.places.len() >= EQUATIONS_PER_UNKNOWN * window.n_unknowns();
    is_enough.then(|| Fitted::of(window))?
}

/// Channel by channel, what experiments have on lines, one after the other.
fn on_lines(experiments: &[Array2<Complex64>], lines: Range<usize>) -> Vec<Signal> {
    let n_channels = experiments.first().map_or(0, Array2::nrows);
    let of = |channel: usize| {
        let rows = experiments.iter().map(|experiment| experiment.row(channel));
        let values = rows.flat_map(|row| lines.clone().map(|line| row[line]).collect::<Vec<_>>());
        values.collect()
    };
    (0..n_channels).map(of).collect()
}

impl Transform for WholeRecord {
    fn transform(
        &self,
        name: &'static str,
        signal: ArrayView2<f64>,
    ) -> Result<Array2<Complex64>, EstimateError> {
        self.dft.transform(name, signal)
    }
}

/// Means over the repeats of every experiment, `(channel, line)`; the experiments of several
/// realizations one after the other.
struct Means {
    u: Vec<Array2<Complex64>>,
    y: Vec<Array2<Complex64>>,
}

impl Means {
    fn of(realizations: &[Vec<Block>]) -> Self {
        let (mut u, mut y) = (Vec::new(), Vec::new());
        for repeats in realizations {
            for experiment in 0..repeats.first().map_or(0, Vec::len) {
                let runs = || repeats.iter().map(|block| block[experiment]);
                u.extend(mean_of(runs().map(|run| &run.u)));
                y.extend(mean_of(runs().map(|run| &run.y)));
            }
        }
        Self { u, y }
    }
}

/// Mean of spectra of one shape.
fn mean_of<'a>(
    spectra: impl ExactSizeIterator<Item = &'a Array2<Complex64>>,
) -> Option<Array2<Complex64>> {
    let count = spectra.len() as f64;
    let sum = spectra.cloned().reduce(|sum, spectrum| sum + spectrum)?;
    Some(sum / Complex64::from(count))
}

/// `b b^H + C_w` of the formula at the head of this file.
fn uncertain(response: &Matrix, fit: Fitted) -> Matrix {
    let bias = DVector::from_column_slice((response - &fit.response).as_slice());
    &bias * bias.adjoint() + fit.covariance
}

/// The entries of a matrix with their places.
fn indexed(matrix: &Matrix) -> impl Iterator<Item = ((usize, usize), Complex64)> {
    let (n_rows, entries) = (matrix.nrows(), matrix.iter().enumerate());
    entries.map(move |(k, &value)| ((k % n_rows, k / n_rows), value))
}

/// Adds to the covariance at one frequency; unknown where there is nothing to add.
fn add_to(known: &mut Uncertainty, frequency: usize, bias: Option<&Matrix>) {
    let mut covariance: ArrayViewMut2<Complex64> =
        known.covariance.index_axis_mut(Axis(0), frequency);
    match bias {
        None => covariance.fill(Complex64::new(f64::NAN, f64::NAN)),
        Some(bias) => indexed(bias).for_each(|((i, j), value)| covariance[[i, j]] += value),
    }
}
