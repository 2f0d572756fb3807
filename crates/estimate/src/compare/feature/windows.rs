//! Windows around an extremum in which a local fit is tried: as wide as the fit still describes
//! the lines within their noise.

use crate::compare::curve::Curve;
use crate::compare::feature::fitted_extremum::{Errors, Extremum, extremum};
use crate::compare::feature::rational_fit::{N_PARAMETERS, RationalFit, Sample, fit};
use crate::compare::feature::resonance::FeatureKind;
use crate::compare::scatter::Scatter;

/// Lines to either side in the narrowest window: with three there are three more than parameters.
const NARROWEST: usize = 3;
/// Half width of the widest window over its frequency: beyond, other modes have their say.
const WIDEST: f64 = 0.5;
/// Misfit that the noise explains, in standard deviations beyond its mean: one window in twenty is
/// called too wide though it is not, which costs little.
const EXPLAINED: f64 = 1.65;
/// Rounding of estimates, relative: a line is known no better, whatever its variance.
const ROUNDING: f64 = 1e-9;

/// Extremum of a curve in physical units.
#[derive(Clone, Copy)]
pub(crate) struct Local {
    pub(crate) frequency_hz: f64,
    pub(crate) frequency_std_hz: f64,
    /// Natural logarithm.
    pub(crate) level: f64,
    pub(crate) level_std: f64,
    pub(crate) damping: Option<f64>,
    pub(crate) damping_std: Option<f64>,
}

/// Lines `low..=high` around a top.
struct Window {
    low: usize,
    high: usize,
    centre_hz: f64,
    half_hz: f64,
}

/// The extremum near line `top`, by the last but one window, growing, that the noise explains: the
/// widest may hide a misfit as large as its noise. Where none is explained, by the narrowest, its
/// errors enlarged by its misfit.
pub(crate) fn local_extremum(curve: &Curve, top: usize, kind: FeatureKind) -> Option<Local> {
    let scatter = curve.scatter.as_ref()?;
    let (mut last_but_one, mut last): (Option<Local>, Option<Local>) = (None, None);
    let mut half = NARROWEST;
    while let Some(window) = window(curve, top, half) {
        let fit = fit(&samples(curve, scatter, &window)?)?;
        let spare = (window.high - window.low + 1 - N_PARAMETERS) as f64;
        let is_explained = fit.misfit <= spare + EXPLAINED * spare.sqrt();
        if !is_explained && last.is_some() {
            return last_but_one;
        }
        let excess = if is_explained {
            1.0
        } else {
            fit.misfit / spare
        };
        let found = in_units(&fit, kind, &window, excess);
        if !is_explained {
            return found;
        }
        if found.is_none() {
            break;
        }
        (last_but_one, last) = (last.or(found), found);
        half += half.div_ceil(2);
    }
    last
}

/// Lines `half` to either side of `top`, shifted inwards at the ends; `None` if there are fewer, or
/// all but the narrowest where it is too wide.
fn window(curve: &Curve, top: usize, half: usize) -> Option<Window> {
    let hz = &curve.frequency_hz;
    let high = (top.saturating_sub(half) + 2 * half).min(hz.len() - 1);
    let low = high.checked_sub(2 * half)?;
    let half_hz = 0.5 * (hz[high] - hz[low]);
    let fits = half == NARROWEST || half_hz <= WIDEST * hz[top];
    fits.then_some(Window {
        low,
        high,
        centre_hz: 0.5 * (hz[low] + hz[high]),
        half_hz,
    })
}

/// The lines of a window; `None` if the scatter of one is not known.
fn samples(curve: &Curve, scatter: &Scatter, window: &Window) -> Option<Vec<Sample>> {
    let sample = |k: usize| {
        let rounding = (ROUNDING * curve.response[k].norm()).powi(2);
        let sample = Sample {
            x: (curve.frequency_hz[k] - window.centre_hz) / window.half_hz,
            response: curve.response[k],
            variance: scatter.variance[k] + rounding,
            pooled: scatter.pooled[k] + rounding,
        };
        (sample.variance.is_finite() && sample.pooled.is_finite()).then_some(sample)
    };
    (window.low..=window.high).map(sample).collect()
}

/// The extremum of a fit whose covariance is `excess` times as large.
fn in_units(fit: &RationalFit, kind: FeatureKind, window: &Window, excess: f64) -> Option<Local> {
    let (
        Extremum {
            place,
            level,
            width,
        },
        errors,
    ) = extremum(fit, kind)?;
    let Errors {
        place: place_std,
        level: level_std,
        width: width_std,
    } = errors;
    let frequency_hz = window.centre_hz + window.half_hz * place;
    let enlarged = excess.sqrt();
    let half_over_hz = 0.5 * window.half_hz / frequency_hz;
    Some(Local {
        frequency_hz,
        frequency_std_hz: enlarged * window.half_hz * place_std,
        level,
        level_std: enlarged * level_std,
        damping: width.map(|width| half_over_hz * width),
        damping_std: width
            .and(width_std)
            .map(|std| enlarged * half_over_hz * std),
    })
}
