//! Signs of a velocity: the shape of Coulomb friction while a motor slips.

use std::iter::zip;

use ndarray::{Array2, ArrayView1, ArrayView2};

use crate::friction::noise_level::noise_level;

/// Velocities below so many times their noise, and below this share of their rms, have no sign.
const SIGNLESS: [f64; 2] = [5.0, 1e-3];

/// Signs of the velocity, 0 where it is too small to have one or changes it before the next sample.
pub(super) fn clear_signs(y: &[f64]) -> Vec<f64> {
    let least = least_with_sign(y);
    let sign = |y: f64, next: f64| {
        let is_clear = y.abs() >= least && next.abs() >= least && y * next > 0.0;
        if is_clear { y.signum() } else { 0.0 }
    };
    of_pairs(y, sign)
}

/// Signs of velocities `(axis, sample)`, each the mean until the next sample on a straight line to it:
/// `(y_k + y_k+1) / (|y_k| + |y_k+1|)`, 0 where both are too small to have one.
#[must_use]
pub fn mean_signs(velocity_rad_s: ArrayView2<f64>) -> Array2<f64> {
    let mut signs = Array2::zeros(velocity_rad_s.dim());
    for (mut signs, y) in zip(signs.rows_mut(), velocity_rad_s.rows()) {
        signs.assign(&ArrayView1::from(&mean_signs_of(&y.to_vec())));
    }
    signs
}

fn mean_signs_of(y: &[f64]) -> Vec<f64> {
    let least = least_with_sign(y).max(f64::MIN_POSITIVE);
    let sign = |y: f64, next: f64| {
        let is_moving = y.abs().max(next.abs()) >= least;
        let share = (y + next) / (y.abs() + next.abs());
        if is_moving { share } else { 0.0 }
    };
    of_pairs(y, sign)
}

/// A number of each sample and the next, which is 0 behind the last.
fn of_pairs(y: &[f64], number: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let next = y.iter().skip(1).chain(&[0.0]);
    zip(y, next).map(|(y, next)| number(*y, *next)).collect()
}

fn least_with_sign(y: &[f64]) -> f64 {
    let [of_noise, of_rms] = SIGNLESS;
    (of_noise * noise_level(y)).max(of_rms * rms(y))
}

fn rms(y: &[f64]) -> f64 {
    (y.iter().map(|y| y * y).sum::<f64>() / y.len() as f64).sqrt()
}
