//! Wraps of all usual turns, and what jumps for other reasons.

use super::*;
use crate::look::tests::{multisine, quantised};
use frfid_signals::random::{normal, stream};

fn found(samples: &[f64]) -> Option<(f64, usize)> {
    wrapped(&Survey::of(samples).expect("changes"))
}

/// A position in rad at 1 kHz: a multisine of `size` rad on an even turning.
fn position(size: f64, rad_s: f64, noise: f64) -> Vec<f64> {
    let mut rng = stream(7, "position", &[]);
    let motion = multisine(2000, 5, 7);
    let at =
        |(k, x): (usize, &f64)| 0.3 + size * x + 1e-3 * rad_s * k as f64 + noise * normal(&mut rng);
    motion.iter().enumerate().map(at).collect()
}

fn wrap(samples: &[f64], from: f64, turn: f64) -> Vec<f64> {
    let of = |x: &f64| from + (x - from).rem_euclid(turn);
    samples.iter().map(of).collect()
}

#[test]
fn a_turn_is_found_from_the_data_and_taken_out() {
    for (turn, from) in [
        (TAU, 0.0),
        (TAU, -PI),
        (360.0, 0.0),
        (1.0, 0.0),
        (4.56, 1.0),
    ] {
        for rad_s in [3.0, -3.0, 30.0] {
            for noise in [0.0, 1e-5, 1e-3] {
                let true_one: Vec<f64> = position(0.01, rad_s, noise)
                    .iter()
                    .map(|x| x * turn / TAU)
                    .collect();
                let samples = wrap(&true_one, from, turn);
                let (turn_found, jumps) = found(&samples).expect("wraps");
                let error = (turn_found / turn - 1.0).abs();
                assert!(
                    error < 1e-3 && (turn == 4.56 || error < 1e-15),
                    "{turn_found}"
                );
                assert!(jumps >= 4, "{jumps}");
                let cured = unwrapped(ArrayView1::from(&samples), turn);
                let offset = cured[0] - true_one[0];
                let worst = cured
                    .iter()
                    .zip(&true_one)
                    .map(|(a, b)| (a - b - offset).abs());
                assert!(worst.fold(0.0, f64::max) < 1e-9 * turn);
            }
        }
    }
}

#[test]
fn a_joint_that_swings_about_the_end_of_its_range_wraps_both_ways() {
    for noise in [0.0, 1e-4] {
        let (turn, jumps) = found(&wrap(&position(0.05, 0.0, noise), 0.3, TAU)).expect("wraps");
        assert!(turn == TAU && jumps > 10, "{turn} {jumps}");
    }
}

#[test]
fn outliers_hide_no_wrap() {
    let mut samples = wrap(&position(0.01, 3.0, 1e-4), 0.0, TAU);
    for (k, x) in [(1000, 500.0), (4321, -9.0), (7000, 3.5)] {
        samples[k] = x;
    }
    assert_eq!(found(&samples).expect("wraps").0, TAU);
}

#[test]
fn an_encoder_in_counts_wraps_with_its_resolution() {
    for rad_s in [0.7, 5.0, -40.0] {
        let counts: Vec<f64> = position(0.05, rad_s, 0.0)
            .iter()
            .map(|x| x * 4096.0 / TAU)
            .collect();
        let (turn, _) = found(&wrap(&quantised(&counts, 1.0), 0.0, 4096.0)).expect("wraps");
        assert_eq!(turn, 4096.0);
    }
}

#[test]
fn lost_samples_stay_lost_and_the_rest_is_put_right() {
    let true_one = position(0.01, 3.0, 0.0);
    let mut samples = wrap(&true_one, 0.0, TAU);
    for k in [0, 500, 501, 2000] {
        samples[k] = f64::NAN;
    }
    let cured = unwrapped(ArrayView1::from(&samples), TAU);
    let put_right = |(a, b): (&f64, &f64)| a.is_nan() || (a - b).abs() < 1e-9;
    assert!(cured.iter().zip(&true_one).all(put_right));
    assert_eq!(cured.iter().filter(|x| x.is_nan()).count(), 4);
}

#[test]
fn what_jumps_for_other_reasons_does_not_wrap() {
    let mut rng = stream(8, "jumps", &[]);
    let mut noise = |size: f64| size * normal(&mut rng);
    let time = 0..10_000_usize;
    let square = |k: usize| f64::from(u8::from((k / 250).is_multiple_of(2)));
    let saw = |k: usize| (k % 300) as f64 / 300.0;
    let sine = |hz: f64, k: usize| (TAU * hz * 1e-3 * k as f64).sin();
    let position = position(0.05, 0.0, 1e-5);
    let mut dropouts = position.clone();
    for k in (100..10_000).step_by(700) {
        dropouts[k] = 0.0;
    }
    let late: Vec<f64> = time
        .clone()
        .map(|k| {
            if k < 700 {
                0.0
            } else {
                2.0 - 1e-4 * k as f64 + sine(1.0, k) * 1e-3
            }
        })
        .collect();
    for (what, samples) in [
        ("square", time.clone().map(square).collect::<Vec<_>>()),
        (
            "noisy square",
            time.clone().map(|k| square(k) + noise(1e-3)).collect(),
        ),
        (
            "very noisy square",
            time.clone().map(|k| square(k) + noise(0.1)).collect(),
        ),
        (
            "square and sine",
            time.clone()
                .map(|k| square(k) + 0.05 * sine(3.3, k))
                .collect(),
        ),
        ("sawtooth", time.clone().map(saw).collect()),
        (
            "noisy sawtooth",
            time.clone().map(|k| saw(k) + noise(1e-3)).collect(),
        ),
        (
            "clipped sine",
            time.clone()
                .map(|k| sine(7.0, k).clamp(-0.6, 0.6))
                .collect(),
        ),
        ("noise", time.clone().map(|_| noise(1.0)).collect()),
        ("fast sine", time.clone().map(|k| sine(170.0, k)).collect()),
        (
            "faster sine",
            time.clone().map(|k| sine(497.0, k)).collect(),
        ),
        (
            "chirp",
            time.clone()
                .map(|k| sine(499.0 * k as f64 / 20_000.0, k))
                .collect(),
        ),
        ("three values", quantised(&multisine(2000, 5, 9), 3.0)),
        ("step", time.clone().map(|k| f64::from(k > 5000)).collect()),
        (
            "noisy step",
            time.clone()
                .map(|k| f64::from(u8::from(k > 5000)) + noise(1e-4))
                .collect(),
        ),
        ("dropouts", dropouts),
        ("late start", late),
    ] {
        assert_eq!(found(&samples), None, "{what}");
    }
}
