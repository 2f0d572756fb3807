//! Best linear approximation of 3x3 campaigns: `estimate_bla`, beside bare transforms of all their periods.

mod paper;

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use frfid::estimate::{
    Campaign, FrfOptions, LineDft, PeriodIndex, RunSpectra, Transform as _, estimate_bla,
    estimate_with_distortion,
};
use frfid::signals::random::{normal, stream};
use frfid::signals::{Draw, Frf, LineGrid, Multisine, Phasing};
use ndarray::{Array2, Array5, Axis, s};
use num_complex::Complex64;
use paper::SAMPLE_TIME_S;

const PERIODS: usize = 5;
const AXES: usize = 3;
const NOISE_RAD_S: f64 = 1e-3;
const PEAK: f64 = 150.0;

/// A plant with a known FRF: each output is the sum of the inputs, each with a gain and a cyclic
/// delay in samples.
fn gain_and_delay(output: usize, input: usize) -> (f64, usize) {
    (
        if output == input { 1.0 } else { 0.1 } / (1.0 + output as f64),
        1 + 5 * output + 2 * input,
    )
}

/// Input, output with noise, and the variance that the noise gives to every entry of the averaged
/// FRF: on a line where U is a unitary matrix times sqrt(3) A, one period gives G the variance N
/// sigma^2 / (3 A^2).
fn campaign(multisine: &Multisine, n_realizations: usize) -> (Array5<f64>, Array5<f64>, f64) {
    let (peak, n) = (PEAK, multisine.grid.n_samples);
    let shape = (n_realizations, AXES, PERIODS, AXES, n);
    let (mut u, mut y, mut variance) = (Array5::zeros(shape), Array5::zeros(shape), 0.0);
    let mut rng = stream(1, "noise of the bench", &[]);
    for realization in 0..n_realizations {
        let drawn = multisine.realize(&Draw {
            seed: 1,
            realization,
            phasing: Phasing::Orthogonal,
        });
        let drawn = drawn.expect("sound");
        let line_amplitude = 0.5 * n as f64 * drawn.factor * peak;
        variance += n as f64 * NOISE_RAD_S.powi(2) / (AXES as f64 * line_amplitude.powi(2));
        for experiment in 0..AXES {
            let input = drawn.signal.slice(s![experiment, .., ..]);
            let output = Array2::from_shape_fn(input.dim(), |(output, k)| {
                let part = |input_channel: usize| {
                    let (gain, delay) = gain_and_delay(output, input_channel);
                    gain * input[[input_channel, (k + n - delay) % n]]
                };
                (0..AXES).map(part).sum::<f64>()
            });
            u.slice_mut(s![realization, experiment, .., .., ..])
                .assign(&input);
            y.slice_mut(s![realization, experiment, .., .., ..])
                .assign(&output);
        }
    }
    y.mapv_inplace(|value| value + NOISE_RAD_S * normal(&mut rng));
    (
        u,
        y,
        variance / (n_realizations * n_realizations * PERIODS) as f64,
    )
}

/// The errors must have the variance that the noise gives them, and so must both estimates of it.
fn assert_right(frf: &Frf, variance: f64) {
    let error = frf
        .response
        .indexed_iter()
        .map(|((line, output, input), value)| {
            let (gain, delay) = gain_and_delay(output, input);
            let turn = TAU * frf.frequency_hz[line] * SAMPLE_TIME_S * delay as f64;
            (value - gain * Complex64::cis(-turn)).norm_sqr()
        });
    let squared_error = error.sum::<f64>() / frf.response.len() as f64;
    let mean = |variance: Option<ndarray::Array3<f64>>| {
        variance.and_then(|v| v.mean()).expect("was measured")
    };
    // 639 entries with 1, 40 and 9 degrees of freedom: standard errors of 4, 0.6 and 1.3 %; four of
    // them are allowed
    for (found, allowed) in [
        (squared_error, 0.16),
        (mean(frf.noise_variance()), 0.025),
        (mean(frf.total_variance()), 0.053),
    ] {
        assert!(
            (found / variance - 1.0).abs() < allowed,
            "{found:e} instead of {variance:e}"
        );
    }
    let condition = frf.condition.as_ref().expect("U was inverted");
    assert!(
        condition
            .iter()
            .all(|condition| (condition - 1.0).abs() < 1e-9)
    );
}

/// The odd lines of the paper, on periods of so many samples.
fn multisine(n_samples: usize) -> Multisine {
    let peak = vec![PEAK; AXES];
    let grid = LineGrid {
        n_samples,
        ..paper::multisine(peak.clone()).grid
    };
    Multisine::flat(grid, peak)
}

fn estimate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("estimate_bla");
    for (n, n_realizations) in [(12_288, 10), (16_384, 30)] {
        let multisine = multisine(n);
        let lines = &multisine.grid.excited;
        let (u, y, variance) = campaign(&multisine, n_realizations);
        let options = FrfOptions::default();
        let run = || {
            let u = black_box(u.view());
            estimate_bla(u, y.view(), None, SAMPLE_TIME_S, lines, &options).expect("sound")
        };
        assert_right(&run(), variance);
        let size = format!("{n_realizations} realizations x {PERIODS} periods x {n} samples");
        group.throughput(Throughput::Elements((u.len() + y.len()) as u64));
        group.bench_function(format!("3x3, {size}"), |bencher| bencher.iter(run));
        let with_levels = || {
            let u = black_box(u.view());
            let found = estimate_with_distortion(u, y.view(), None, SAMPLE_TIME_S, lines, &options);
            found.expect("sound")
        };
        group.bench_function(
            format!("3x3 and its levels of distortion, {size}"),
            |bencher| bencher.iter(with_levels),
        );
        // with an even line besides, all lines are transformed
        let mut all = lines.clone();
        all.push(lines[lines.len() - 1] + 1);
        let whole = LineDft::new(n, &all).expect("sound");
        group.bench_function(format!("bare real transforms, {size}"), |bencher| {
            bencher.iter(|| bare_transforms(&whole, [black_box(&u), &y]));
        });
        let campaign = spectra(&u, &y, lines);
        let from_spectra = || black_box(&campaign).estimate(&options).expect("sound");
        assert_right(&from_spectra(), variance);
        group.bench_function(
            format!("the same from spectra, {} lines, {size}", lines.len()),
            |bencher| bencher.iter(from_spectra),
        );
    }
    group.finish();
}

/// The whole transform of every period of every channel, and nothing else.
fn bare_transforms(dft: &LineDft, signals: [&Array5<f64>; 2]) -> Complex64 {
    let mut total = Complex64::ZERO;
    for signal in signals {
        for place in ndarray::indices((signal.len_of(Axis(0)), AXES, PERIODS)) {
            let (realization, experiment, period) = place;
            let run = signal.slice(s![realization, experiment, period, .., ..]);
            total += dft.transform("x", run).expect("finite")[[0, 0]];
        }
    }
    total
}

/// The campaign on its lines, as it is kept while runs come in.
fn spectra(u: &Array5<f64>, y: &Array5<f64>, lines: &[usize]) -> Campaign {
    let dft = LineDft::new(u.len_of(Axis(4)), lines).expect("sound");
    let mut campaign =
        Campaign::new(dft.frequency_hz(SAMPLE_TIME_S).expect("sound")).expect("rising");
    for (realization, experiment, period) in ndarray::indices((u.len_of(Axis(0)), AXES, PERIODS)) {
        let run = s![realization, experiment, period, .., ..];
        let run = RunSpectra::of(&dft, u.slice(run), y.slice(run), None).expect("finite");
        campaign
            .insert(
                PeriodIndex {
                    realization,
                    period,
                    experiment,
                },
                run,
            )
            .expect("a new one");
    }
    campaign
}

criterion_group! { name = benches; config = paper::criterion(); targets = estimate }
criterion_main!(benches);
