//! Gram matrix of harmonics at the times of samples, and least squares with it by conjugate gradients.
//!
//! With c the coefficients of `x(t) = sum_h c[h] e^{2 pi i h t}`, h from -H to H, t in periods, the
//! normal equations of samples at t_k are `sum_l g[h - l] c[l] = sum_k x_k e^{-2 pi i h t_k}` with
//! `g[h] = sum_k e^{-2 pi i h t_k}`: a Toeplitz matrix, applied by FFT whatever the times are
//! (Feichtinger, Groechenig, Strohmer, Numer. Math. 69 (1995) 423). Signals are real, so only h >= 0
//! is kept.

use std::iter::zip;
use std::mem::replace;
use std::sync::Arc;

use frfid_signals::random::{phase, stream};
use frfid_transforms::{ComplexToReal, RealToComplex, TransformPlanner};
use nalgebra::DMatrix;
use num_complex::Complex64;

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
        let mut planner = TransformPlanner::default();
        let inverse = planner.inverse(n_points);
        let mut bins = inverse.make_input_vec();
        bins[..sums.len()].copy_from_slice(sums);
        let weights = points(inverse.as_ref(), bins).into_iter();
        Self {
            harmonics,
            n_present: sums[0].re,
            weights: weights.map(|weight| weight / n_points as f64).collect(),
            forward: planner.forward(n_points),
            inverse,
        }
    }

    /// Variance of a coefficient, mean over the harmonics, over that from `n_samples` even ones;
    /// `None` where the samples cannot tell the harmonics apart.
    ///
    /// Hutchinson's trace: the quadratic form of a vector of random phases has the mean of the
    /// diagonal of the inverse.
    pub(super) fn variance_growth(&self, n_samples: usize) -> Option<f64> {
        let n_unknowns = (2 * self.harmonics.len() - 1) as f64;
        if self.n_present < n_unknowns {
            return None;
        }
        let probe = self.random_phases();
        let found = self.conjugate_gradients(&probe);
        let growth = n_samples as f64 * dot(&probe, &found.coefficients) / n_unknowns;
        (found.condition <= WORST_CONDITION).then_some(growth)
    }

    fn random_phases(&self) -> Vec<Complex64> {
        let mut rng = stream(PROBE, "probe", &[]);
        let phases = self.harmonics.iter().map(|_| phase(&mut rng));
        let mut probe: Vec<Complex64> = phases.map(Complex64::cis).collect();
        probe[0] = Complex64::ONE;
        probe
    }

    /// Coefficients whose normal equations have this right-hand side.
    pub(super) fn solve(&self, right: &[Complex64]) -> Vec<Complex64> {
        self.conjugate_gradients(right).coefficients
    }

    /// Conjugate gradients from the coefficients that even samples would have.
    fn conjugate_gradients(&self, right: &[Complex64]) -> Solution {
        let mut search = self.first_guess(right);
        let enough = TOLERANCE.powi(2) * dot(right, right);
        let mut steps = Vec::new();
        while search.power > enough && steps.len() < MOST_STEPS {
            let Some(step) = search.advance(&self.times(&search.direction)) else {
                break;
            };
            steps.push(step);
        }
        let has_converged = search.power <= enough;
        Solution {
            coefficients: search.found,
            condition: match has_converged {
                true => condition(&steps),
                false => f64::INFINITY,
            },
        }
    }

    /// The coefficients that even samples would have.
    fn first_guess(&self, right: &[Complex64]) -> Search {
        let found: Vec<_> = right.iter().map(|value| value / self.n_present).collect();
        let mut residual = right.to_vec();
        add(&mut residual, -1.0, &self.times(&found));
        Search {
            found,
            power: dot(&residual, &residual),
            direction: residual.clone(),
            residual,
        }
    }

    /// The Gram matrix times coefficients.
    fn times(&self, coefficients: &[Complex64]) -> Vec<Complex64> {
        let mut bins = self.inverse.make_input_vec();
        zip(&self.harmonics, coefficients).for_each(|(&harmonic, value)| bins[harmonic] = *value);
        let mut points = points(self.inverse.as_ref(), bins);
        zip(&mut points, &self.weights).for_each(|(point, weight)| *point *= weight);
        let bins = bins_of(self.forward.as_ref(), points);
        let harmonics = self.harmonics.iter();
        harmonics.map(|&harmonic| bins[harmonic]).collect()
    }
}

/// Conjugate gradients on their way.
struct Search {
    found: Vec<Complex64>,
    residual: Vec<Complex64>,
    /// Of the next step.
    direction: Vec<Complex64>,
    /// Square of the residual.
    power: f64,
}

/// A step of conjugate gradients.
struct Step {
    /// Its length in directions.
    length: f64,
    /// Square of the residual over that before.
    ratio: f64,
}

impl Search {
    /// One step, from the direction times the matrix; `None` where rounding leaves no way on.
    fn advance(&mut self, image: &[Complex64]) -> Option<Step> {
        let length = self.power / dot(&self.direction, image);
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        add(&mut self.found, length, &self.direction);
        add(&mut self.residual, -length, image);
        let before = replace(&mut self.power, dot(&self.residual, &self.residual));
        let ratio = self.power / before;
        self.turn(ratio);
        Some(Step { length, ratio })
    }

    /// Makes the next direction conjugate to those before.
    fn turn(&mut self, ratio: f64) {
        for (direction, residual) in zip(&mut self.direction, &self.residual) {
            *direction = residual + *direction * ratio;
        }
    }
}

/// Points in time of bins; the constant is real.
fn points(inverse: &dyn ComplexToReal<f64>, mut bins: Vec<Complex64>) -> Vec<f64> {
    bins[0].im = 0.0;
    let mut points = inverse.make_output_vec();
    inverse
        .process(&mut bins, &mut points)
        .expect("the plan made the buffers; both ends of the spectrum are real");
    points
}

/// Bins of points in time.
fn bins_of(forward: &dyn RealToComplex<f64>, mut points: Vec<f64>) -> Vec<Complex64> {
    let mut bins = forward.make_output_vec();
    forward
        .process(&mut points, &mut bins)
        .expect("the plan made the buffers, so their lengths fit");
    bins
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

/// Condition from the steps of conjugate gradients: they are the tridiagonal matrix of Lanczos
/// (Golub, Van Loan, Matrix Computations, section 11.3).
fn condition(steps: &[Step]) -> f64 {
    if steps.is_empty() {
        return 1.0; // even samples: the first guess was right
    }
    let entry = |i: usize, j: usize| lanczos_entry(steps, i, j);
    let eigenvalues = DMatrix::from_fn(steps.len(), steps.len(), entry).symmetric_eigenvalues();
    let (low, high) = (eigenvalues.min(), eigenvalues.max());
    if low > 0.0 { high / low } else { f64::INFINITY }
}

fn lanczos_entry(steps: &[Step], i: usize, j: usize) -> f64 {
    let first = &steps[i.min(j)];
    match i.abs_diff(j) {
        0 if i > 0 => 1.0 / first.length + steps[i - 1].ratio / steps[i - 1].length,
        0 => 1.0 / first.length,
        1 => first.ratio.sqrt() / first.length,
        _ => 0.0,
    }
}
