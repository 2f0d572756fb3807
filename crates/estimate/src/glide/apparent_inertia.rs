//! Apparent inertia of a plant: its inverse FRF as an inertia over frequency.
//!
//! `P^-1 = 2 pi i f M(f)`: M is interpolated between the frequencies of P and held beyond them, where
//! it tends to that of the rigid machine.

use std::f64::consts::{PI, TAU};

use frfid_signals::Frf;
use frfid_signals::checks::{positive, require_shape};
use nalgebra::DMatrix;
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::frf::between::between;
use crate::frf::matrices::{Matrix, matrix};
use crate::frf::right_division::right_divide;
use crate::spectra::line_dft::check_rising;

/// Frequencies on either side over which the median of the apparent inertia is taken.
const NEIGHBOURS: usize = 4;

/// `M(f) = P^-1 / (2 pi i f)` on the frequencies of an FRF.
pub(super) struct ApparentInertia<'a> {
    frequency_hz: &'a [f64],
    inertia: Vec<Matrix>,
}

impl<'a> ApparentInertia<'a> {
    pub(super) fn of(plant: &'a Frf, n_axes: usize) -> Result<Self, EstimateError> {
        plant.check()?;
        check_rising(
            "frequencies of the plant",
            plant.frequency_hz.iter().copied(),
        )?;
        let fits = (plant.n_outputs(), plant.n_inputs()) == (n_axes, n_axes);
        let needed =
            format_args!("(frequency, {n_axes}, {n_axes}), torque to velocity of the glide's axes");
        require_shape(
            "response of the plant",
            plant.response.shape(),
            fits,
            needed,
        )?;
        let lines = plant.frequency_hz.iter().zip(plant.response.outer_iter());
        let inertia = lines.map(|(&hz, response)| inertia_at(hz, &matrix(response)));
        let inertia = inertia.collect::<Result<Vec<_>, _>>()?;
        Ok(Self {
            frequency_hz: &plant.frequency_hz,
            inertia: medians(&inertia),
        })
    }

    /// 1 up to four fifths of the highest frequency, then a half cosine down to 0 there: the ends
    /// of a band ring less.
    pub(super) fn weight(&self, hz: f64) -> f64 {
        let highest_hz = self.frequency_hz.last().copied().unwrap_or(0.0);
        let place = ((highest_hz - hz) / (0.2 * highest_hz)).clamp(0.0, 1.0);
        0.5 - 0.5 * (PI * place).cos()
    }

    /// Torque in N m of accelerations in rad/s^2 at a frequency.
    pub(super) fn torque(&self, hz: f64, acceleration: &[Complex64]) -> Vec<Complex64> {
        let (below, above, share) = between(self.frequency_hz, hz);
        let (low, high) = (&self.inertia[below], &self.inertia[above]);
        let entry = |row: usize, column: usize| {
            low[(row, column)] * (1.0 - share) + high[(row, column)] * share
        };
        let n = acceleration.len();
        let torque = |row: usize| {
            (0..n)
                .map(|column| entry(row, column) * acceleration[column])
                .sum()
        };
        (0..n).map(torque).collect()
    }
}

/// `P^-1 / (2 pi i f)` of the response P at one frequency.
fn inertia_at(frequency_hz: f64, response: &Matrix) -> Result<Matrix, EstimateError> {
    positive("frequencies of the plant", frequency_hz)?;
    let n_axes = response.nrows();
    let inverse = right_divide(&DMatrix::identity(n_axes, n_axes), response);
    if inverse.iter().all(|value| value.is_finite()) {
        Ok(inverse / Complex64::new(0.0, TAU * frequency_hz))
    } else {
        Err(EstimateError::SingularPlant { frequency_hz })
    }
}

/// Entry by entry, real and imaginary part, the median over each frequency and its neighbours on
/// either side: M is smooth, but a first estimate is far off on the few frequencies that the ripple
/// itself hits.
fn medians(inertia: &[Matrix]) -> Vec<Matrix> {
    let lines = 0..inertia.len();
    let around =
        |line: usize| line.saturating_sub(NEIGHBOURS)..(line + NEIGHBOURS + 1).min(inertia.len());
    lines.map(|line| median(&inertia[around(line)])).collect()
}

/// Entry by entry the median of matrices, real and imaginary part.
fn median(matrices: &[Matrix]) -> Matrix {
    let (n_rows, n_columns) = matrices[0].shape();
    DMatrix::from_fn(n_rows, n_columns, |row, column| {
        let entries = matrices.iter().map(|matrix| matrix[(row, column)]);
        let (real, imaginary) = entries.map(|entry| (entry.re, entry.im)).unzip();
        Complex64::new(middle(real), middle(imaginary))
    })
}

/// The median of values, the mean of both middle ones.
fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
}
