//! Harmonic FRFs of one input and one output, by the phase of the input's fundamental.

use frfid_signals::Amplitudes;
use ndarray::Array2;
use num_complex::Complex64;

use crate::harmonics::{Found, ORDERS, UNKNOWN};

/// Share of the fundamental below which a harmonic of the input is none.
const NONE: f64 = 1e-6;
const U: usize = 0;
const Y: usize = 1;

/// `H_n(f)`, `(order, frequency)`; NaN where the output's harmonic is not told, or what the input's adds to it.
pub(super) fn response(found: &Found, told: &Amplitudes) -> Array2<Complex64> {
    let (_, n_orders, n_frequencies) = found.value.dim();
    Array2::from_shape_fn((n_orders, n_frequencies), |(order, frequency)| {
        let value = |channel: usize| found.value[[channel, order, frequency]];
        let fundamental = found.value[[U, 0, frequency]];
        let is_told = !told.amplitude[[Y, order, frequency]].is_nan();
        let added = match ORDERS[order] {
            1 => value(Y),
            _ => value(Y) - passed_on(found, told, [order, frequency]),
        };
        let turn = Complex64::cis(-fundamental.arg() * (ORDERS[order] as f64 - 1.0));
        if is_told {
            added / fundamental * turn
        } else {
            UNKNOWN
        }
    })
}

/// `G(n f) U_n(f)`: what the output has of the input's harmonic.
fn passed_on(found: &Found, told: &Amplitudes, [order, frequency]: [usize; 2]) -> Complex64 {
    let harmonic = found.value[[U, order, frequency]];
    let least = NONE * found.value[[U, 0, frequency]].norm();
    let is_none = harmonic.norm() <= least.max(told.floor[[U, order, frequency]]);
    let [u, y] = [U, Y].map(|channel| found.fundamental[[channel, order, frequency]]);
    let passed_on = y / u * harmonic;
    if passed_on.is_nan() && is_none {
        Complex64::ZERO
    } else {
        passed_on
    }
}
