//! Tests of the trend of a run: coverage of the 95 % region by Monte Carlo, large slopes, sound runs.

use std::f64::consts::TAU;

use frfid_signals::random::{normal, phase, stream};
use ndarray::{Array1, Array2};

use super::*;
use crate::spectra::Transform;
use crate::spectra::line_dft::LineDft;
use crate::testing::refusal;

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

/// AR(1) noise of unit standard deviation, `a` from sample to sample.
fn noise(n: usize, a: f64, seed: u64) -> Array1<f64> {
    let mut rng = stream(seed, "noise", &[]);
    let mut state = normal(&mut rng);
    let innovation = (1.0 - a * a).sqrt();
    Array1::from_shape_fn(n, |_| {
        state = a * state + innovation * normal(&mut rng);
        state
    })
}

/// Of a line's mean over the periods of each run: whether its 95 % region holds the truth, in percent
/// of the runs, on the lowest line and on all.
fn coverage(n_periods: usize, trend: impl Fn(f64) -> f64) -> (f64, f64) {
    let (runs, n) = (300, n_periods as f64);
    let truth = periodic(n_periods, 1);
    let factor = (n - 1.0) * (0.05_f64.powf(-1.0 / (n - 1.0)) - 1.0); // F_95(2, 2 (n - 1))
    let exact = spectra(&truth).row(0).to_owned();
    let mut held = [0.0; LINES.len()];
    for seed in 0..runs {
        let mut run = &truth + &(0.01 * noise(n_periods * N, 0.0, seed));
        for (k, value) in run.iter_mut().enumerate() {
            *value += trend(k as f64 / N as f64);
        }
        if let Some(trend) = found(&run) {
            trend.subtract_from(run.view_mut());
        }
        let spectra = spectra(&run);
        for (line, held) in held.iter_mut().enumerate() {
            let values = spectra.column(line);
            let mean = values.sum() / n;
            let spread: f64 = values.iter().map(|x| (x - mean).norm_sqr()).sum();
            let holds = (mean - exact[line]).norm_sqr() <= factor * spread / (n * (n - 1.0));
            *held += if holds { 100.0 / runs as f64 } else { 0.0 };
        }
    }
    (held[0], held.iter().sum::<f64>() / LINES.len() as f64)
}

fn spectra(run: &Array1<f64>) -> Array2<Complex64> {
    let windows = run.to_shape((run.len() / N, N)).expect("whole");
    let dft = LineDft::new(N, &LINES).expect("sound");
    dft.transform("x", windows.view()).expect("finite")
}

fn found(run: &Array1<f64>) -> Option<Trend> {
    find_trend(run.view(), N as f64, &LINES).expect("sound")
}

/// Steady drift per period, and transients that start at some value, in rms of the signal.
#[test]
fn the_region_of_a_line_holds_once_the_trend_is_off() {
    type Shape = fn(f64) -> f64;
    let trends: [(&str, Shape); 8] = [
        ("none", |_| 0.0),
        ("drift 0.03", |t| 0.03 * t),
        ("drift 0.1", |t| 0.1 * t),
        ("drift 1", |t| t),
        ("tau 2, 0.3", |t| 0.3 * (-t / 2.0).exp()),
        ("tau 5, 1", |t| (-t / 5.0).exp()),
        ("tau 20, 1", |t| (-t / 20.0).exp()),
        ("tau 3, 0.5 and drift 0.1", |t| {
            0.5 * (-t / 3.0).exp() + 0.1 * t
        }),
    ];
    for (name, trend) in trends {
        for n_periods in [5, 10] {
            let (lowest, all) = coverage(n_periods, trend);
            println!("{name}, {n_periods} periods: {lowest:.1} %, all lines {all:.1} %");
            // standard errors 1.3 and 0.5 %
            assert!(
                (92.0..99.0).contains(&lowest) && (93.5..97.0).contains(&all),
                "{name}"
            );
        }
    }
}

#[test]
fn a_sound_run_keeps_every_bit() {
    for n_periods in [2, 3, 5, 20] {
        for seed in 0..100 {
            let run = periodic(n_periods, 3) + 0.01 * noise(n_periods * N, 0.0, seed);
            assert_eq!(found(&run), None);
        }
        assert_eq!(found(&periodic(n_periods, 3)), None, "but for rounding");
        assert_eq!(found(&Array1::zeros(n_periods * N)), None);
    }
    assert_eq!(found(&periodic(1, 1)), None, "one period");
    assert_eq!(found(&Array1::from_elem(3 * N, f64::NAN)), None);
}

/// Noise whose means wander from period to period is hardly ever taken for a trend.
#[test]
fn coloured_noise_is_no_trend() {
    let is_trend = |seed: &u64| found(&(periodic(10, 1) + noise(10 * N, 0.9, *seed))).is_some();
    assert!((0..300).filter(is_trend).count() <= 3);
}

/// 3 rad/s at 1 kHz under a multisine of 0.01 rad, 3e5 times the noise.
#[test]
fn a_large_slope_goes_below_the_noise() {
    let sound = 0.01 * periodic(8, 2) + 1e-5 * noise(8 * N, 0.0, 1);
    let slope = 3e-3;
    let mut run = &sound + &Array1::from_shape_fn(8 * N, |k| 100.0 + slope * k as f64);
    let trend = found(&run).expect("there is one");
    assert!((trend.slope_per_sample / slope - 1.0).abs() < 1e-5 && trend.decay.is_none());
    assert!(
        trend.effect_over_noise > 1e4 && trend.variance_share < 0.02,
        "{trend:?}"
    );
    trend.subtract_from(run.view_mut());
    let difference = spectra(&run) - spectra(&sound);
    // noise of a line: 1e-5 sqrt(64)
    assert!(
        difference.iter().all(|value| value.norm() < 2e-5),
        "{difference}"
    );
}

#[test]
fn holes_and_fractional_periods_are_no_obstacle() {
    let (period, decay) = (64.3, |t: f64| 0.8 * (-t / 300.0).exp());
    let slow = |k: f64| (TAU * k / period).sin() + (TAU * 3.0 * k / period).cos();
    let noise = noise(900, 0.0, 5);
    let run = Array1::from_shape_fn(900, |k| match k {
        200..260 => f64::NAN,
        _ if k % 11 == 3 => f64::NAN,
        _ => slow(k as f64) + decay(k as f64) + 0.02 * noise[k],
    });
    let trend = find_trend(run.view(), period, &[1, 3])
        .expect("sound")
        .expect("a decay");
    let mut left = run.clone();
    trend.subtract_from(left.view_mut());
    let error = Array1::from_shape_fn(900, |k| run[k] - left[k] - decay(k as f64));
    let mean = error.iter().filter(|x| x.is_finite()).sum::<f64>() / 900.0;
    let worst = error
        .iter()
        .filter(|x| x.is_finite())
        .map(|x| (x - mean).abs())
        .fold(0.0, f64::max);
    assert!(worst < 0.03, "{worst}, {trend:?}");
    assert_eq!(
        error.iter().filter(|x| x.is_nan()).count(),
        run.iter().filter(|x| x.is_nan()).count()
    );
}

#[test]
fn bad_periods_are_refused() {
    for period in [f64::NAN, 0.0, 2.0, 200.0, f64::INFINITY, -5.0] {
        let said = refusal(find_trend(periodic(2, 1).view(), period, &[1]));
        assert!(said.starts_with("run has shape [128], needed ("), "{said}");
    }
    let said = refusal(find_trend(periodic(2, 1).view(), 64.0, &[]));
    assert_eq!(said, "lines: none was given, at least one is needed");
}
