//! Frequency response matrix with its uncertainty: what every estimator returns.

use std::iter::zip;

use ndarray::{Array2, Array3, ArrayView2, Axis};
use num_complex::Complex64;

use crate::error::SignalError;
use crate::number::checks::{not_negative, of_axes, require, require_shape};

/// How well the entries of an FRF are known: variances *of the averaged FRF*, with the degrees of
/// freedom behind them.
///
/// The covariance is that of vec(G), the columns of G stacked: row and column
/// `input * n_outputs + output`, so that its diagonal holds the variances. E|dG|^2 is meant: real
/// and imaginary part together.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Covariance of vec(G), `(frequency, n_outputs n_inputs, n_outputs n_inputs)`, squared units
    /// of G.
    pub covariance: Array3<Complex64>,
    /// Complex degrees of freedom of the estimate, real where parts of unequal size make it up:
    /// n_p (n_q - 1) for noise alike in all realizations, n_p - 1 for the total.
    pub degrees_of_freedom: f64,
}

/// A frequency response matrix, `(frequency, output, input)`, with what is known about its
/// uncertainty.
///
/// A variance that was not measured is `None`, never zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Frf {
    /// Frequencies in Hz, rising.
    pub frequency_hz: Vec<f64>,
    /// Response, `(frequency, output, input)`; rad/s per N m for motor torque to motor velocity.
    pub response: Array3<Complex64>,
    /// Measurement noise of the averaged FRF; `None` with one period. For excerpts of a chirp with the
    /// bias of the method, NaN where that is unknown.
    pub noise: Option<Uncertainty>,
    /// Measurement noise and nonlinear distortion of the averaged FRF; `None` with one realization.
    pub total: Option<Uncertainty>,
    /// 2-norm condition number of U per frequency; `None` where no U was inverted (an analytic
    /// FRF).
    pub condition: Option<Vec<f64>>,
    /// Half width, relative to the frequency, of the band over which a value blurs the response: for
    /// excerpts of a chirp that in the middle of its band, 1/(2n) with n periods each, or more where
    /// the sweep is fast. `None` for lines of a period, which blur nothing.
    pub relative_resolution: Option<f64>,
}

impl Frf {
    /// An FRF without uncertainty: an analytic one, or one that was measured once.
    ///
    /// # Errors
    /// [`SignalError::Shape`] if the response has not one matrix per frequency.
    pub fn new(frequency_hz: Vec<f64>, response: Array3<Complex64>) -> Result<Self, SignalError> {
        let frf = Self {
            frequency_hz,
            response,
            noise: None,
            total: None,
            condition: None,
            relative_resolution: None,
        };
        frf.check()?;
        Ok(frf)
    }

    /// Checks that every array has one entry per frequency, covariances the size of vec(G), degrees
    /// of freedom that are a number, frequencies of 0 or more that rise, and condition numbers of 1 or
    /// more.
    ///
    /// # Errors
    /// [`SignalError::Shape`], [`SignalError::Parameter`].
    pub fn check(&self) -> Result<(), SignalError> {
        let (lines, entries) = (self.frequency_hz.len(), self.n_outputs() * self.n_inputs());
        let fits = self.response.len_of(Axis(0)) == lines && entries > 0;
        let needed = format_args!("({lines}, outputs, inputs), one matrix per frequency");
        require_shape("response", self.response.shape(), fits, needed)?;
        self.check_frequencies()?;
        self.check_covariance("noise covariance", self.noise.as_ref())?;
        self.check_covariance("total covariance", self.total.as_ref())?;
        if let Some(condition) = &self.condition {
            of_axes("condition", condition, lines)?;
            check_condition(condition)?;
        }
        self.relative_resolution
            .map_or(Ok(()), |width| not_negative("relative_resolution", width))
    }

    /// Checks that the frequencies are numbers from 0 on and rise.
    fn check_frequencies(&self) -> Result<(), SignalError> {
        let mut last = None;
        for (line, &hz) in self.frequency_hz.iter().enumerate() {
            if !(hz.is_finite() && hz >= 0.0 && Some(hz) > last) {
                let what = format!(
                    "line {line} is at {hz} Hz; needed: 0 or more, rising from line to line"
                );
                return Err(SignalError::unfit("frequency_hz", what));
            }
            last = Some(hz);
        }
        Ok(())
    }

    /// Checks that a covariance, where there is one, has the size of vec(G) at every frequency, and no variance below 0.
    fn check_covariance(
        &self,
        name: &'static str,
        known: Option<&Uncertainty>,
    ) -> Result<(), SignalError> {
        let (lines, entries) = (self.frequency_hz.len(), self.n_outputs() * self.n_inputs());
        let Some(known) = known else { return Ok(()) };
        let (found, needed) = (known.covariance.dim(), (lines, entries, entries));
        let shape = known.covariance.shape();
        require_shape(name, shape, found == needed, format_args!("{needed:?}"))?;
        let variances = known.covariance.outer_iter();
        let mut variances = variances.flat_map(|of_line| of_line.into_diag().to_vec());
        if let Some(variance) = variances.find(|variance| variance.re < 0.0) {
            let what = format!(
                "{name} holds the variance {}; needed: 0 or more",
                variance.re
            );
            return Err(SignalError::unfit(name, what));
        }
        let freedom = known.degrees_of_freedom;
        require("degrees of freedom", freedom, freedom >= 0.0, "0 or more")
    }

    /// Number of frequencies.
    #[must_use]
    pub fn n_frequencies(&self) -> usize {
        self.frequency_hz.len()
    }

    /// Number of outputs.
    #[must_use]
    pub fn n_outputs(&self) -> usize {
        self.response.len_of(Axis(1))
    }

    /// Number of inputs.
    #[must_use]
    pub fn n_inputs(&self) -> usize {
        self.response.len_of(Axis(2))
    }

    /// Noise variance of every entry of the averaged FRF, `(frequency, output, input)`; `None` if
    /// it was not measured.
    #[must_use]
    pub fn noise_variance(&self) -> Option<Array3<f64>> {
        self.noise.as_ref().map(|noise| self.entries_of(noise))
    }

    /// Total variance of every entry of the averaged FRF, `(frequency, output, input)`; `None` if
    /// it was not measured.
    #[must_use]
    pub fn total_variance(&self) -> Option<Array3<f64>> {
        self.total.as_ref().map(|total| self.entries_of(total))
    }

    /// Level of the stochastic nonlinear distortion of one realization, `n_p (total - noise)` per
    /// entry, `(frequency, output, input)`; `None` unless both are known.
    ///
    /// Without distortion its mean is 0, and it is negative on every other line: floored at 0 it would
    /// tell distortion of a linear machine. Draw it floored, average it as it is.
    #[must_use]
    pub fn nonlinear_variance(&self) -> Option<Array3<f64>> {
        let realizations = self.total.as_ref()?.degrees_of_freedom + 1.0;
        let (total, noise) = (self.total_variance()?, self.noise_variance()?);
        Some(realizations * (total - noise))
    }

    /// Standard deviation of the matrix by noise as a share of its size, line by line; `None` if the noise was
    /// not measured.
    #[must_use]
    pub fn relative_noise(&self) -> Option<Vec<f64>> {
        let variances = self.noise_variance()?;
        let lines = zip(variances.outer_iter(), self.response.outer_iter());
        let share = |(variance, response): (ArrayView2<f64>, ArrayView2<Complex64>)| {
            let size: f64 = response.iter().map(Complex64::norm_sqr).sum();
            (variance.sum() / size).sqrt()
        };
        Some(lines.map(share).collect())
    }

    /// Magnitude of one entry in dB over frequency.
    #[must_use]
    pub fn magnitude_db(&self, output: usize, input: usize) -> Vec<f64> {
        (0..self.n_frequencies())
            .map(|k| 20.0 * self.response[[k, output, input]].norm().log10())
            .collect()
    }

    /// Phase of one entry in degrees over frequency, in (-180, 180].
    #[must_use]
    pub fn phase_deg(&self, output: usize, input: usize) -> Vec<f64> {
        (0..self.n_frequencies())
            .map(|k| self.response[[k, output, input]].arg().to_degrees())
            .collect()
    }

    /// The matrix at one frequency, `(output, input)`.
    #[must_use]
    pub fn at(&self, frequency: usize) -> Array2<Complex64> {
        self.response.index_axis(Axis(0), frequency).to_owned()
    }

    /// The diagonal of the covariances, sorted back into `(frequency, output, input)`.
    fn entries_of(&self, known: &Uncertainty) -> Array3<f64> {
        let outputs = self.n_outputs();
        Array3::from_shape_fn(self.response.dim(), |(k, output, input)| {
            let entry = input * outputs + output;
            known.covariance[[k, entry, entry]].re
        })
    }
}

/// Checks condition numbers: 1 or more, NaN where none is known.
fn check_condition(condition: &[f64]) -> Result<(), SignalError> {
    match condition.iter().find(|&&number| number < 1.0) {
        Some(number) => {
            let what =
                format!("condition holds {number}; needed: 1 or more, NaN where it is not known");
            Err(SignalError::unfit("condition", what))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frf() -> Frf {
        let response =
            Array3::from_shape_fn((2, 2, 1), |(k, o, _)| Complex64::new(k as f64, o as f64));
        Frf::new(vec![1.0, 2.0], response).expect("shapes agree")
    }

    #[test]
    fn shapes_are_checked_and_unmeasured_variance_is_none() {
        let needed = "(1, outputs, inputs), one matrix per frequency".to_owned();
        assert_eq!(
            Frf::new(vec![1.0], Array3::zeros((2, 1, 1))),
            Err(SignalError::Shape {
                name: "response",
                found: vec![2, 1, 1],
                needed
            })
        );
        assert_eq!(frf().noise_variance(), None);
        assert_eq!(frf().nonlinear_variance(), None);
    }

    #[test]
    fn the_diagonal_of_the_covariance_lands_on_its_entry() {
        let covariance =
            Array3::from_shape_fn((2, 2, 2), |(_, i, j)| Complex64::from((10 * i + j) as f64));
        let known = Frf {
            noise: Some(Uncertainty {
                covariance,
                degrees_of_freedom: 3.0,
            }),
            ..frf()
        };
        let variance = known.noise_variance().expect("was given");
        assert_eq!((variance[[0, 0, 0]], variance[[1, 1, 0]]), (0.0, 11.0));
    }

    #[test]
    fn numbers_that_cannot_be_are_refused() {
        let refused = |change: fn(&mut Frf)| {
            let mut changed = frf();
            change(&mut changed);
            changed.check().expect_err("cannot be").path().join(".")
        };
        assert_eq!(refused(|frf| frf.frequency_hz[0] = -1.0), "frequency_hz");
        assert_eq!(
            refused(|frf| frf.frequency_hz[1] = f64::NAN),
            "frequency_hz"
        );
        assert_eq!(
            refused(|frf| frf.condition = Some(vec![-1.0, 2.0])),
            "condition"
        );
        assert_eq!(
            refused(|frf| frf.condition = Some(vec![2.0, 0.5])),
            "condition"
        );
        assert_eq!(
            refused(|frf| frf.relative_resolution = Some(f64::NAN)),
            "relative_resolution"
        );
        let sound = Frf {
            frequency_hz: vec![0.0, 2.0],
            condition: Some(vec![f64::NAN, 1.0]),
            ..frf()
        };
        assert_eq!(sound.check(), Ok(()));
    }
}
