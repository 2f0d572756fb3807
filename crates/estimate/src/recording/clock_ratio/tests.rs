//! Tests of the period by another clock: its error, whole clocks, the FRF on fractional windows.

use std::f64::consts::{PI, TAU};

use frfid_signals::random::{normal, phase, stream};
use ndarray::{Array1, Array2, s, stack};

use super::*;
use crate::spectra::Transform;
use crate::spectra::harmonic_fit::HarmonicFit;
use crate::spectra::line_dft::LineDft;
use crate::testing::refusal;

/// The 78 odd lines from 2.5 to 79.5 Hz of 2 s, at 1 kHz.
fn lines() -> Vec<usize> {
    (5..=159).step_by(2).collect()
}

/// Multisine of rms 1 with a period of so many samples and its response, a resonance, with noise.
struct Log {
    u: Array1<f64>,
    y: Array1<f64>,
}

/// Two-mass joint of sorts, in lines.
fn plant(line: usize) -> Complex64 {
    let ratio = line as f64 / 40.0;
    Complex64::ONE / Complex64::new(1.0 - ratio * ratio, 0.1 * ratio)
}

fn log(period: f64, n_samples: usize, noise: f64, seed: u64) -> Log {
    let mut rng = stream(seed, "log", &[]);
    let lines = lines();
    let scale = (2.0 / lines.len() as f64).sqrt();
    let phases: Vec<f64> = lines.iter().map(|_| phase(&mut rng)).collect();
    let sum = |k: usize, gain: &dyn Fn(usize) -> Complex64| {
        let term = |(&h, phase): (&usize, &f64)| {
            let turn = (h as f64 * k as f64 / period).fract();
            (gain(h) * Complex64::cis(TAU * turn + phase)).re
        };
        scale * zip(&lines, &phases).map(term).sum::<f64>()
    };
    let u = (0..n_samples).map(|k| sum(k, &|_| Complex64::ONE) + noise * normal(&mut rng));
    let u = u.collect();
    let y = (0..n_samples).map(|k| sum(k, &plant) + noise * normal(&mut rng));
    Log { u, y: y.collect() }
}

/// Spectra of the windows of `n` samples, `(period, channel, line)`.
fn windows(signal: &Array1<f64>, n: usize) -> ndarray::Array3<Complex64> {
    let dft = LineDft::new(n, &lines()).expect("sound");
    let window = |q: usize| signal.slice(s![q * n..(q + 1) * n]).insert_axis(Axis(0));
    let spectra: Vec<Array2<Complex64>> = (0..signal.len() / n)
        .map(|q| dft.transform("u", window(q)).expect("finite"))
        .collect();
    let views: Vec<_> = spectra.iter().map(|spectra| spectra.view()).collect();
    stack(Axis(0), &views).expect("alike")
}

#[test]
fn table() {
    for ppm in [20.0, 100.0, 200.0, -100.0, 240.0] {
        for noise in [0.0, 1e-3, 0.1] {
            for n_periods in [3, 5, 20] {
                let period: f64 = 2000.0 * (1.0 + ppm * 1e-6);
                let n = period.round() as usize;
                let log = log(period, n * n_periods, noise, 1);
                let found =
                    find_clock_ratio(windows(&log.u, n).view(), &lines(), n).expect("sound");
                if let Some(f) = found {
                    println!(
                        "{ppm} noise {noise} Q {n_periods}: error {:.4} ppm, stated {:.4} ppm",
                        (f.period_samples / period - 1.0) * 1e6,
                        f.standard_error_samples / period * 1e6
                    );
                } else {
                    println!("{ppm} {noise} {n_periods} None");
                }
            }
        }
    }
    let _ = (PI, refusal::<(), EstimateError>);
    let _ = HarmonicFit::new(&[0.0], &[1], 10.0);
}
