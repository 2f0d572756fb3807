//! Synthesis of the paper's multisine, true peak included: `Multisine::realize`.

mod paper;

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use frfid::signals::{Draw, Multisine, Phasing, Realization};
use ndarray::s;
use num_complex::Complex64;

const PEAK_NM: f64 = 150.0;

/// Sums the sines with the amplitudes that the signal should have and the phases that it has:
/// nothing else may be in it, experiments and channels must be turned by the orthogonal phases, and
/// the peak between the samples must be that asked for.
fn assert_right(multisine: &Multisine, realization: &Realization) {
    let (lines, n) = (&multisine.grid.excited, multisine.grid.n_samples);
    let angle = |line: usize, k: usize| TAU * (line * k % n) as f64 / n as f64;
    let n_inputs = realization.peak.len();
    let first = realization.signal.slice(s![0, 0, ..]);
    let phasors = lines.iter().map(|&line| {
        let bin: Complex64 = first
            .iter()
            .enumerate()
            .map(|(k, x)| x * Complex64::cis(-angle(line, k)))
            .sum();
        (line, 2.0 * bin * Complex64::I / n as f64) // of the sine, not the cosine
    });
    let phasors: Vec<(usize, Complex64)> = phasors.collect();
    for (line, phasor) in &phasors {
        assert!(
            (phasor.norm() - realization.factor * PEAK_NM).abs() < 1e-10,
            "amplitude of line {line}"
        );
    }
    for experiment in 0..n_inputs {
        for channel in 0..n_inputs {
            let turn = Complex64::cis(TAU * (experiment * channel) as f64 / n_inputs as f64);
            for k in (0..n).step_by(7) {
                let sum: f64 = phasors
                    .iter()
                    .map(|(line, a)| (a * turn * Complex64::cis(angle(*line, k))).im)
                    .sum();
                assert!(
                    (realization.signal[[experiment, channel, k]] - sum).abs() < 1e-9,
                    "sample {k}"
                );
            }
        }
    }
    let largest = (0..16 * n).map(|k| {
        let sums = |turn: Complex64| {
            let at = |line: usize| TAU * (line * k % (16 * n)) as f64 / (16 * n) as f64;
            phasors
                .iter()
                .map(|(line, a)| (a * turn * Complex64::cis(at(*line))).im)
                .sum::<f64>()
                .abs()
        };
        (0..n_inputs)
            .map(|m| sums(Complex64::cis(TAU * m as f64 / n_inputs as f64)))
            .fold(0.0, f64::max)
    });
    let largest = largest.fold(0.0, f64::max);
    assert!(
        (1.0 - 1e-5..=1.0 + 1e-12).contains(&(largest / PEAK_NM)),
        "largest value between the samples: {largest}"
    );
}

fn realize(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("Multisine::realize");
    for n_inputs in [1, 3] {
        let multisine = paper::multisine(vec![PEAK_NM; n_inputs]);
        let draw = Draw {
            seed: 1,
            realization: 0,
            phasing: Phasing::Orthogonal,
        };
        assert_right(&multisine, &multisine.realize(&draw).expect("sound"));
        group.bench_function(
            format!("71 lines, 12288 samples, {n_inputs} inputs"),
            |bencher| {
                bencher.iter(|| multisine.realize(black_box(&draw)));
            },
        );
    }
    group.finish();
}

criterion_group! { name = benches; config = paper::criterion(); targets = realize }
criterion_main!(benches);
