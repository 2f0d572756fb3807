//! Looks at sound signals, at odd ones as a whole, and at anything that is a number or not.

use std::f64::consts::TAU;
use std::time::Instant;

use frfid_signals::random::{normal, phase, stream, uniform};
use ndarray::{Array1, Array2, ArrayView1, s};

use crate::look::look;
use crate::look::oddity::{Consequence, Oddity};

/// Periods of a multisine of rms 1: odd lines of 5 to 161 of the period, random phases.
pub(super) fn multisine(period: usize, n_periods: usize, seed: u64) -> Vec<f64> {
    let mut rng = stream(seed, "multisine", &[]);
    let lines: Vec<(usize, f64)> = (5..162)
        .step_by(2)
        .map(|line| (line, phase(&mut rng)))
        .collect();
    let scale = (2.0 / lines.len() as f64).sqrt();
    let value = |k: usize| {
        let angle = |line: usize| TAU * (line * k % period) as f64 / period as f64;
        scale
            * lines
                .iter()
                .map(|&(line, phase)| (angle(line) + phase).cos())
                .sum::<f64>()
    };
    let one: Vec<f64> = (0..period).map(value).collect();
    one.repeat(n_periods)
}

/// Rounded to multiples of a step; unchanged for 0.
pub(super) fn quantised(samples: &[f64], step: f64) -> Vec<f64> {
    let round = |x: &f64| {
        if step > 0.0 {
            step * (x / step).round()
        } else {
            *x
        }
    };
    samples.iter().map(round).collect()
}

fn look_at(samples: &[f64]) -> Vec<Oddity> {
    look(ArrayView1::from(samples))
}
