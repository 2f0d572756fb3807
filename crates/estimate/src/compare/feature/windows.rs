//! Windows around an extremum in which a local fit is tried: as wide as the fit still describes
//! the lines within their noise.

use crate::compare::curve::Curve;
use crate::compare::feature::fitted_extremum::{Errors, Extremum, extremum};
use crate::compare::feature::rational_fit::{RationalFit, Sample, fit};
use crate::compare::feature::resonance::FeatureKind;

/// Lines to either side in the narrowest window: with three there are three more than parameters.
const NARROWEST: usize = 3;
/// Half width of the widest window over its frequency: beyond, other modes have their say.
const WIDEST: f64 = 0.3;
/// Standard deviations by which what two windows find differs by more than noise.
const BIASED: f64 = 1.0;
/// Misfit of a window over that of the next one, of one and a half its width.
const NARROWER: f64 = 0.4;
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

/// What local fits around a line find.
pub(crate) struct LocalFit {
    /// The extremum; `None` where there is none, or no scatter is known.
    pub(crate) extremum: Option<Local>,
    /// Misfit of the lines next to it over their noise where that is more than chance, else 1.
    pub(crate) excess: f64,
}

/// The extremum near line `top` by the widest window, growing, before the first that is biased; its
/// errors hold its share of that bias.
pub(crate) fn local_fit(curve: &Curve, top: usize, kind: FeatureKind) -> LocalFit {
    let (mut tried, mut excess): (Vec<Tried>, f64) = (Vec::new(), 1.0);
    let mut half = NARROWEST;
    while let Some(window) = window(curve, top, half) {
        let Some(samples) = samples(curve, &window) else {
            break;
        };
        if let Some(fit) = fit(&samples) {
            excess = if half == NARROWEST {
                fit.excess
            } else {
                excess
            };
            let local = in_units(&fit, kind, &window);
            tried.extend(local.map(|local| Tried {
                local,
                excess: fit.excess,
            }));
        }
        if tried.len() > 1 && is_biased(&tried) {
            break;
        }
        half += half.div_ceil(2);
    }
    LocalFit {
        extremum: best(&tried),
        excess,
    }
}

/// What a window finds, and its misfit over the noise where that is more than chance, else 1.
struct Tried {
    local: Local,
    excess: f64,
}

/// Whether the last window misses more than the noise, or finds something else than a narrower one
/// by more than their noise. (Of an efficient estimate and another the difference has the
/// difference of their variances: J. Hausman, Econometrica 46 (1978) 1251.)
fn is_biased(tried: &[Tried]) -> bool {
    let Some((wide, narrower)) = tried.split_last() else {
        return false;
    };
    let differs = |narrow: &Tried| {
        let (narrow, wide) = (narrow.local.quantities(), wide.local.quantities());
        let mut pairs = narrow.into_iter().zip(wide).filter_map(|(x, y)| x.zip(y));
        pairs.any(|((x, std), (y, least))| {
            (x - y).abs() > BIASED * (std * std - least * least).max(0.0).sqrt()
        })
    };
    wide.excess > 1.0 || narrower.iter().any(differs)
}

fn best(tried: &[Tried]) -> Option<Local> {
    match tried {
        [] => None,
        [only] => Some(only.local),
        [.., narrow, wide] if is_biased(tried) => Some(narrow.local.unlike(&wide.local)),
        [.., last] => Some(last.local),
    }
}

impl Local {
    /// Frequency, level and, where there is one, damping with their standard deviations.
    fn quantities(&self) -> [Option<(f64, f64)>; 3] {
        [
            Some((self.frequency_hz, self.frequency_std_hz)),
            Some((self.level, self.level_std)),
            self.damping.zip(self.damping_std),
        ]
    }

    /// With errors that hold what a wider window finds differently: a misfit grows with the cube of
    /// the width or faster.
    fn unlike(self, wider: &Self) -> Self {
        let enlarged = |std: f64, apart: f64| std.hypot(NARROWER * apart);
        let dampings = self.damping.zip(wider.damping);
        let damping_apart = dampings.map_or(0.0, |(narrow, wide)| narrow - wide);
        Self {
            frequency_std_hz: enlarged(
                self.frequency_std_hz,
                self.frequency_hz - wider.frequency_hz,
            ),
            level_std: enlarged(self.level_std, self.level - wider.level),
            damping_std: self.damping_std.map(|std| enlarged(std, damping_apart)),
            ..self
        }
    }
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
fn samples(curve: &Curve, window: &Window) -> Option<Vec<Sample>> {
    let scatter = curve.scatter.as_ref()?;
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

/// The extremum of a fit.
fn in_units(fit: &RationalFit, kind: FeatureKind, window: &Window) -> Option<Local> {
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
    let half_over_hz = 0.5 * window.half_hz / frequency_hz;
    Some(Local {
        frequency_hz,
        frequency_std_hz: window.half_hz * place_std,
        level,
        level_std,
        damping: width.map(|width| half_over_hz * width),
        damping_std: width.and(width_std).map(|std| half_over_hz * std),
    })
}
