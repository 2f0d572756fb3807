//! Gram matrix of harmonics at the times of samples, and least squares with it by conjugate gradients.
//!
//! With c the coefficients of `x(t) = sum_h c[h] e^{2 pi i h t}`, h from -H to H, t in periods, the
//! normal equations of samples at t_k are `sum_l g[h - l] c[l] = sum_k x_k e^{-2 pi i h t_k}` with
//! `g[h] = sum_k e^{-2 pi i h t_k}`: a Toeplitz matrix, applied by FFT whatever the times are
//! (Feichtinger, Groechenig, Strohmer, Numer. Math. 69 (1995) 423). Signals are real, so only h >= 0
//! is kept.

use std::iter::zip;
use std::sync::Arc;

use frfid_signals::random::{phase, stream};
use nalgebra::DMatrix;
use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

/// Largest ratio of eigenvalues: beyond it the noise of some combination of lines is ten times that
/// of the best known one, and what other lines leak in grows alike. Losses at random have 1.5 to 2.
const WORST_CONDITION: f64 = 100.0;
/// Residual at which the normal equations are solved: what the rounding of their sums leaves.
const TOLERANCE: f64 = 1e-14;
/// At the worst condition conjugate gradients gain a digit in 12 steps, so that 14 digits take 170.
const MOST_STEPS: usize = 200;
/// Seed of the right-hand side with which the condition is measured: any will do.
const PROBE: u64 = 1;

/// The Gram matrix of a constant and some harmonics at the times of the samples that are there.
pub(super) struct Gram {
    /// Harmonics that are unknown, rising, 0 first.
    harmonics: Vec<usize>,
    /// Number of samples.
    n_present: f64,
    /// `g` as weights on an even grid of times, fine enough for products of all harmonics.
    weights: Vec<f64>,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

/// What conjugate gradients found.
struct Solution {
    coefficients: Vec<Complex64>,
    /// Ratio of the largest to the smallest eigenvalue met; infinite where they did not converge.
    condition: f64,
}

impl Gram {
    /// From the sums `g[h]` for h = 0 to twice the highest harmonic.
    pub(super) fn new(harmonics: Vec<usize>, sums: &[Complex64]) -> Self {
        // products of two harmonics reach 2 H, those with a third 3 H: with more than 4 H points
        // none of them folds back onto a harmonic
        let n_points = (2 * sums.len()).next_power_of_two();
        let mut planner = RealFftPlanner::new();
        let (forward, inverse) = (
            planner.plan_fft_forward(n_points),
            planner.plan_fft_inverse(n_points),
        );
        let mut bins = inverse.make_input_vec();
        bins[..sums.len()].copy_from_slice(sums);
        bins[0].im = 0.0;
        let mut weights = inverse.make_output_vec();
        inverse
            .process(&mut bins, &mut weights)
            .expect("the plan made the buffers; both ends of the spectrum are real");
        weights
            .iter_mut()
            .for_each(|weight| *weight /= n_points as f64);
        Self {
            harmonics,
            n_present: sums[0].re,
            weights,
            forward,
            inverse,
        }
    }

    /// Variance of a coefficient, mean over the harmonics, over that from `n_samples` even ones;
    /// `None` where the samples cannot tell the harmonics apart.
    pub(super) fn variance_growth(&self, n_samples: usize) -> Option<f64> {
        let n_unknowns = 2 * self.harmonics.len() - 1;
        if self.n_present < n_unknowns as f64 {
            return None;
        }
        // Hutchinson's trace: the quadratic form of a vector of random phases has the mean of the
        // diagonal of the inverse
        let mut rng = stream(PROBE, "probe", &[]);
        let mut probe: Vec<Complex64> = (self.harmonics.iter())
            .map(|_| Complex64::cis(phase(&mut rng)))
            .collect();
        probe[0] = Complex64::ONE;
        let found = self.conjugate_gradients(&probe);
        let growth = n_samples as f64 * dot(&probe, &found.coefficients) / n_unknowns as f64;
        (found.condition <= WORST_CONDITION).then_some(growth)
    }

    /// Coefficients whose normal equations have this right-hand side.
    pub(super) fn solve(&self, right: &[Complex64]) -> Vec<Complex64> {
        self.conjugate_gradients(right).coefficients
    }

    /// Conjugate gradients from the coefficients that even samples would have.
    fn conjugate_gradients(&self, right: &[Complex64]) -> Solution {
        let mut found: Vec<_> = right.iter().map(|value| value / self.n_present).collect();
        let mut residual = right.to_vec();
        add(&mut residual, -1.0, &self.times(&found));
        let mut direction = residual.clone();
        let mut power = dot(&residual, &residual);
        let enough = TOLERANCE.powi(2) * dot(right, right);
        let mut steps = Vec::new();
        while power > enough && steps.len() < MOST_STEPS {
            let image = self.times(&direction);
            let step = power / dot(&direction, &image);
            if !(step > 0.0 && step.is_finite()) {
                break;
            }
            add(&mut found, step, &direction);
            add(&mut residual, -step, &image);
            let before = std::mem::replace(&mut power, dot(&residual, &residual));
            let ratio = power / before;
            for (direction, residual) in zip(&mut direction, &residual) {
                *direction = residual + *direction * ratio;
            }
            steps.push((step, ratio));
        }
        let has_converged = power <= enough;
        Solution {
            coefficients: found,
            condition: match has_converged {
                true => condition(&steps),
                false => f64::INFINITY,
            },
        }
    }

    /// The Gram matrix times coefficients.
    fn times(&self, coefficients: &[Complex64]) -> Vec<Complex64> {
        let mut bins = self.inverse.make_input_vec();
        for (&harmonic, value) in zip(&self.harmonics, coefficients) {
            bins[harmonic] = *value;
        }
        bins[0].im = 0.0;
        let mut points = self.inverse.make_output_vec();
        self.inverse
            .process(&mut bins, &mut points)
            .expect("the plan made the buffers; both ends of the spectrum are real");
        zip(&mut points, &self.weights).for_each(|(point, weight)| *point *= weight);
        self.forward
            .process(&mut points, &mut bins)
            .expect("the plan made the buffers, so their lengths fit");
        self.harmonics
            .iter()
            .map(|&harmonic| bins[harmonic])
            .collect()
    }
}

/// Inner product of the coefficients of two real signals, those of the negative harmonics included.
fn dot(a: &[Complex64], b: &[Complex64]) -> f64 {
    let product = |(a, b): (&Complex64, &Complex64)| a.re * b.re + a.im * b.im;
    2.0 * zip(a, b).map(product).sum::<f64>() - a[0].re * b[0].re
}

/// `a += factor b`.
fn add(a: &mut [Complex64], factor: f64, b: &[Complex64]) {
    zip(a, b).for_each(|(a, b)| *a += factor * b);
}

/// Condition from the steps of conjugate gradients and the ratios of their residuals: they are the
/// tridiagonal matrix of Lanczos (Golub, Van Loan, Matrix Computations, section 11.3).
fn condition(steps: &[(f64, f64)]) -> f64 {
    if steps.is_empty() {
        return 1.0; // even samples: the first guess was right
    }
    let entry = |i: usize, j: usize| match i.abs_diff(j) {
        0 => 1.0 / steps[i].0 + i.checked_sub(1).map_or(0.0, |k| steps[k].1 / steps[k].0),
        1 => steps[i.min(j)].1.sqrt() / steps[i.min(j)].0,
        _ => 0.0,
    };
    let eigenvalues = DMatrix::from_fn(steps.len(), steps.len(), entry).symmetric_eigenvalues();
    let (low, high) = (eigenvalues.min(), eigenvalues.max());
    if low > 0.0 { high / low } else { f64::INFINITY }
}
