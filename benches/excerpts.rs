//! FRF of a 3x3 machine from chirps by excerpts: `estimate_chirp`.

mod paper;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use frfid::estimate::{FrfOptions, estimate_chirp};
use frfid::plant::{Hold, Robot as _, SingleJoint, Torque, simulate};
use frfid::signals::{Chirp, Frf, Phasing, Profile};
use ndarray::{Array4, Axis, s};
use num_complex::Complex64;
use paper::SAMPLE_TIME_S;

const AXES: usize = 3;
/// Gains from joint to output: a machine of three equal joints whose outputs are coupled.
const COUPLING: [[f64; AXES]; AXES] = [[1.0, 0.2, -0.1], [0.3, 0.8, 0.1], [-0.2, 0.4, 0.5]];

fn chirp() -> Chirp {
    let amplitude = vec![Profile::constant(150.0)];
    Chirp {
        low_hz: 1.0,
        high_hz: 60.0,
        duration_s: 20.0,
        amplitude,
        fade_s: 0.0,
        tail_s: 0.0,
    }
}

/// Inputs and outputs, `(repeat, experiment, channel, sample)`.
fn recording() -> (Array4<f64>, Array4<f64>) {
    let u = chirp()
        .sample(SAMPLE_TIME_S, AXES, Phasing::SignFlip)
        .expect("sound");
    let mut y = Array4::zeros((1, AXES, AXES, u.len_of(Axis(2))));
    for experiment in 0..AXES {
        for input in 0..AXES {
            let torque = u.slice(s![experiment, input..=input, ..]);
            let motion = simulate(
                &SingleJoint::default(),
                Torque::Zoh(torque),
                SAMPLE_TIME_S,
                0.0,
                None,
            );
            let velocity = motion.expect("sound").motor_velocity_rad_s;
            for (output, gains) in COUPLING.iter().enumerate() {
                let mut row = y.slice_mut(s![0, experiment, output..=output, ..]);
                row.scaled_add(gains[input], &velocity);
            }
        }
    }
    (u.insert_axis(Axis(0)), y)
}

/// The known bias of the paper's estimator on its own example (median 0.02 dB and 1.1 deg, at worst
/// 1.7 dB and 14 deg) and nothing beyond it; a shift by one sample alone would turn the median by 3
/// deg.
fn assert_right(frf: &Frf) {
    let truth = SingleJoint::default()
        .frf(&frf.frequency_hz, Hold::Zoh, SAMPLE_TIME_S)
        .expect("sound");
    let ratio = |((line, output, input), value): ((usize, usize, usize), &Complex64)| {
        value / truth.response[[line, 0, 0]] / COUPLING[output][input]
    };
    let median_and_worst = |error: &dyn Fn(Complex64) -> f64| {
        let mut errors: Vec<f64> = frf
            .response
            .indexed_iter()
            .map(|entry| error(ratio(entry)).abs())
            .collect();
        errors.sort_by(f64::total_cmp);
        (errors[errors.len() / 2], errors[errors.len() - 1])
    };
    let (median, worst) = median_and_worst(&|ratio| 20.0 * ratio.norm().log10());
    assert!(
        median < 0.05 && worst < 2.0,
        "median {median} dB, worst {worst} dB"
    );
    let (median, worst) = median_and_worst(&|ratio| ratio.arg().to_degrees());
    assert!(
        median < 1.5 && worst < 15.0,
        "median {median} deg, worst {worst} deg"
    );
}

fn estimate(criterion: &mut Criterion) {
    let (chirp, (u, y), options) = (chirp(), recording(), FrfOptions::default());
    let hz: Vec<f64> = (0..80)
        .map(|k| 1.3 * (55.0_f64 / 1.3).powf(f64::from(k) / 79.0))
        .collect();
    let run = || {
        let (u, y) = (black_box(u.view()), y.view());
        estimate_chirp(u, y, None, &chirp, SAMPLE_TIME_S, &hz, 0.0, &options).expect("sound")
    };
    assert_right(&run());
    let mut group = criterion.benchmark_group("estimate_chirp");
    group.bench_function("3x3, chirps of 20 s, 80 frequencies", |bencher| {
        bencher.iter(run);
    });
    group.finish();
}

criterion_group! { name = benches; config = paper::criterion(); targets = estimate }
criterion_main!(benches);
