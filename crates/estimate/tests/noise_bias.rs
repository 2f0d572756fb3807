//! Bias by noise on what an FRF is divided by: what every method says of it against what it is, and which
//! method is taken where none is asked for.

use std::f64::consts::TAU;

use frfid_estimate::{Campaign, FrfEstimate, Method, PeriodIndex, RunSpectra};
use frfid_signals::random::{normal, phase, stream};
use ndarray::Array2;
use num_complex::Complex64;

const LINES: usize = 500;

struct Case {
    n_inputs: usize,
    n_realizations: usize,
    n_periods: usize,
    /// Standard deviation of the noise of a period on u and y, which have size 1.
    noise: [f64; 2],
}

/// Orthogonal experiments, y = u: the FRF is the identity on every line.
fn campaign(case: &Case, seed: u64) -> Campaign {
    let (n, mut rng) = (case.n_inputs, stream(seed, "noise bias", &[]));
    let mut campaign = Campaign::new((1..=LINES).map(|k| k as f64).collect()).expect("rising");
    for realization in 0..case.n_realizations {
        let phases: Vec<f64> = (0..LINES).map(|_| phase(&mut rng)).collect();
        for (period, experiment) in (0..case.n_periods * n).map(|place| (place / n, place % n)) {
            let r = Array2::from_shape_fn((n, LINES), |(channel, k)| {
                Complex64::cis(phases[k] + TAU * (channel * experiment) as f64 / n as f64)
            });
            let [u, y] = case.noise.map(|size| {
                let mut number = || normal(&mut rng) * size / 2f64.sqrt();
                r.mapv(|value| value + Complex64::new(number(), number()))
            });
            let place = PeriodIndex {
                realization,
                period,
                experiment,
            };
            let run = RunSpectra { u, y, r: Some(r) };
            campaign.insert(place, run).expect("fits");
        }
    }
    campaign
}

/// Mean over lines and diagonal entries of what is missing to 1, with its standard error.
fn lost(estimate: &FrfEstimate) -> (f64, f64) {
    let response = &estimate.frf.response;
    let n = estimate.frf.n_inputs();
    let entries = (0..LINES * n).map(|at| 1.0 - response[[at / n, at % n, at % n]].re);
    let entries: Vec<f64> = entries.filter(|lost| lost.is_finite()).collect();
    let count = entries.len() as f64;
    let mean = entries.iter().sum::<f64>() / count;
    let squares: f64 = entries.iter().map(|lost| (lost - mean).powi(2)).sum();
    (mean, (squares / (count * (count - 1.0))).sqrt())
}

fn estimate(case: &Case, method: Method) -> FrfEstimate {
    let estimated = campaign(case, 1).estimate_lines(&method.into());
    estimated.expect("excited")
}

/// What is said is the bias of the worst line, whose signal-to-noise ratio came out low by chance: larger
/// than the mean of all, by a factor that many periods keep small.
#[test]
fn the_bias_that_is_said_is_the_one_that_is_there() {
    for (n_inputs, method, noise_u, noise_y) in [
        (1, Method::MeanOfFrfs, 0.7, 0.02),
        (1, Method::LogarithmicMean, 0.7, 0.02),
        (3, Method::MeanOfFrfs, 0.8, 0.02),
        (1, Method::H1, 0.4, 0.02),
        (1, Method::H2, 0.02, 0.4),
    ] {
        let case = Case {
            n_inputs,
            n_realizations: 1,
            n_periods: 250,
            noise: [noise_u, noise_y],
        };
        let estimate = estimate(&case, method);
        let ((lost, error), said) = (lost(&estimate), estimate.noise_bias.expect("it matters"));
        println!("{method:?}: lost {lost:.4} +- {error:.4}, said {said}");
        assert!(error < 0.1 * lost.abs());
        let ratio = said.relative_bias / lost.abs();
        assert!((0.9..3.0).contains(&ratio), "{method:?}: {ratio}");
        assert!(said.n_lines > LINES / 2, "{said}");
    }
}

#[test]
fn where_no_noise_meets_the_divisor_nothing_is_said() {
    for (method, noise) in [
        (Method::MeanOfFrfs, [0.1, 0.5]),
        (Method::LogarithmicMean, [0.1, 0.5]),
        (Method::MeanOfSpectra, [0.7, 0.3]),
        (Method::JointInputOutput, [1.5, 0.3]),
        (Method::H1, [0.0, 0.5]),
        (Method::H2, [0.5, 0.0]),
    ] {
        let case = Case {
            n_inputs: 1,
            n_realizations: 4,
            n_periods: 10,
            noise,
        };
        let estimate = estimate(&case, method);
        let (lost, error) = lost(&estimate);
        assert_eq!(estimate.noise_bias, None, "{method:?}");
        assert!(lost.abs() < 4.0 * error, "{method:?}: {lost} +- {error}");
    }
}

#[test]
fn what_is_known_decides_unless_a_method_is_named() {
    let case = Case {
        n_inputs: 2,
        n_realizations: 2,
        n_periods: 3,
        noise: [0.3, 0.1],
    };
    let with = campaign(&case, 2);
    let mut without = Campaign::new(with.frequency_hz().to_vec()).expect("rising");
    for (place, run) in with.clone().into_runs() {
        without
            .insert(place, RunSpectra { r: None, ..run })
            .expect("fits");
    }
    let of = |campaign: &Campaign, method: Method| {
        campaign.estimate(&method.into()).expect("excited").response
    };
    assert_eq!(of(&with, Method::Auto), of(&with, Method::JointInputOutput));
    assert_eq!(
        of(&without, Method::Auto),
        of(&without, Method::MeanOfSpectra)
    );
    assert_ne!(of(&with, Method::MeanOfFrfs), of(&with, Method::Auto));
}

/// Blows of changing strength scatter like noise on u, but y follows them.
#[test]
fn a_strength_that_y_follows_is_no_noise() {
    let strengths = [1.0, 1.1, 0.9, 1.2, 0.8];
    let mut rng = stream(1, "strength", &[]);
    let mut campaign = Campaign::new((1..=LINES).map(|k| k as f64).collect()).expect("rising");
    for (period, strength) in strengths.into_iter().enumerate() {
        let u = Array2::from_elem((1, LINES), Complex64::from(strength));
        let y = u.mapv(|u| 2.0 * u + 1e-3 * Complex64::new(normal(&mut rng), normal(&mut rng)));
        let place = PeriodIndex {
            realization: 0,
            period,
            experiment: 0,
        };
        let run = RunSpectra { u, y, r: None };
        campaign.insert(place, run).expect("fits");
    }
    for method in [Method::H1, Method::MeanOfSpectra, Method::MeanOfFrfs] {
        let found = campaign.estimate_lines(&method.into()).expect("excited");
        assert_eq!(found.noise_bias, None, "{method:?}");
    }
}
