//! Tests of the trend of a run: coverage of the 95 % region by Monte Carlo, large slopes, sound runs.

use std::f64::consts::TAU;

use frfid_signals::random::{normal, phase, stream};
use ndarray::Array1;

use super::*;
use crate::spectra::Transform;
use crate::spectra::line_dft::LineDft;

const N: usize = 64;
const LINES: [usize; 6] = [1, 3, 5, 7, 9, 11];

/// Periodic signal of rms 1 on the lines, N samples to the period.
fn periodic(n_periods: usize, seed: u64) -> Array1<f64> {
    let mut rng = stream(seed, "phases", &[]);
    let phases: Vec<f64> = LINES.iter().map(|_| phase(&mut rng)).collect();
    let value = |k: usize| {
        let term = |(h, phase): (&usize, &f64)| (TAU * (h * k % N) as f64 / N as f64 + phase).cos();
        zip(&LINES, &phases).map(term).sum::<f64>() / 3.0_f64.sqrt()
    };
    Array1::from_shape_fn(n_periods * N, value)
}

/// AR(1) noise of unit standard deviation per sample of its innovation over sqrt(1 - a^2).
fn noise(n: usize, a: f64, seed: u64) -> Array1<f64> {
    let mut rng = stream(seed, "noise", &[]);
    let mut state = normal(&mut rng);
    let innovation = (1.0 - a * a).sqrt();
    Array1::from_shape_fn(n, |_| {
        state = a * state + innovation * normal(&mut rng);
        state
    })
}

struct Coverage {
    low: f64,
    all: f64,
    found: f64,
    share: f64,
    kinds: [usize; 4],
}

/// Share of runs whose 95 % region of a line's mean holds the truth.
fn coverage(
    n_periods: usize,
    runs: u64,
    sigma: f64,
    a: f64,
    trend: impl Fn(f64) -> f64,
    remove: bool,
) -> Coverage {
    let dft = LineDft::new(N, &LINES).expect("sound");
    let (mut low, mut all, mut found, mut share) = (0.0, 0.0, 0.0, 0.0_f64);
    let mut kinds = [0; 4];
    let truth = periodic(n_periods, 1);
    let n = n_periods as f64;
    let dof = n - 1.0;
    let factor = dof * (0.05_f64.powf(-1.0 / dof) - 1.0);
    let spectra = |x: &Array1<f64>| {
        let windows = x.to_shape((n_periods, N)).expect("whole").into_owned();
        dft.transform("x", windows.view()).expect("finite")
    };
    let exact = spectra(&truth).row(0).to_owned();
    for seed in 0..runs {
        let mut x = &truth + &(sigma * noise(n_periods * N, a, seed));
        for (k, value) in x.iter_mut().enumerate() {
            *value += trend(k as f64 / N as f64);
        }
        if remove && let Some(trend) = find_trend(x.view(), N as f64, &LINES).expect("sound") {
            found += 1.0;
            share += trend.variance_share;
            kinds[usize::from(trend.slope_per_sample != 0.0)
                + 2 * usize::from(trend.decay.is_some())] += 1;
            trend.subtract_from(x.view_mut());
        }
        let spectra = spectra(&x);
        let mean = spectra.mean_axis(Axis(0)).expect("periods");
        for (line, (mean, exact)) in zip(&mean, &exact).enumerate() {
            let spread: f64 = spectra
                .column(line)
                .iter()
                .map(|x| (x - mean).norm_sqr())
                .sum();
            let holds = (mean - exact).norm_sqr() <= factor * spread / (n * dof);
            let holds = if holds { 100.0 / runs as f64 } else { 0.0 };
            all += holds / 6.0;
            if line == 0 {
                low += holds;
            }
        }
    }
    Coverage {
        low,
        all,
        share: share / found,
        found: 100.0 * found / runs as f64,
        kinds,
    }
}

#[test]
#[ignore = "table"]
fn table() {
    let runs = 1000;
    for n_periods in [2, 3, 4, 5, 10] {
        let show = |name: String, c: Coverage| {
            println!(
                "Q {n_periods:2} {name:24} line 1 {:5.1} all {:5.1} found {:5.1} share {:.3} {:?}",
                c.low, c.all, c.found, c.share, c.kinds
            )
        };
        for sigma in [0.01, 0.1] {
            for drift in [0.0, 0.001, 0.003, 0.03, 0.1, 1.0] {
                show(
                    format!("sigma {sigma} drift {drift}"),
                    coverage(n_periods, runs, sigma, 0.0, |t| drift * t, true),
                );
            }
            for tau in [2.0, 5.0, 20.0] {
                for start in [0.3, 1.0] {
                    show(
                        format!("sigma {sigma} tau {tau} {start}"),
                        coverage(
                            n_periods,
                            runs,
                            sigma,
                            0.0,
                            |t| start * (-t / tau).exp(),
                            true,
                        ),
                    );
                }
            }
            show(
                format!("sigma {sigma} tau 3 + drift"),
                coverage(
                    n_periods,
                    runs,
                    sigma,
                    0.0,
                    |t| 0.5 * (-t / 3.0).exp() + 0.1 * t,
                    true,
                ),
            );
        }
        for a in [0.9, 0.99, 0.999] {
            show(
                format!("AR {a} untouched"),
                coverage(n_periods, runs, 0.1, a, |_| 0.0, false),
            );
            show(
                format!("AR {a}"),
                coverage(n_periods, runs, 0.1, a, |_| 0.0, true),
            );
            show(
                format!("AR {a} drift .3"),
                coverage(n_periods, runs, 0.1, a, |t| 0.3 * t, true),
            );
        }
    }
}
