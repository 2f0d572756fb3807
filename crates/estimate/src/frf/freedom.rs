//! Degrees of freedom of variances that are sums of unequal parts, after Welch and Satterthwaite:
//! `1/nu = sum (v_i/v)^2 / nu_i`, `v = sum v_i`.
//!
//! The parts of the noise are the realizations, as much as `|W_p|^2 / n_q` of each, and the glides.
//! `1/nu` is the mean over lines and inputs, so that one number holds for all of them. Of the glides
//! it is the share that counts: the variances themselves have few degrees of freedom, so their ratio
//! is the geometric mean over lines and outputs, `E ln(v/E v) = psi(nu) - ln nu` taken off.
//!
//! F. E. Satterthwaite, Biometrics Bulletin 2 (1946) 110; B. L. Welch, Biometrika 34 (1947) 28.

use crate::frf::line_estimate::LineEstimate;
use crate::frf::matrices::Matrix;

/// Above this share of the degrees of freedom of realizations alike they are taken for alike: the
/// 95 % region would hold 0.4 % less at worst.
const ALIKE: f64 = 0.95;

/// What the noise on a line is made up of.
#[derive(Clone)]
pub(crate) struct NoiseParts {
    /// `1/nu` of the realizations.
    of_runs: f64,
    /// The same with one period and one degree of freedom each.
    of_realizations: f64,
    /// Logarithm of the glides' variance over that of the runs for every input, mean over the outputs;
    /// empty without glides.
    glides_over_runs: Vec<f64>,
}

impl NoiseParts {
    /// Of a line with these weights of the realizations, and the covariances by runs and by glides.
    pub(crate) fn of(
        weights: &[Matrix],
        n_periods: &[usize],
        covariances: Option<(Matrix, Matrix)>,
    ) -> Self {
        let n_inputs = weights.first().map_or(0, Matrix::ncols);
        let of_periods = |p: usize| {
            let n_periods = n_periods[p] as f64;
            (n_periods, (n_periods - 1.0).max(1.0))
        };
        Self {
            of_runs: inverse_freedom(weights, of_periods),
            of_realizations: inverse_freedom(weights, |_| (1.0, 1.0)),
            glides_over_runs: covariances.map_or(Vec::new(), |(runs, glides)| {
                log_ratios(&glides, &runs, n_inputs)
            }),
        }
    }
}

/// `1/nu` of the realizations, mean over the inputs, each with so many periods and degrees of freedom.
fn inverse_freedom(weights: &[Matrix], of: impl Fn(usize) -> (f64, f64)) -> f64 {
    let n_inputs = weights.first().map_or(0, Matrix::ncols);
    let of_input = |input: usize| {
        let (mut sum, mut squares) = (0.0, 0.0);
        for (p, weight) in weights.iter().enumerate() {
            let (n_periods, freedom) = of(p);
            let part = weight.column(input).norm_squared() / n_periods;
            sum += part;
            squares += part * part / freedom;
        }
        squares / (sum * sum)
    };
    (0..n_inputs).map(of_input).sum::<f64>() / n_inputs as f64
}

/// Logarithm of a/b on the diagonals, for every input the mean over its entries; NaN where none is
/// there.
fn log_ratios(a: &Matrix, b: &Matrix, n_inputs: usize) -> Vec<f64> {
    let n_outputs = a.nrows() / n_inputs.max(1);
    let of_entry = |entry: usize| (a[(entry, entry)].re / b[(entry, entry)].re).ln();
    let of_input = |input: usize| mean((input * n_outputs..(input + 1) * n_outputs).map(of_entry));
    (0..n_inputs)
        .map(|input| of_input(input).unwrap_or(f64::NAN))
        .collect()
}

/// Degrees of freedom of the covariances.
pub(crate) struct Freedom {
    pub(crate) noise: f64,
    pub(crate) total: f64,
    /// Effective number of realizations over that of all: 1 where all are conditioned alike.
    pub(crate) evenness: f64,
}

impl Freedom {
    /// Of all lines of realizations with these numbers of periods, after so many glides were
    /// subtracted as their mean.
    pub(crate) fn of(lines: &[LineEstimate], n_periods: &[usize], n_glides: usize) -> Self {
        let n_realizations = n_periods.len() as f64;
        let alike = n_periods.iter().sum::<usize>() as f64 - n_realizations;
        let parts = || lines.iter().filter_map(|line| line.noise_parts.as_ref());
        let of_runs =
            mean(parts().map(|parts| parts.of_runs)).map_or(alike, |inverse| 1.0 / inverse);
        let of_runs = if of_runs < ALIKE * alike {
            of_runs
        } else {
            alike
        };
        let effective =
            mean(parts().map(|parts| parts.of_realizations)).map_or(n_realizations, f64::recip);
        let n_inputs = parts()
            .map(|parts| parts.glides_over_runs.len())
            .max()
            .unwrap_or(0);
        let of_input = |input: usize| {
            let ratios = parts().filter_map(|parts| parts.glides_over_runs.get(input));
            with_glides(of_runs, mean(ratios.copied()), n_glides).recip()
        };
        Self {
            noise: mean((0..n_inputs).map(of_input)).map_or(of_runs, f64::recip),
            total: n_realizations - 1.0,
            evenness: effective / n_realizations,
        }
    }
}

/// Degrees of freedom with the part of the glides; one glide was measured by the runs, and all of the
/// noise has their degrees.
fn with_glides(of_runs: f64, log_ratio: Option<f64>, n_glides: usize) -> f64 {
    let Some(log_ratio) = log_ratio.filter(|_| n_glides > 1) else {
        return of_runs;
    };
    let of_glides = n_glides as f64 - 1.0;
    let ratio = (log_ratio - log_bias(of_glides) + log_bias(of_runs)).exp();
    let share = if ratio.is_finite() {
        ratio / (1.0 + ratio)
    } else {
        1.0
    };
    1.0 / ((1.0 - share).powi(2) / of_runs + share.powi(2) / of_glides)
}

/// `E ln(v/E v)` of a variance, `psi(nu) - ln nu`; psi by its recurrence and its asymptotic series
/// (M. Abramowitz, I. Stegun, Handbook of Mathematical Functions, 6.3.5 and 6.3.18).
fn log_bias(freedom: f64) -> f64 {
    /// From here on the series is exact to 1e-8.
    const FAR: f64 = 8.0;
    let (mut x, mut psi) = (freedom, 0.0);
    while x < FAR {
        psi -= 1.0 / x;
        x += 1.0;
    }
    let square = 1.0 / (x * x);
    psi += x.ln() - 0.5 / x - square * (1.0 / 12.0 - square * (1.0 / 120.0 - square / 252.0));
    psi - freedom.ln()
}

/// Mean of the finite ones; `None` of none.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values.filter(|value| value.is_finite()) {
        sum += value;
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// scipy 1.17: `scipy.special.digamma(x) - log(x)`.
    #[test]
    fn biases_of_logarithms_are_those_of_scipy() {
        for (freedom, expected) in [
            (0.5, -1.2703628454614782),
            (1.0, -0.5772156649015329),
            (2.5, -0.21313409122891191),
            (4.0, -0.1301766926880903),
            (19.0, -0.02654656587165949),
            (400.0, -0.0012505208330075845),
        ] {
            let found = log_bias(freedom);
            assert!((found - expected).abs() < 1e-8, "{freedom}: {found}");
        }
    }

    #[test]
    fn glides_of_equal_part_double_the_freedom_at_most() {
        let level = log_bias(4.0) - log_bias(4.0);
        assert!((with_glides(4.0, Some(level), 5) - 8.0).abs() < 1e-12);
        assert_eq!(with_glides(4.0, Some(level), 1), 4.0);
        assert_eq!(with_glides(4.0, None, 5), 4.0);
        assert_eq!(with_glides(4.0, Some(f64::INFINITY), 3), 2.0);
    }
}
