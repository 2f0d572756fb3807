//! FRF by local rational models at 1000 lines of one record: `estimate_local`.

use std::f64::consts::TAU;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use frfid::estimate::{LocalOptions, Piece, estimate_local};
use frfid::signals::Frf;
use frfid::signals::random::{normal, stream};
use ndarray::{Array2, arr2};
use num_complex::Complex64;

const SAMPLE_TIME_S: f64 = 0.001;
const SAMPLES: usize = 20_000;
const LINES: usize = 1000;
/// Noise on the outputs over their rms.
const NOISE: f64 = 0.01;
/// Share of the outputs that goes back to the inputs.
const FEEDBACK: f64 = 0.05;

/// Velocity of a joint with a resonance at 20 Hz of 2 % damping, `y[k] = b u[k - 1] + a_1 y[k - 1] + a_2 y[k - 2]`.
fn resonance() -> [f64; 2] {
    let angle = TAU * 20.0 * SAMPLE_TIME_S;
    let radius = (-0.02 * angle).exp();
    [2.0 * radius * angle.cos(), -radius * radius]
}

fn resonance_frf(hz: f64) -> Complex64 {
    let delay = Complex64::cis(-TAU * hz * SAMPLE_TIME_S);
    let [one, two] = resonance();
    delay / (1.0 - delay * (one + delay * two))
}

fn coupling(axes: usize) -> Array2<f64> {
    let all = arr2(&[[1.0, 0.2, -0.1], [0.3, 0.8, 0.1], [-0.2, 0.4, 0.5]]);
    all.slice(ndarray::s![..axes, ..axes]).to_owned()
}

/// Reference, input and output of a loop, `(channel, sample)`: joints with coupled outputs driven by noise.
fn record(axes: usize) -> [Array2<f64>; 3] {
    let (mut rng, shape) = (stream(1, "bench of local models", &[]), (axes, SAMPLES));
    let r = Array2::from_shape_simple_fn(shape, || normal(&mut rng));
    let (mut u, mut x) = (r.clone(), Array2::zeros(shape));
    let (mut y, [one, two], gains) = (Array2::zeros(shape), resonance(), coupling(axes));
    for k in 0..SAMPLES {
        for axis in 0..axes {
            let before = |n: usize| {
                if k < n {
                    [0.0; 2]
                } else {
                    [x[[axis, k - n]], u[[axis, k - n]]]
                }
            };
            let ([x1, u1], [x2, _]) = (before(1), before(2));
            x[[axis, k]] = u1 + one * x1 + two * x2;
        }
        y.column_mut(k).assign(&gains.dot(&x.column(k)));
        let feedback = y.column(k).mapv(|y: f64| FEEDBACK * y);
        let mut input = u.column_mut(k);
        input -= &feedback;
    }
    let size = (y.iter().map(|y| y * y).sum::<f64>() / y.len() as f64).sqrt();
    y.mapv_inplace(|y| y + NOISE * size * normal(&mut rng));
    [r, u, y]
}

fn frequencies() -> Vec<f64> {
    let spacing_hz = 1.0 / (SAMPLES as f64 * SAMPLE_TIME_S);
    (0..LINES)
        .map(|line| 1.0 + spacing_hz * line as f64)
        .collect()
}

fn estimated([r, u, y]: &[Array2<f64>; 3], half_width: Option<usize>) -> Frf {
    let is_loop = u.nrows() > 1;
    let piece = Piece {
        u: u.view(),
        y: y.view(),
        r: is_loop.then(|| r.view()),
    };
    let options = LocalOptions {
        half_width,
        ..LocalOptions::default()
    };
    let estimate = estimate_local(&[piece], SAMPLE_TIME_S, &frequencies(), &options);
    estimate.expect("sound").estimate.frf
}

/// Half of the lines are right within 5 % of the largest entry, and 90 to 99 % of the entries lie in their regions.
fn assert_right(frf: &Frf) {
    let (_, axes, _) = frf.response.dim();
    let gains = coupling(axes);
    let total = frf.total.as_ref().expect("residuals are left");
    let (mut inside, mut errors) = (0, Vec::new());
    for ((line, output, input), value) in frf.response.indexed_iter() {
        let truth = resonance_frf(frf.frequency_hz[line]) * gains[[output, input]];
        let entry = output + axes * input;
        let variance = total.covariance[[line, entry, entry]].re;
        let factor = frfid::signals::confidence_factor_95(total.degrees_of_freedom);
        inside += usize::from((value - truth).norm_sqr() <= variance * factor);
        errors.push((value - truth).norm() / resonance_frf(frf.frequency_hz[line]).norm());
    }
    errors.sort_by(f64::total_cmp);
    let share = inside as f64 / errors.len() as f64;
    assert!(
        errors[errors.len() / 2] < 0.05,
        "{}",
        errors[errors.len() / 2]
    );
    assert!((0.9..0.99).contains(&share), "{share}");
}

fn bench(c: &mut Criterion) {
    for (name, axes) in [("one input", 1), ("3x3 in closed loop", 3)] {
        let record = record(axes);
        assert_right(&estimated(&record, None));
        let mut group = c.benchmark_group(format!("local models, 1000 lines, {name}"));
        group.sample_size(10);
        for (widths, half_width) in [
            ("20 lines to either side", Some(20)),
            ("widths chosen", None),
        ] {
            group.bench_function(widths, |b| {
                b.iter(|| estimated(black_box(&record), half_width));
            });
        }
    }
}

criterion_group!(benches, bench);
criterion_main!(benches);
