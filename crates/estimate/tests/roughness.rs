//! Scatter from line to line: told where one draw hides its distortion, never where a curve is
//! merely curved.

use std::f64::consts::TAU;

use frfid_estimate::{FrfOptions, Roughness, estimate_bla, roughness};
use frfid_signals::random::{normal, phase, stream, uniform};
use frfid_signals::{Frf, Uncertainty};
use ndarray::{Array3, Array5};
use num_complex::Complex64;

/// Torque to motor velocity of a two-mass joint: resonance in Hz, its damping ratio, motor and link
/// inertia, viscous friction over motor inertia in 1/s, delay in s.
struct Joint {
    resonance_hz: f64,
    damping: f64,
    inertias: [f64; 2],
    friction: f64,
    delay_s: f64,
}

impl Joint {
    fn response(&self, hz: f64) -> Complex64 {
        let [motor, link] = self.inertias;
        let (reduced, w) = (motor * link / (motor + link), TAU * self.resonance_hz);
        let (stiffness, damping) = (reduced * w * w, 2.0 * self.damping * reduced * w);
        let s = Complex64::new(0.0, TAU * hz);
        let spring = damping * s + stiffness;
        let load = link * s * s + spring;
        let free = s * (motor * link * s * s + (motor + link) * spring);
        load / (free + self.friction * motor * load) * (-s * self.delay_s).exp()
    }
}

fn joint(damping: f64) -> Joint {
    Joint {
        resonance_hz: 13.4,
        damping,
        inertias: [0.011, 0.02],
        friction: 0.0,
        delay_s: 0.0,
    }
}

/// An FRF with relative noise, its variance known with `freedom` degrees, and relative scatter.
fn frf(
    joint: &Joint,
    hz: &[f64],
    noise: f64,
    scatter: f64,
    freedom: usize,
    chance: &mut dyn FnMut() -> f64,
) -> Frf {
    let mut complex = || Complex64::new(chance(), chance()) / 2f64.sqrt();
    let truth: Vec<Complex64> = hz.iter().map(|&hz| joint.response(hz)).collect();
    let response = Array3::from_shape_fn((hz.len(), 1, 1), |(k, ..)| {
        truth[k] * (1.0 + scatter * complex() + noise * complex())
    });
    let covariance = Array3::from_shape_fn((hz.len(), 1, 1), |(k, ..)| {
        let known = (0..freedom).map(|_| complex().norm_sqr()).sum::<f64>() / freedom as f64;
        Complex64::from(truth[k].norm_sqr() * noise * noise * known)
    });
    Frf {
        frequency_hz: hz.to_vec(),
        response,
        noise: Some(Uncertainty {
            covariance,
            degrees_of_freedom: freedom as f64,
        }),
        total: None,
        condition: None,
        relative_resolution: None,
    }
}

fn exceeds(frf: &Frf) -> bool {
    roughness(frf)
        .as_ref()
        .is_some_and(Roughness::exceeds_noise)
}

fn linear(n: usize, step_hz: f64) -> Vec<f64> {
    (0..n).map(|k| 2.5 + step_hz * k as f64).collect()
}

fn logarithmic(n: usize) -> Vec<f64> {
    (0..n)
        .map(|k| 60f64.powf(k as f64 / (n - 1) as f64))
        .collect()
}

/// 500 random joints on random lines with noise of 1e-6 to 0.1, or none: one false alarm at most;
/// with scatter of ten times the noise nearly all are found.
#[test]
fn linear_machines_are_not_called_distorted_and_scatter_is_found() {
    let mut rng = stream(1, "joints", &[]);
    let (mut false_alarms, mut found, mut asked) = (0, 0, 0);
    for round in 0..500 {
        let mut draw = |low: f64, high: f64| low * (high / low).powf(uniform(&mut rng));
        let motor = draw(1e-3, 1.0);
        let joint = Joint {
            resonance_hz: draw(2.0, 100.0),
            damping: draw(1e-3, 0.2),
            inertias: [motor, motor * draw(0.1, 16.0)],
            friction: if round % 2 == 0 { 0.0 } else { draw(0.1, 30.0) },
            delay_s: if round % 3 == 0 {
                0.0
            } else {
                draw(1e-4, 4e-3)
            },
        };
        let noise = if round % 5 == 0 { 0.0 } else { draw(1e-6, 0.1) };
        let (n_lines, step_hz) = (draw(12.0, 120.0) as usize, draw(0.2, 2.0));
        let freedom = draw(1.0, 20.0) as usize;
        let hz = match round % 4 {
            0 => logarithmic(n_lines.max(16)),
            _ => linear(n_lines, step_hz),
        };
        let mut chance = || normal(&mut rng);
        let smooth = frf(&joint, &hz, noise, 0.0, freedom, &mut chance);
        false_alarms += usize::from(exceeds(&smooth));
        if n_lines >= 30 && noise < 0.02 {
            asked += 1;
            let scatter = (10.0 * noise).max(0.05);
            found += usize::from(exceeds(&frf(
                &joint,
                &hz,
                noise,
                scatter,
                freedom,
                &mut chance,
            )));
        }
    }
    println!("{false_alarms} false alarms of 500, {found} of {asked} found");
    assert!(false_alarms <= 1, "{false_alarms}");
    assert!(found as f64 > 0.9 * asked as f64, "{found} of {asked}");
}

/// Sharp resonances with few lines across, and no noise at all.
#[test]
fn resonances_are_no_scatter() {
    let mut rng = stream(2, "resonances", &[]);
    for damping in [0.1, 0.02, 0.005, 0.001] {
        for hz in [
            linear(78, 1.0),
            linear(300, 0.03),
            linear(40, 4.0),
            logarithmic(71),
        ] {
            for noise in [0.0, 1e-4, 1e-2] {
                let mut chance = || normal(&mut rng);
                let smooth = frf(&joint(damping), &hz, noise, 0.0, 4, &mut chance);
                assert!(
                    !exceeds(&smooth),
                    "{damping} {} {noise} {:?}",
                    hz.len(),
                    roughness(&smooth)
                );
            }
        }
    }
}

#[test]
fn the_scatter_is_measured() {
    let mut rng = stream(3, "scatter", &[]);
    let rough = frf(&joint(0.05), &linear(150, 0.5), 1e-3, 0.08, 10, &mut || {
        normal(&mut rng)
    });
    let found = roughness(&rough).expect("many lines");
    assert!((found.relative / 0.08 - 1.0).abs() < 0.3, "{found:?}");
    assert!((found.over_noise / 80.0 - 1.0).abs() < 0.4, "{found:?}");
    let words = found.warning().expect("80 times the noise");
    assert!(
        words.starts_with("distortion not measured: from line to line"),
        "{words}"
    );
    let few = frf(&joint(0.05), &linear(11, 0.5), 1e-3, 0.08, 10, &mut || {
        normal(&mut rng)
    });
    assert_eq!(roughness(&few), None);
    assert_eq!(
        roughness(&Frf {
            noise: None,
            ..rough.clone()
        }),
        None
    );
    let mut gaps = rough;
    for k in (0..150).step_by(3) {
        gaps.response[[k, 0, 0]] = Complex64::new(f64::NAN, f64::NAN);
    }
    let found = roughness(&gaps).expect("100 lines are left");
    assert!((found.relative / 0.08 - 1.0).abs() < 0.35, "{found:?}");
}

const N: usize = 2000;

/// A random-phase multisine, three periods, and what a joint with a cubic part in its velocity makes
/// of it, with noise of 0.2 %.
fn cubic_record(lines: &[usize], cubic: f64, seed: u64) -> [Array5<f64>; 2] {
    let mut rng = stream(seed, "cubic", &[]);
    let phases: Vec<f64> = lines.iter().map(|_| phase(&mut rng)).collect();
    let signal = |gain: &dyn Fn(usize) -> Complex64, k: usize| -> f64 {
        let term = |(&line, &phase): (&usize, &f64)| {
            let angle = TAU * (line * k % N) as f64 / N as f64 + phase;
            (gain(line) * Complex64::cis(angle)).re
        };
        lines.iter().zip(&phases).map(term).sum()
    };
    let response = |line: usize| joint(0.03).response(0.5 * line as f64);
    let u: Vec<f64> = (0..N).map(|k| signal(&|_| Complex64::ONE, k)).collect();
    let y: Vec<f64> = (0..N).map(|k| signal(&response, k)).collect();
    let rms = (y.iter().map(|y| y * y).sum::<f64>() / N as f64).sqrt();
    let output = |k: usize| y[k] + cubic * rms * (y[k] / rms).powi(3);
    let shape = (1, 1, 3, 1, N);
    [
        Array5::from_shape_fn(shape, |(.., k)| u[k]),
        Array5::from_shape_fn(shape, |(.., k)| output(k) + 2e-3 * rms * normal(&mut rng)),
    ]
}

/// One draw knows the noise alone; its scatter is that from draw to draw.
#[test]
fn cubic_distortion_in_one_draw_is_told() {
    let lines: Vec<usize> = (5..161).step_by(2).collect();
    let estimate = |cubic: f64, seed: u64| {
        let [u, y] = cubic_record(&lines, cubic, seed);
        let options = FrfOptions::default();
        estimate_bla(u.view(), y.view(), None, 1e-3, &lines, &options).expect("sound")
    };
    let draws: Vec<Frf> = (0..6).map(|seed| estimate(0.15, seed)).collect();
    let mut spreads: Vec<f64> = (0..lines.len())
        .map(|k| {
            let values: Vec<Complex64> = draws.iter().map(|frf| frf.response[[k, 0, 0]]).collect();
            let mean = values.iter().sum::<Complex64>() / 6.0;
            let squares = values.iter().map(|value| (value - mean).norm_sqr());
            (squares.sum::<f64>() / 5.0).sqrt() / mean.norm()
        })
        .collect();
    spreads.sort_by(f64::total_cmp);
    let spread = spreads[lines.len() / 2];
    for frf in &draws {
        let found = roughness(frf).expect("78 lines");
        assert!(
            found.exceeds_noise() && found.over_noise > 100.0,
            "{found:?}"
        );
        assert!(
            (found.relative / spread).ln().abs() < 0.4,
            "{found:?} for {spread}"
        );
    }
    assert!((0..6).all(|seed| !exceeds(&estimate(0.0, seed))));
}
