//! Tests of the period by another clock: its error, whole clocks, the FRF on fractional windows.

use std::f64::consts::TAU;

use frfid_signals::random::{normal, phase, stream};
use ndarray::{Array1, Array2, Array3, s, stack};

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
fn windows(signal: &Array1<f64>, n: usize) -> Array3<Complex64> {
    let dft = LineDft::new(n, &lines()).expect("sound");
    let window = |q: usize| signal.slice(s![q * n..(q + 1) * n]).insert_axis(Axis(0));
    let spectra: Vec<Array2<Complex64>> = (0..signal.len() / n)
        .map(|q| dft.transform("u", window(q)).expect("finite"))
        .collect();
    let views: Vec<_> = spectra.iter().map(|spectra| spectra.view()).collect();
    stack(Axis(0), &views).expect("alike")
}

/// Periods that are 20 to 250 ppm off a whole number of samples; a whole sample is 500 ppm, so that
/// clocks further off are so for the next whole number.
#[test]
fn fractional_periods_are_found_to_3_ppm() {
    for (seed, ppm) in [(1, 20.0), (2, 100.0), (3, -200.0), (4, 240.0), (5, 720.0)] {
        for (noise, n_periods) in [(0.0, 3), (1e-3, 5), (0.1, 5), (0.1, 10)] {
            let period: f64 = 2000.0 * (1.0 + ppm * 1e-6);
            let n = period.round() as usize;
            let log = log(period, n * n_periods, noise, seed);
            let found = find_clock_ratio(windows(&log.u, n).view(), &lines(), n);
            let found = found.expect("sound").expect("a fraction");
            let error = found.period_samples - period;
            println!("{ppm} ppm, noise {noise}, {n_periods} periods: {found:?}, error {error:e}");
            assert!(
                error.abs() < 3e-6 * period
                    && error.abs() < 3.5 * found.standard_error_samples + 1e-9
            );
        }
    }
}

/// 0.5 % at most.
#[test]
fn whole_clocks_are_left_alone() {
    for (n_periods, n_lines) in [(3, 1), (3, 78), (5, 6), (12, 20)] {
        for noise in [1e-3, 0.1, 0.2, 0.3, 1.0] {
            let mut rng = stream(1, "whole", &[n_periods as u64, n_lines as u64]);
            let alarms = (0..1000).filter(|_| {
                let spectra = Array3::from_shape_fn((n_periods, 1, n_lines), |(_, _, h)| {
                    let noise = noise * Complex64::new(normal(&mut rng), normal(&mut rng));
                    Complex64::cis((h * h) as f64) + noise
                });
                let lines = &lines()[..n_lines];
                let found = find_clock_ratio(spectra.view(), lines, 2000);
                found.expect("sound").is_some()
            });
            let alarms = alarms.count();
            assert!(
                alarms <= 5,
                "{n_periods} periods, {n_lines} lines, {noise}: {alarms}"
            );
        }
    }
}

/// Amplitudes and phases on windows of the true period, against those on whole ones.
#[test]
fn the_frf_is_right_on_fractional_windows() {
    let (period, n, n_periods, noise) = (2000.4, 2000, 6, 1e-3);
    let log = log(period, n * n_periods, noise, 3);
    let ratio = find_clock_ratio(windows(&log.u, n).view(), &lines(), n);
    let ratio = ratio.expect("sound").expect("200 ppm");
    let cycles: Vec<f64> = (0..log.u.len())
        .map(|k| k as f64 / ratio.period_samples)
        .collect();
    let fit = HarmonicFit::new(&cycles, &lines(), ratio.period_samples).expect("sound");
    let signal = stack(Axis(0), &[log.u.view(), log.y.view()]).expect("alike");
    let spectra = fit
        .spectra("x", signal.view())
        .expect("sound")
        .expect("whole");
    let whole = [&log.u, &log.y].map(|signal| windows(signal, n));
    let mut worst = 0.0_f64;
    for (place, line) in lines().into_iter().enumerate() {
        let [u, y] = [0, 1].map(|channel| spectra[[channel, place]]);
        // noise of a line over its amplitude, for u and y, over all periods
        let deviation = noise * (2000.0_f64 / n_periods as f64).sqrt() / u.norm();
        let error = (y / u - plant(line)).norm();
        assert!(
            error < 4.0 * deviation * plant(line).norm().hypot(1.0),
            "line {line}"
        );
        let mean = |x: &Array3<Complex64>| x.slice(s![.., 0, place]).sum();
        let [u, y] = [mean(&whole[0]), mean(&whole[1])];
        worst = worst.max((y / u / plant(line) - 1.0).norm());
    }
    assert!(worst > 0.01, "whole windows are no better: {worst}");
}

#[test]
fn what_does_not_fit_is_refused_and_two_periods_say_nothing() {
    let spectra = Array3::from_elem((2, 1, 3), Complex64::ONE);
    assert_eq!(find_clock_ratio(spectra.view(), &[1, 2, 3], 100), Ok(None));
    let silent = Array3::zeros((5, 1, 3));
    assert_eq!(find_clock_ratio(silent.view(), &[1, 2, 3], 100), Ok(None));
    let said = refusal(find_clock_ratio(spectra.view(), &[1, 2], 100));
    assert!(
        said.starts_with("spectra has shape [2, 1, 3], needed"),
        "{said}"
    );
    let said = refusal(find_clock_ratio(spectra.view(), &[1, 2, 3], 0));
    assert!(said.starts_with("n_samples is 0"), "{said}");
    let bad = spectra.mapv(|_| Complex64::new(f64::NAN, 0.0));
    let said = refusal(find_clock_ratio(bad.view(), &[1, 2, 3], 100));
    assert!(said.starts_with("spectra: 6 samples are NaN"), "{said}");
}
