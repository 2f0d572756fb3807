//! FRF of a 3x3 machine from chirps by excerpts: `estimate_chirp`, beside a plain loop over the excerpts.

mod paper;

use std::f64::consts::TAU;
use std::hint::black_box;
use std::iter::zip;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use frfid::estimate::{FrfOptions, estimate_chirp};
use frfid::plant::{Hold, Robot as _, SingleJoint, Torque, simulate};
use frfid::signals::{Chirp, Frf, Phasing, Profile};
use ndarray::{Array4, ArrayView4, Axis, s};
use num_complex::Complex64;

const AXES: usize = 3;
/// Numbers that the plain loop sums side by side.
const LANES: usize = 8;
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
fn recording(sample_time_s: f64) -> (Array4<f64>, Array4<f64>) {
    let u = chirp()
        .sample(sample_time_s, AXES, Phasing::SignFlip)
        .expect("sound");
    let mut y = Array4::zeros((1, AXES, AXES, u.len_of(Axis(2))));
    for experiment in 0..AXES {
        for input in 0..AXES {
            let torque = u.slice(s![experiment, input..=input, ..]);
            let motion = simulate(
                &SingleJoint::default(),
                Torque::Zoh(torque),
                sample_time_s,
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
fn assert_right(frf: &Frf, sample_time_s: f64) {
    let truth = SingleJoint::default()
        .frf(&frf.frequency_hz, Hold::Zoh, sample_time_s)
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

/// Samples of the excerpt of a frequency, four periods around the instant at which the chirp passes it.
fn excerpt(hz: f64, sample_time_s: f64) -> std::ops::Range<usize> {
    let (instant_s, half_s) = (chirp().instant_of(hz), 2.0 / hz);
    let [low_s, high_s] = [instant_s - half_s, instant_s + half_s];
    let last = (high_s.min(20.0) / sample_time_s) as usize;
    (low_s.max(0.0) / sample_time_s) as usize..last
}

/// The limit: of every excerpt a windowed exponential, made once, correlated with every channel; no low-pass, no mean,
/// no FRF.
fn plain_loop(signals: [ArrayView4<f64>; 2], hz: &[f64], sample_time_s: f64) -> Complex64 {
    let mut total = Complex64::ZERO;
    for &hz in hz {
        let excerpt = excerpt(hz, sample_time_s);
        let n = excerpt.len();
        let step = Complex64::cis(-TAU * hz * sample_time_s);
        let window = Complex64::cis(TAU / n as f64);
        let (mut turn, mut place) = (Complex64::ONE, Complex64::ONE);
        let weights = (0..n).map(|_| {
            let weight = turn * (0.5 - 0.5 * place.re);
            (turn, place) = (turn * step, place * window);
            (weight.re, weight.im)
        });
        let (re, im): (Vec<f64>, Vec<f64>) = weights.unzip();
        for signal in &signals {
            for channel in signal.lanes(Axis(3)) {
                let samples = &channel.to_slice().expect("standard layout")[excerpt.clone()];
                total += correlated(&re, &im, samples);
            }
        }
    }
    total
}

fn correlated(re: &[f64], im: &[f64], samples: &[f64]) -> Complex64 {
    let (mut sums_re, mut sums_im) = ([0.0; LANES], [0.0; LANES]);
    let [re, im, samples] = [re, im, samples].map(|part| part.chunks_exact(LANES));
    for ((re, im), samples) in zip(zip(re, im), samples) {
        for k in 0..LANES {
            sums_re[k] += re[k] * samples[k];
            sums_im[k] += im[k] * samples[k];
        }
    }
    Complex64::new(sums_re.iter().sum(), sums_im.iter().sum())
}

fn estimate(criterion: &mut Criterion) {
    let (chirp, options) = (chirp(), FrfOptions::default());
    let hz: Vec<f64> = (0..80)
        .map(|k| 1.3 * (55.0_f64 / 1.3).powf(f64::from(k) / 79.0))
        .collect();
    let mut group = criterion.benchmark_group("estimate_chirp");
    for (rate, sample_time_s) in [("1 kHz", 1e-3), ("10 kHz", 1e-4)] {
        let (u, y) = recording(sample_time_s);
        let n_samples: usize = hz.iter().map(|&hz| excerpt(hz, sample_time_s).len()).sum();
        group.throughput(Throughput::Elements((2 * AXES * AXES * n_samples) as u64));
        let run = || {
            let (u, y) = (black_box(u.view()), y.view());
            estimate_chirp(u, y, None, &chirp, sample_time_s, &hz, 0.0, &options).expect("sound")
        };
        assert_right(&run(), sample_time_s);
        group.bench_function(
            format!("3x3, chirps of 20 s at {rate}, 80 frequencies"),
            |bencher| bencher.iter(run),
        );
        group.bench_function(format!("a plain loop at {rate}"), |bencher| {
            bencher.iter(|| plain_loop([black_box(u.view()), y.view()], &hz, sample_time_s));
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = paper::criterion(); targets = estimate }
criterion_main!(benches);
