//! Local models against what they must be: exact for one mode, honest about noise, clear about what cannot be.

use frfid_signals::random::{normal, stream};
use ndarray::Array2;
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::frf::local::column::Column;
use crate::frf::local::fitted::Fitted;
use crate::frf::local::window::Window;
use crate::frf::local::{LocalModel, LocalOptions, Piece, estimate_local};
use crate::frf::matrices::Matrix;

/// A mode of half width `damping` in a 2x2 plant, and transients with the same poles: 21 lines of three
/// experiments, and the response in the middle.
fn window(damping: f64, noise: f64, seed: u64) -> (Window, Matrix) {
    let mut rng = stream(seed, "local rational", &[]);
    let mut random = |rows, columns| {
        Matrix::from_fn(rows, columns, |_, _| {
            Complex64::new(normal(&mut rng), normal(&mut rng))
        })
    };
    let (constant, mode) = (random(2, 2), random(2, 2));
    let end = random(2, 3);
    let pole = |x: f64| Complex64::new(damping, 2.0 * (x - 0.1)).inv();
    let response = |x: f64| &constant + &mode * pole(x);
    let places: Vec<f64> = (0..21).map(|k| f64::from(k) / 10.0 - 1.0).collect();
    let all = places.repeat(3);
    let (mut inputs, mut outputs) = (vec![Vec::new(); 2], vec![Vec::new(); 2]);
    for (row, &x) in all.iter().enumerate() {
        let u = random(2, 1);
        let y = response(x) * &u
            + end.column(row / 21) * pole(x)
            + random(2, 1) * Complex64::from(noise);
        (0..2).for_each(|channel| inputs[channel].push(u[channel]));
        (0..2).for_each(|channel| outputs[channel].push(y[channel]));
    }
    (
        Window::of(
            all,
            vec![0..21, 21..42, 42..63],
            columns(&inputs),
            columns(&outputs),
            LocalModel::Rational,
        ),
        response(0.0),
    )
}

fn columns(signals: &[Vec<Complex64>]) -> Vec<Column> {
    let column = |signal: &Vec<Complex64>| Column::of(signal.len(), signal.iter().copied());
    signals.iter().map(column).collect()
}

#[test]
fn a_sharp_mode_and_its_transient_are_exact() {
    let (window, truth) = window(1e-3, 0.0, 1);
    let fit = Fitted::of(&window).expect("enough lines");
    let error = (fit.response - &truth).norm() / truth.norm();
    assert!(error < 1e-9, "{error:e}");
}

/// The condition of 1e5 is squared in the normal equations, and what that costs is found again.
#[test]
fn inputs_nearly_alike_are_told_apart_to_rounding() {
    let mut rng = stream(3, "nearly alike", &[]);
    let mut random = || Complex64::new(normal(&mut rng), normal(&mut rng));
    let places: Vec<f64> = (0..41).map(|k| f64::from(k) / 20.0 - 1.0).collect();
    let common: Vec<Complex64> = places.iter().map(|_| random()).collect();
    let own: [Vec<Complex64>; 2] =
        [(); 2].map(|()| common.iter().map(|u| u + 1e-5 * random()).collect());
    let output = own[0].iter().zip(&own[1]).map(|(a, b)| 3.0 * a - 2.0 * b);
    let outputs = columns(&[output.collect()]);
    let pieces = std::iter::once(0..41).collect();
    let model = LocalModel::Polynomial;
    let window = Window::of(places, pieces, columns(&own), outputs, model);
    let fit = Fitted::of(&window).expect("enough lines");
    let error = (fit.response[0] - 3.0).norm();
    assert!(error < 1e-9, "{error:e}");
}

/// 95 % of |dG|^2 lie below `variance F_95(2, 2 dof)`, dof = 63 - 17: over a smooth mode and beside a sharp one.
#[test]
fn the_covariance_is_that_of_the_errors() {
    for damping in [3.0, 0.1] {
        let (mut n_inside, mut n_all) = (0, 0);
        for seed in 0..300 {
            let (window, truth) = window(damping, 1e-3, seed);
            let fit = Fitted::of(&window).expect("enough lines");
            let errors = fit
                .response
                .iter()
                .zip(truth.iter())
                .map(|(found, truth)| (found - truth).norm_sqr());
            for (error, variance) in errors.zip(fit.covariance.diagonal().iter()) {
                n_all += 1;
                n_inside += u32::from(error <= 3.095 * variance.re);
            }
        }
        let share = f64::from(n_inside) / f64::from(n_all);
        assert!((0.93..0.97).contains(&share), "damping {damping}: {share}");
    }
}

/// White noise and a resonator that answers it from rest, as it is and with noise on the answer.
fn record(noise: f64) -> [Array2<f64>; 2] {
    let mut rng = stream(5, "resonator", &[]);
    let u = Array2::from_shape_simple_fn((1, 2000), || normal(&mut rng));
    let (mut y, mut state) = (Array2::zeros((1, 2000)), [0.0; 2]);
    for k in 0..2000 {
        y[[0, k]] = state[0] + noise * normal(&mut rng);
        state = [1.8 * state[0] - 0.98 * state[1] + u[[0, k]], state[0]];
    }
    [u, y]
}

/// `1 / (z - 1.8 + 0.98 / z)` at a frequency in parts of the sample rate.
fn resonator(frequency: f64) -> Complex64 {
    let z = Complex64::from_polar(1.0, std::f64::consts::TAU * frequency);
    (z - 1.8 + 0.98 / z).inv()
}

fn estimated(
    u: &Array2<f64>,
    y: &Array2<f64>,
    hz: &[f64],
    options: &LocalOptions,
) -> Result<super::LocalEstimate, EstimateError> {
    let piece = Piece {
        u: u.view(),
        y: y.view(),
        r: None,
    };
    estimate_local(&[piece], 1.0, hz, options)
}

#[test]
fn a_record_of_noise_from_rest_is_enough_between_its_lines_too() {
    let [u, y] = record(0.0);
    let hz: Vec<f64> = (0..60).map(|k| 0.03001 + 0.001 * f64::from(k)).collect();
    let found = estimated(&u, &y, &hz, &LocalOptions::default()).expect("sound");
    for (hz, response) in hz.iter().zip(&found.estimate.frf.response) {
        let truth = resonator(*hz);
        assert!((response - truth).norm() < 1e-7 * truth.norm(), "{hz}");
    }
}

#[test]
fn holes_make_pieces_and_pieces_of_any_length_go_together() {
    let [u, y] = record(0.01);
    let cut = |signal: &Array2<f64>, from, to| signal.slice(ndarray::s![.., from..to]).to_owned();
    let parts: Vec<_> = [(0, 900), (910, 2000)]
        .map(|(from, to)| [cut(&u, from, to), cut(&y, from, to)])
        .into();
    let pieces = parts.iter().map(|[u, y]| Piece {
        u: u.view(),
        y: y.view(),
        r: None,
    });
    let pieces: Vec<Piece> = pieces.collect();
    let found =
        estimate_local(&pieces, 1.0, &[0.05, 0.07, 0.09], &LocalOptions::default()).expect("sound");
    for (hz, response) in [0.05, 0.07, 0.09].iter().zip(&found.estimate.frf.response) {
        let truth = resonator(*hz);
        assert!(
            (response - truth).norm() < 0.01 * truth.norm(),
            "{hz}: {response} {truth}"
        );
    }
}

#[test]
fn what_cannot_be_known_is_said() {
    let [u, y] = record(0.01);
    let said = |result: Result<super::LocalEstimate, EstimateError>| {
        result.expect_err("refused").to_string()
    };
    let narrow = LocalOptions {
        half_width: Some(3),
        ..LocalOptions::default()
    };
    assert!(
        said(estimated(&u, &y, &[0.05], &narrow))
            .contains("3 lines to either side hold too few equations")
    );
    let [short_u, short_y] = [&u, &y].map(|signal| signal.slice(ndarray::s![.., ..20]).to_owned());
    assert!(
        said(estimated(
            &short_u,
            &short_y,
            &[0.2],
            &LocalOptions::default()
        ))
        .contains("too few")
    );
    assert!(said(estimated(&u, &y, &[0.6], &LocalOptions::default())).contains("below 0.5 Hz"));
    assert!(said(estimated(&u, &y, &[], &LocalOptions::default())).contains("frequencies"));
    let twice = ndarray::concatenate![ndarray::Axis(0), u, u];
    assert!(
        said(estimated(&twice, &y, &[0.05], &LocalOptions::default())).contains("inputs are alike")
    );
    let silent = ndarray::concatenate![ndarray::Axis(0), u, 0.0 * &u];
    assert!(
        said(estimated(&silent, &y, &[0.05], &LocalOptions::default()))
            .contains("input 1 is not excited")
    );
    let mut hole = y.clone();
    hole[[0, 7]] = f64::NAN;
    assert!(said(estimated(&u, &hole, &[0.05], &LocalOptions::default())).contains("finite"));
}
