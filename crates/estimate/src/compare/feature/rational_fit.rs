//! Local rational fit of an FRF: a quadratic over a linear polynomial, one pole and two zeros,
//! which a resonance or antiresonance and the slope below it are over a few bandwidths.
//!
//! `F(x) = (b0 + b1 x + b2 x^2) / (1 + a1 x)` over `x = (f - centre) / half width`, the parameters
//! complex, least squares with the variances of the lines. (The local rational method: T. McKelvey,
//! G. Guerin, Non-parametric frequency response estimation using a local rational model, SYSID
//! 2012; here it is fitted to the FRF, and by Gauss-Newton on its own error.)

use nalgebra::{SMatrix, SVector};
use num_complex::Complex64;

/// `b0`, `b1`, `b2`, `a1`.
pub(crate) type Parameters = SVector<Complex64, N_PARAMETERS>;
type Square = SMatrix<Complex64, N_PARAMETERS, N_PARAMETERS>;

pub(crate) const N_PARAMETERS: usize = 4;
/// Rounds of the linearised problem, weighted with its last denominator (Sanathanan and Koerner),
/// which start Gauss-Newton near enough.
const STARTS: usize = 3;
/// Steps of Gauss-Newton; near the minimum each gains digits.
const STEPS: usize = 8;
/// Misfit that the noise explains, in standard deviations beyond its mean: one window in twenty is
/// called too wide though it is not, which costs little.
const EXPLAINED: f64 = 1.65;
/// Relative gain below which it has arrived.
const ARRIVED: f64 = 1e-9;

/// A line of the window.
pub(crate) struct Sample {
    pub(crate) x: f64,
    pub(crate) response: Complex64,
    /// E|dG|^2 as it was measured.
    pub(crate) variance: f64,
    /// The same, pooled: its inverse is the weight.
    pub(crate) pooled: f64,
}

/// A fit with its uncertainty.
pub(crate) struct RationalFit {
    pub(crate) parameters: Parameters,
    /// E[d dH] of the parameters.
    pub(crate) covariance: Square,
    /// Squared residuals over what their variances let expect, where that is more than chance, else 1.
    pub(crate) excess: f64,
}

/// One equation of a linear least-squares problem.
struct Row {
    coefficients: Parameters,
    target: Complex64,
    weight: f64,
}

pub(crate) fn numerator(p: &Parameters, x: f64) -> Complex64 {
    p[0] + x * (p[1] + x * p[2])
}

pub(crate) fn denominator(p: &Parameters, x: f64) -> Complex64 {
    1.0 + x * p[3]
}

/// The fit of a window; `None` where its lines do not determine it.
pub(crate) fn fit(samples: &[Sample]) -> Option<RationalFit> {
    let mut parameters = Parameters::zeros();
    for _ in 0..STARTS {
        let rows = samples.iter().map(|sample| linearised(&parameters, sample));
        parameters = solve(rows)?.1;
    }
    let mut misfit = misfit_of(&parameters, samples);
    for _ in 0..STEPS {
        let rows = samples.iter().map(|sample| residual(&parameters, sample));
        let next = parameters + solve(rows)?.1;
        let next_misfit = misfit_of(&next, samples);
        if next_misfit.is_nan() || next_misfit >= misfit {
            break;
        }
        let gain = misfit - next_misfit;
        (parameters, misfit) = (next, next_misfit);
        if gain < ARRIVED * misfit {
            break;
        }
    }
    let excess = excess_of(misfit, samples.len());
    let covariance = covariance(&parameters, samples, excess)?;
    misfit.is_finite().then_some(RationalFit {
        parameters,
        covariance,
        excess,
    })
}

/// `B - a1 x G = G`, divided by the last denominator.
fn linearised(last: &Parameters, sample: &Sample) -> Row {
    let Sample {
        x,
        response,
        pooled,
        ..
    } = *sample;
    let one = Complex64::ONE;
    Row {
        coefficients: Parameters::new(one, one * x, one * x * x, -response * x),
        target: response,
        weight: 1.0 / (pooled * denominator(last, x).norm_sqr()),
    }
}

/// The residual and its derivatives.
fn residual(parameters: &Parameters, sample: &Sample) -> Row {
    let Sample {
        x,
        response,
        pooled,
        ..
    } = *sample;
    let over = 1.0 / denominator(parameters, x);
    let value = numerator(parameters, x) * over;
    Row {
        coefficients: Parameters::new(over, over * x, over * x * x, -value * over * x),
        target: response - value,
        weight: 1.0 / pooled,
    }
}

fn misfit_of(parameters: &Parameters, samples: &[Sample]) -> f64 {
    let of = |sample: &Sample| {
        let value = numerator(parameters, sample.x) / denominator(parameters, sample.x);
        (sample.response - value).norm_sqr() / sample.pooled
    };
    samples.iter().map(of).sum()
}

/// Inverse of the normal matrix, and the solution.
fn solve(rows: impl Iterator<Item = Row>) -> Option<(Square, Parameters)> {
    let (mut normal, mut right) = (Square::zeros(), Parameters::zeros());
    for row in rows {
        let conjugate = row.coefficients.map(|value| value.conj() * row.weight);
        normal += conjugate * row.coefficients.transpose();
        right += conjugate * row.target;
    }
    let inverse = normal.cholesky()?.inverse();
    Some((inverse, inverse * right))
}

/// Misfit over the lines less the parameters, where that is more than chance, else 1.
fn excess_of(misfit: f64, n_lines: usize) -> f64 {
    let spare = (n_lines - N_PARAMETERS) as f64;
    let is_explained = misfit <= spare + EXPLAINED * spare.sqrt();
    if is_explained { 1.0 } else { misfit / spare }
}

/// The variances as measured, through the weights of the fit: what the weights' own error does is
/// in it. Where the lines miss the fit by more than their variances, the variances are `excess` times as
/// large, and each at least what its own line misses a fit without it by (jackknife: J. MacKinnon, H. White,
/// J. Econometrics 29 (1985) 305): distortion gathers on the lines next to a resonance, which the fit leans on.
fn covariance(parameters: &Parameters, samples: &[Sample], excess: f64) -> Option<Square> {
    let rows = || samples.iter().map(|sample| residual(parameters, sample));
    let inverse = solve(rows())?.0;
    let mut spread = Square::zeros();
    for (row, sample) in rows().zip(samples) {
        let conjugate = row.coefficients.map(|value| value.conj() * row.weight);
        let variance = match excess > 1.0 {
            true => (excess * sample.variance).max(missed(&row, &inverse)),
            false => sample.variance,
        };
        spread += conjugate * conjugate.adjoint() * Complex64::from(variance);
    }
    Some(inverse * spread * inverse)
}

/// Squared distance of a line from a fit without it, `|e|^2 / (1 - h)^2` with its leverage h.
fn missed(row: &Row, inverse: &Square) -> f64 {
    let conjugate = row.coefficients.map(|value| value.conj());
    let leverage = row.weight * (row.coefficients.transpose() * inverse * conjugate)[0].re;
    row.target.norm_sqr() / (1.0 - leverage).powi(2)
}
