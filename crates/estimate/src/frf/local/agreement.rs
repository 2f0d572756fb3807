//! Agreement of local fits: whether one may stand for another that is less biased.

use std::iter::zip;

use crate::frf::f_distribution::f_tail;
use crate::frf::local::fitted::Fitted;

/// Probability by which a fit may be as far off as it is: of many that are compared.
const AGREEMENT: f64 = 0.005;
/// Standard deviations of its logarithm by which a residual may grow.
const MOST_GROWTH: f64 = 2.5;
/// A residual that grows by less than this factor is noise still.
const LEAST_GROWTH: f64 = 2.0;
/// Probability by which poles may explain as much as they do where there are none.
const POLES_BY_CHANCE: f64 = 0.05;

/// Whether a fit agrees with a narrower one, whose noise is usually `wider` times as large.
pub(super) fn agree(narrow: &Fitted, wide: &Fitted, wider: f64) -> bool {
    let distance = narrow.distance(wide) / wider;
    let is_near = f_tail(distance, narrow.response.len(), narrow.degrees_of_freedom) >= AGREEMENT;
    is_near && !grows(narrow, wide, wider)
}

/// Whether the residual of a wider fit is larger beyond chance.
fn grows(narrow: &Fitted, wide: &Fitted, wider: f64) -> bool {
    let rows = narrow.n_rows as f64;
    let variance = |fitted: &Fitted| 1.0 / (rows * fitted.degrees_of_freedom);
    let chance = (variance(narrow) + variance(wide)).sqrt();
    let growth = zip(wide.noise, narrow.noise).map(|(wide, narrow)| wide / narrow / wider);
    let growth = growth.fold(f64::INFINITY, f64::min).ln();
    growth > LEAST_GROWTH.ln().max(MOST_GROWTH * chance)
}

/// Whether the poles of a fit explain more than a simpler one of the same width, beyond what as many unknowns do by chance.
pub(super) fn explains_more(fit: &Fitted, simpler: &Fitted) -> bool {
    let left = simpler.noise[0] * simpler.degrees_of_freedom / fit.noise[0];
    let further = simpler.degrees_of_freedom - fit.degrees_of_freedom;
    let ratio = (left - fit.degrees_of_freedom) / further;
    f_tail(ratio, further as usize * fit.n_rows, fit.degrees_of_freedom) < POLES_BY_CHANCE
}
