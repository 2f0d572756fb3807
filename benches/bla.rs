//! Best linear approximation of a 3x3 campaign: `estimate_bla`.

mod paper;

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use frfid::estimate::{Campaign, FrfOptions, LineDft, PeriodIndex, RunSpectra, estimate_bla};
use frfid::signals::random::{normal, stream};
use frfid::signals::{Draw, Frf, Phasing};
use ndarray::{Array2, Array5, s};
use num_complex::Complex64;
use paper::{PERIOD, SAMPLE_TIME_S};

const REALIZATIONS: usize = 10;
const PERIODS: usize = 5;
const AXES: usize = 3;
const NOISE_RAD_S: f64 = 1e-3;

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
fn campaign() -> (Array5<f64>, Array5<f64>, f64) {
    let peak = 150.0;
    let multisine = paper::multisine(vec![peak; AXES]);
    let shape = (REALIZATIONS, AXES, PERIODS, AXES, PERIOD);
    let (mut u, mut y, mut variance) = (Array5::zeros(shape), Array5::zeros(shape), 0.0);
    let mut rng = stream(1, "noise of the bench", &[]);
    for realization in 0..REALIZATIONS {
        let drawn = multisine.realize(&Draw {
            seed: 1,
            realization,
            phasing: Phasing::Orthogonal,
        });
        let drawn = drawn.expect("sound");
        let line_amplitude = 0.5 * PERIOD as f64 * drawn.factor * peak;
        variance += PERIOD as f64 * NOISE_RAD_S.powi(2) / (AXES as f64 * line_amplitude.powi(2));
        for experiment in 0..AXES {
            let input = drawn.signal.slice(s![experiment, .., ..]);
            let output = Array2::from_shape_fn(input.dim(), |(output, k)| {
                let part = |input_channel: usize| {
                    let (gain, delay) = gain_and_delay(output, input_channel);
                    gain * input[[input_channel, (k + PERIOD - delay) % PERIOD]]
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
        variance / (REALIZATIONS * REALIZATIONS * PERIODS) as f64,
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

fn estimate(criterion: &mut Criterion) {
    let lines = paper::multisine(vec![1.0]).grid.excited;
    let (u, y, variance) = campaign();
    let run = || {
        estimate_bla(
            black_box(u.view()),
            y.view(),
            None,
            SAMPLE_TIME_S,
            &lines,
            &FrfOptions::default(),
        )
        .expect("sound")
    };
    assert_right(&run(), variance);
    let mut group = criterion.benchmark_group("estimate_bla");
    group.bench_function(
        "3x3, 10 realizations x 5 periods x 12288 samples",
        |bencher| bencher.iter(run),
    );
    let campaign = spectra(&u, &y, &lines);
    let from_spectra = || {
        black_box(&campaign)
            .estimate(&FrfOptions::default())
            .expect("sound")
    };
    assert_right(&from_spectra(), variance);
    group.bench_function("the same from spectra, 71 lines", |bencher| {
        bencher.iter(from_spectra);
    });
    group.finish();
}

/// The campaign on its lines, as it is kept while runs come in.
fn spectra(u: &Array5<f64>, y: &Array5<f64>, lines: &[usize]) -> Campaign {
    let dft = LineDft::new(PERIOD, lines).expect("sound");
    let mut campaign =
        Campaign::new(dft.frequency_hz(SAMPLE_TIME_S).expect("sound")).expect("rising");
    for (realization, experiment, period) in ndarray::indices((REALIZATIONS, AXES, PERIODS)) {
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
