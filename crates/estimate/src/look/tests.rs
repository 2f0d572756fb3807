//! Looks at sound signals, at odd ones as a whole, and at anything that is a number or not.

use std::f64::consts::TAU;
use std::time::Instant;

use frfid_signals::random::{normal, phase, stream, uniform};
use ndarray::{Array2, ArrayView1};

use crate::look::look;
use crate::look::oddity::{Consequence, Oddity};
use crate::look::wrapped::unwrapped;

/// Periods of a multisine of rms 1: odd lines of 5 to 161 of the period, random phases.
pub(super) fn multisine(period: usize, n_periods: usize, seed: u64) -> Vec<f64> {
    let lines: Vec<usize> = (5..162).step_by(2).collect();
    multisine_of(&lines, period, n_periods, seed)
}

fn multisine_of(lines: &[usize], period: usize, n_periods: usize, seed: u64) -> Vec<f64> {
    let mut rng = stream(seed, "multisine", &[]);
    let phases: Vec<f64> = lines.iter().map(|_| phase(&mut rng)).collect();
    let scale = (2.0 / lines.len() as f64).sqrt();
    let value = |k: usize| {
        let angle = |line: usize| TAU * (line * k % period) as f64 / period as f64;
        let terms = lines.iter().zip(&phases);
        let sum: f64 = terms
            .map(|(&line, phase)| (angle(line) + phase).cos())
            .sum();
        scale * sum
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

/// One of several numbers or things by chance.
fn one_of<T: Clone>(all: &[T], rng: &mut impl FnMut() -> f64) -> T {
    all[(rng() * all.len() as f64) as usize].clone()
}

/// An excitation of rms about 1 for 10 to 20 s at 1 kHz.
fn excitation(seed: u64, rng: &mut impl FnMut() -> f64) -> Vec<f64> {
    let chirp = |duration: usize, at: fn(f64) -> f64, fade: f64| {
        let mut angle = 0.0;
        let value = |k: usize| {
            let time = k as f64 / duration as f64;
            angle += TAU * 1e-3 * at(time);
            (time / fade).min(1.0).min((1.0 - time) / fade) * 1.4 * f64::sin(angle)
        };
        (0..duration).map(value).collect()
    };
    match (6.0 * rng()) as u32 {
        0 => multisine(2000, 5, seed),
        1 => multisine_of(&(1..400).collect::<Vec<_>>(), 1000, 10, seed),
        2 => multisine_of(&[1, 3, 7, 17, 43, 109, 277, 701], 5000, 3, seed),
        3 => multisine_of(&[1 + (300.0 * rng()) as usize], 4096, 4, seed),
        4 => chirp(20_000, |time| 0.5 * 120.0_f64.powf(time), 0.02),
        _ => chirp(15_000, |time| 0.1 + 400.0 * time, 1e-9),
    }
}

/// A resonance as response, scaled to an rms of 1.
fn response(input: &[f64]) -> Vec<f64> {
    let (mut before, mut last) = (0.0, 0.0);
    let next = |u: &f64| {
        let y = 1.96 * last - 0.97 * before + u;
        (before, last) = (last, y);
        y
    };
    let output: Vec<f64> = input.iter().map(next).collect();
    let square: f64 = output.iter().map(|y| y * y).sum();
    let rms = (square / output.len() as f64).sqrt();
    output.iter().map(|y| y / rms).collect()
}

/// The position in rad of a velocity in rad/s, at 1 kHz.
fn integrated(velocity: &[f64]) -> Vec<f64> {
    let add = |q: &mut f64, v: &f64| {
        *q += 1e-3 * v;
        Some(*q)
    };
    velocity.iter().scan(0.0, add).collect()
}

/// A signal of a sound campaign: torque, velocity or position, with noise, in steps, with rests.
fn sound(seed: u64) -> (String, Vec<f64>) {
    let mut source = stream(seed, "sound", &[]);
    let mut rng = || uniform(&mut source);
    let torque = excitation(seed, &mut rng);
    let velocity = response(&torque);
    let kind = one_of(
        &[
            "torque",
            "velocity",
            "on a velocity",
            "position",
            "drifting",
            "encoder",
        ],
        &mut rng,
    );
    let mut samples = match kind {
        "torque" => torque,
        "velocity" => velocity,
        "on a velocity" => velocity.iter().map(|v| v - 5.0).collect(),
        "position" => integrated(&velocity),
        "drifting" => integrated(&velocity.iter().map(|v| v + 0.05).collect::<Vec<_>>()),
        _ => {
            let counts = quantised(&integrated(&velocity), TAU / 2.0_f64.powi(20));
            counts.windows(2).map(|q| (q[1] - q[0]) * 1e3).collect()
        }
    };
    let peak = samples.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let size = 0.3 * peak * one_of(&[0.0, 0.0, 1e-3, 0.03, 0.3], &mut rng);
    let mut noise = stream(seed, "noise", &[]);
    samples
        .iter_mut()
        .for_each(|x| *x += size * normal(&mut noise));
    let bits = one_of(&[0, 12, 16], &mut rng);
    if bits > 0 {
        let full_scale = peak * (1.5 + 5.0 * rng());
        samples = quantised(&samples, 2.0 * full_scale / 2.0_f64.powi(bits));
    }
    let rests = [0, 1].map(|_| one_of(&[0, 10, 3000, 40_000], &mut rng));
    samples = [vec![0.0; rests[0]], samples, vec![0.0; rests[1]]].concat();
    (
        format!("{seed}: {kind}, noise {size:.1e}, {bits} bits, rests {rests:?}"),
        samples,
    )
}

#[test]
fn sound_signals_are_sound() {
    for seed in 0..400 {
        let (what, samples) = sound(seed);
        let found = look_at(&samples);
        assert!(found.is_empty(), "{what}: {found:?}");
    }
}

#[test]
fn a_sound_session_of_several_runs_and_rests_is_sound() {
    for seed in 400..500 {
        let runs: Vec<Vec<f64>> = (0..3).map(|run| sound(1000 * seed + run).1).collect();
        let found = look_at(&runs.concat());
        assert!(found.is_empty(), "{seed}: {found:?}");
    }
}

#[test]
fn what_never_changes_is_refused() {
    for value in [0.0, -3.7, 1e300] {
        let found = look_at(&vec![value; 500]);
        assert_eq!(found, [Oddity::Constant { value }]);
        assert_eq!(found[0].consequence(), Consequence::Refused);
    }
    let nothing = look_at(&[f64::NAN; 5]);
    assert_eq!(nothing, [Oddity::Lost { share: 1.0 }]);
    assert_eq!(nothing[0].consequence(), Consequence::Refused);
    assert!(look_at(&[]).is_empty() && look_at(&[1.0]).is_empty());
}

#[test]
fn the_most_serious_comes_first() {
    let mut samples = multisine(2000, 5, 16);
    samples.iter_mut().for_each(|x| *x = x.clamp(-1.0, 1.0));
    samples[5000] = 6.0;
    samples[6000] = f64::NAN;
    let found = look_at(&samples);
    let consequences: Vec<Consequence> = found.iter().map(Oddity::consequence).collect();
    assert!(consequences.is_sorted_by(|a, b| a >= b), "{found:?}");
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(matches!(found[0], Oddity::Saturated { .. }), "{found:?}");
}

#[test]
fn a_strided_channel_is_looked_at_like_any_other() {
    let samples: Vec<f64> = quantised(&multisine(2000, 5, 17), 3.0);
    let both = Array2::from_shape_fn((samples.len(), 2), |(k, channel)| {
        samples[k] * (channel as f64 + 0.5)
    });
    let (a, b) = (look(both.column(1)), look_at(&samples));
    assert!(matches!(
        (&a[..], &b[..]),
        ([Oddity::FewValues { .. }], [Oddity::FewValues { .. }])
    ));
}

#[test]
fn any_numbers_can_be_looked_at() {
    let special = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MAX,
        f64::MIN,
        f64::MIN_POSITIVE,
        5e-324,
        f64::EPSILON,
        TAU,
    ];
    for seed in 0..3000 {
        let mut source = stream(seed, "any", &[]);
        let mut rng = || uniform(&mut source);
        let length = one_of(&[0, 1, 2, 3, 4, 5, 7, 17, 130, 700], &mut rng);
        let choice = (5.0 * rng()) as u32;
        let mut before = 0.0;
        let value = |_| {
            let number = match choice {
                0 => one_of(&special, &mut rng),
                1 => f64::from_bits((rng() * 2.0_f64.powi(53)) as u64 * 2048 + 7),
                2 => one_of(&[before, before + 1.0, rng() - 0.5], &mut rng),
                3 => (before + 0.3) % 1.0,
                _ if rng() < 0.1 => one_of(&special, &mut rng),
                _ => rng(),
            };
            before = if number.is_finite() { number } else { before };
            number
        };
        let samples: Vec<f64> = (0..length).map(value).collect();
        for oddity in look_at(&samples) {
            assert!(!oddity.found().is_empty() && oddity.consequence() >= Consequence::Told);
        }
        for turn in special {
            assert_eq!(unwrapped(ArrayView1::from(&samples), turn).len(), length);
        }
    }
}

/// `cargo test --release -p frfid-estimate --lib look -- --ignored --nocapture`
#[test]
#[ignore = "measures time"]
fn time_for_two_million_samples() {
    let mut rng = stream(18, "time", &[]);
    let noise: Vec<f64> = (0..2_000_000).map(|_| normal(&mut rng)).collect();
    let smooth = multisine(2000, 1000, 18);
    let turning: Vec<f64> = smooth
        .iter()
        .enumerate()
        .map(|(k, x)| (0.01 * x + 3e-3 * k as f64) % TAU)
        .collect();
    for (what, samples) in [
        ("held", (0..2_000_000).map(|k| smooth[k / 10]).collect()),
        ("coarse", quantised(&smooth, 0.3)),
        ("12 bits", quantised(&smooth, 0.002)),
        ("ramp", (0..2_000_000).map(f64::from).collect()),
        ("noise", noise),
        ("turning", turning),
        ("smooth", smooth),
    ] {
        let start = Instant::now();
        let found = look_at(&samples);
        println!(
            "{what}: {:.1} ms, {found:?}",
            1e3 * start.elapsed().as_secs_f64()
        );
    }
}
