//! FRF with what its lines scatter: its total covariance, or else that of the noise with the
//! scatter from line to line that the noise leaves unexplained.

use frfid_signals::{Frf, Uncertainty};
use ndarray::{Array2, Array3};
use num_complex::Complex64;
use serde::Serialize;

use crate::frf::roughness::{Roughness, entry_roughness};

/// Covariance by which two FRFs are judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spread {
    /// Measurement noise and nonlinear distortion.
    Total,
    /// Measurement noise alone; with the scatter from line to line, where that exceeds the noise.
    Noise,
}

/// An FRF and the variances of its entries.
pub(crate) struct Measured<'a> {
    pub(crate) frf: &'a Frf,
    pub(crate) known: Option<(&'a Uncertainty, Spread)>,
    /// Variance of every entry, `(frequency, output, input)`, scatter included.
    variance: Option<Array3<f64>>,
    /// Squared scatter relative to the response of each entry beyond its noise, 0 for none.
    rough: Array2<f64>,
}

/// One line of an entry.
pub(crate) struct Line {
    pub(crate) hz: f64,
    pub(crate) response: Complex64,
    pub(crate) variance: Option<f64>,
}

impl<'a> Measured<'a> {
    pub(crate) fn of(frf: &'a Frf) -> Self {
        let total = frf.total.as_ref().map(|total| (total, Spread::Total));
        let noise = || frf.noise.as_ref().map(|noise| (noise, Spread::Noise));
        let known = total
            .or_else(noise)
            .filter(|(known, _)| known.degrees_of_freedom > 0.0);
        let mut variance = match known {
            Some((_, Spread::Total)) => frf.total_variance(),
            Some((_, Spread::Noise)) => frf.noise_variance(),
            None => None,
        };
        let rough = match (known, &variance) {
            (Some((_, Spread::Noise)), Some(variance)) => roughness_of(frf, variance),
            _ => Array2::zeros((frf.n_outputs(), frf.n_inputs())),
        };
        if let Some(variance) = &mut variance {
            for ((k, output, input), value) in variance.indexed_iter_mut() {
                *value += rough[[output, input]] * frf.response[[k, output, input]].norm_sqr();
            }
        }
        Self {
            frf,
            known,
            variance,
            rough,
        }
    }

    /// Complex degrees of freedom of the variances; `None` without any.
    pub(crate) fn degrees_of_freedom(&self) -> Option<f64> {
        self.known.map(|(known, _)| known.degrees_of_freedom)
    }

    /// Whether its values are blurred over frequency.
    pub(crate) fn is_blurred(&self) -> bool {
        self.frf
            .relative_resolution
            .is_some_and(|width| width > 0.0)
    }

    /// The lines of an entry.
    pub(crate) fn lines(&self, output: usize, input: usize) -> impl Iterator<Item = Line> {
        self.frf
            .frequency_hz
            .iter()
            .enumerate()
            .map(move |(k, &hz)| Line {
                hz,
                response: self.frf.response[[k, output, input]],
                variance: self
                    .variance
                    .as_ref()
                    .map(|variance| variance[[k, output, input]]),
            })
    }

    /// Variance of an entry at a line; NaN where it was not measured.
    pub(crate) fn variance_at(&self, k: usize, (output, input): (usize, usize)) -> f64 {
        let value = |variance: &Array3<f64>| variance[[k, output, input]];
        self.variance.as_ref().map_or(f64::NAN, value)
    }

    /// Squared relative scatter of an entry that is no noise.
    pub(crate) fn rough(&self, entry: (usize, usize)) -> f64 {
        self.rough[entry]
    }
}

/// Squared relative scatter of every entry that its noise does not explain.
fn roughness_of(frf: &Frf, variance: &Array3<f64>) -> Array2<f64> {
    let is_blurred = frf.relative_resolution.is_some();
    Array2::from_shape_fn((frf.n_outputs(), frf.n_inputs()), |entry| {
        let found = entry_roughness(frf, variance, entry);
        let rough = found.filter(|found| !is_blurred && found.exceeds_noise());
        rough.map_or(0.0, |Roughness { relative, .. }| relative * relative)
    })
}
