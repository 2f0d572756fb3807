//! Synthesis of multisines, true peak included: `Multisine::realize` of the paper's, and of a long period with every odd
//! line beside bare inverse FFTs of as many samples.

mod paper;

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use frfid::signals::{Draw, LineGrid, Multisine, Phasing, Realization};
use frfid_transforms::TransformPlanner;
use ndarray::{Array3, s};
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

/// Samples of a long period.
const LONG: usize = 65_536;

/// Every odd line from 1 Hz up to a frequency, at 1 ms.
fn long(high_hz: f64) -> Multisine {
    let period_s = LONG as f64 * paper::SAMPLE_TIME_S;
    let lines = period_s.ceil() as usize..=(high_hz * period_s) as usize;
    let grid = LineGrid {
        sample_time_s: paper::SAMPLE_TIME_S,
        n_samples: LONG,
        excited: lines.filter(|line| line % 2 == 1).collect(),
        detection: Vec::new(),
    };
    Multisine::flat(grid, vec![150.0, 100.0, 50.0])
}

/// As many samples as three inputs in three experiments have, each signal by a transform of its own.
fn bare(planner: &mut TransformPlanner) -> Array3<f64> {
    let inverse = planner.inverse(LONG);
    let mut signals = Array3::zeros((3, 3, LONG));
    let mut spectrum = inverse.make_input_vec();
    let mut scratch = inverse.make_scratch_vec();
    for mut signal in signals.rows_mut() {
        spectrum.fill(Complex64::new(0.0, 0.0));
        spectrum[1..4000].fill(Complex64::new(0.5, 0.5));
        let signal = signal.as_slice_mut().expect("a row");
        let done = inverse.process_with_scratch(&mut spectrum, signal, &mut scratch);
        done.expect("buffers of the plan");
    }
    signals
}

fn realize_long(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("Multisine::realize, 65536 samples, 3 inputs");
    group.throughput(Throughput::Elements(9 * LONG as u64));
    let draw = Draw {
        seed: 1,
        realization: 0,
        phasing: Phasing::Orthogonal,
    };
    for high_hz in [60.0, 400.0] {
        let multisine = long(high_hz);
        group.bench_function(format!("odd lines to {high_hz} Hz"), |bencher| {
            bencher.iter(|| multisine.realize(black_box(&draw)));
        });
    }
    let mut planner = TransformPlanner::default();
    group.bench_function("bare inverse FFTs", |bencher| {
        bencher.iter(|| bare(black_box(&mut planner)));
    });
    group.finish();
}

criterion_group! { name = benches; config = paper::criterion(); targets = realize, realize_long }
criterion_main!(benches);
