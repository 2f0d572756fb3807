//! Extremum of the magnitude of a local rational fit: place, level and half-power width, with their
//! standard errors.

use num_complex::Complex64;

use crate::compare::feature::rational_fit::{
    N_PARAMETERS, Parameters, RationalFit, denominator, numerator,
};
use crate::compare::feature::resonance::FeatureKind;

/// Steps of Newton; the last ones gain all digits.
const STEPS: usize = 30;
/// Steps to either half-power point, in quarters of the distance of root and axis: with that many
/// the level has long turned round.
const STEPS_OUT: usize = 60;
/// Furthest half-power point from the middle of the window, over its half width: a narrow window
/// knows its root well enough.
const FURTHEST: f64 = 2.0;
/// Halvings of the step with the half-power point in it: its digits.
const HALVINGS: usize = 40;
/// Step of the derivatives in standard deviations: small, the errors are linear in it, and far
/// above rounding.
const STEP_SIGMAS: f64 = 1e-2;

/// Standard deviation of the place over the distance of root and axis, half the half-power width, up
/// to which errors are linear: beyond, the root may as well be one of the noise.
const LINEAR: f64 = 0.25;

/// The extremum in coordinates of the fit.
#[derive(Clone, Copy)]
pub(crate) struct Extremum {
    /// Place x.
    pub(crate) place: f64,
    /// Logarithm of the magnitude.
    pub(crate) level: f64,
    /// Distance of the half-power points; `None` where a side does not fall by 3 dB.
    pub(crate) width: Option<f64>,
}

/// Standard deviations of an extremum.
#[derive(Clone, Copy)]
pub(crate) struct Errors {
    pub(crate) place: f64,
    pub(crate) level: f64,
    pub(crate) width: Option<f64>,
}

/// The extremum of that kind within the window, -1 to 1, and its standard deviations; `None` where
/// there is none, or the lines are too noisy for it.
pub(crate) fn extremum(fit: &RationalFit, kind: FeatureKind) -> Option<(Extremum, Errors)> {
    let root = root(&fit.parameters, kind)?;
    let found = read(&fit.parameters, kind, root)?;
    let (mut place, mut level, mut width) = (0.0, 0.0, Some(0.0));
    let rise = gradients(fit, kind, &found, root)?;
    for (k, row) in rise.iter().enumerate() {
        for (j, column) in rise.iter().enumerate() {
            // dg = Re(conj(c) d) with E[d dH] = C has the variance cH C c / 2
            let share =
                |a: Complex64, b: Complex64| 0.5 * (a.conj() * fit.covariance[(k, j)] * b).re;
            place += share(row.place, column.place);
            level += share(row.level, column.level);
            let pair = row.width.zip(column.width);
            width = width.zip(pair).map(|(sum, (a, b))| sum + share(a, b));
        }
    }
    let errors = Errors {
        place: place.sqrt(),
        level: level.sqrt(),
        width: width.map(f64::sqrt),
    };
    (errors.place <= LINEAR * root.im.abs()).then_some((found, errors))
}

/// Derivatives by one complex parameter, `d/dRe + i d/dIm`.
struct Gradient {
    place: Complex64,
    level: Complex64,
    width: Option<Complex64>,
}

fn gradients(
    fit: &RationalFit,
    kind: FeatureKind,
    found: &Extremum,
    root: Complex64,
) -> Option<Vec<Gradient>> {
    let start = Complex64::new(found.place, root.im);
    let by = |k: usize| {
        let size = fit.parameters[k].norm();
        let step = (STEP_SIGMAS * fit.covariance[(k, k)].re.sqrt()).max(1e-7 * size);
        let slope = |direction: Complex64| {
            let moved = |step: f64| {
                let mut parameters = fit.parameters;
                parameters[k] += direction * step;
                read(&parameters, kind, start)
            };
            Some((moved(step)?, moved(-step)?))
        };
        let (re, im) = (slope(Complex64::ONE)?, slope(Complex64::I)?);
        let rise = |value: fn(&Extremum) -> Option<f64>| {
            let of = |(up, down): &(Extremum, Extremum)| {
                Some((value(up)? - value(down)?) / (2.0 * step))
            };
            Some(Complex64::new(of(&re)?, of(&im)?))
        };
        Some(Gradient {
            place: rise(|found| Some(found.place))?,
            level: rise(|found| Some(found.level))?,
            width: rise(|found| found.width),
        })
    };
    (0..N_PARAMETERS).map(by).collect()
}

/// The pole, or the zero that is nearest to the axis, inside the window.
fn root(p: &Parameters, kind: FeatureKind) -> Option<Complex64> {
    let roots = match kind {
        FeatureKind::Resonance => vec![-1.0 / p[3]],
        FeatureKind::Antiresonance => {
            let spread = (p[1] * p[1] - 4.0 * p[0] * p[2]).sqrt();
            // the one that does not cancel
            let sum = if (p[1].conj() * spread).re < 0.0 {
                p[1] - spread
            } else {
                p[1] + spread
            };
            vec![-0.5 * sum / p[2], -2.0 * p[0] / sum]
        }
    };
    let inside = roots
        .into_iter()
        .filter(|root| root.re.abs() < 1.0 && root.im != 0.0);
    inside.min_by(|a, b| a.im.abs().total_cmp(&b.im.abs()))
}

/// Newton on the slope of the level from the place of the root.
fn read(p: &Parameters, kind: FeatureKind, root: Complex64) -> Option<Extremum> {
    let (mut place, furthest) = (root.re, root.im.abs());
    for _ in 0..STEPS {
        let (slope, bend) = slope_and_bend(p, place);
        let is_there = (bend < 0.0) == (kind == FeatureKind::Resonance);
        if !is_there {
            return None;
        }
        let step = (-slope / bend).clamp(-0.5 * furthest, 0.5 * furthest);
        place += step;
        if step.abs() < 1e-13 {
            break;
        }
    }
    let level = level(p, place);
    let way_out = |direction: f64| half_power(p, kind, (place, level), direction * 0.25 * furthest);
    let width = way_out(1.0)
        .zip(way_out(-1.0))
        .map(|(high, low)| high - low);
    let is_inside = place.abs() < 1.0 && level.is_finite();
    is_inside.then_some(Extremum {
        place,
        level,
        width,
    })
}

/// Logarithm of the magnitude.
fn level(p: &Parameters, x: f64) -> f64 {
    (numerator(p, x) / denominator(p, x)).norm().ln()
}

/// First and second derivative of the level.
fn slope_and_bend(p: &Parameters, x: f64) -> (f64, f64) {
    let (b, a) = (numerator(p, x), denominator(p, x));
    let (b_slope, a_slope) = ((p[1] + 2.0 * x * p[2]) / b, p[3] / a);
    let bend = 2.0 * p[2] / b - b_slope * b_slope + a_slope * a_slope;
    ((b_slope - a_slope).re, bend.re)
}

/// The place where the level has come half the power away from the extremum.
fn half_power(
    p: &Parameters,
    kind: FeatureKind,
    (place, top): (f64, f64),
    step: f64,
) -> Option<f64> {
    let sign = if kind == FeatureKind::Resonance {
        1.0
    } else {
        -1.0
    };
    let fallen = |x: f64| sign * (top - level(p, x));
    let half = 0.5 * 2f64.ln();
    let mut inside = place;
    for _ in 0..STEPS_OUT {
        let outside = inside + step;
        if outside.abs() > FURTHEST || fallen(outside) < fallen(inside) {
            return None;
        }
        if fallen(outside) >= half {
            return Some(halved(inside, outside, |x| fallen(x) < half));
        }
        inside = outside;
    }
    None
}

/// The place between two at which `is_inside` changes.
fn halved(mut inside: f64, mut outside: f64, is_inside: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        if is_inside(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    0.5 * (inside + outside)
}
