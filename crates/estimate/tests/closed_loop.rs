//! Closed loop from one campaign: every response against the loop's equations, its region by chance.

use std::f64::consts::TAU;

use frfid_estimate::{Campaign, ClosedLoop, Entry, PeriodIndex, Response, RunSpectra};
use frfid_signals::Frf;
use frfid_signals::random::{normal, phase, stream};
use nalgebra::DMatrix;
use ndarray::Array2;
use num_complex::Complex64;

type Matrix = DMatrix<Complex64>;

const LINES: usize = 400;

/// A plant and a controller of n channels, full.
fn parts(n: usize) -> [Matrix; 2] {
    let plant = DMatrix::from_fn(n, n, |o, i| {
        Complex64::from_polar(if o == i { 1.2 } else { 0.3 }, 0.4 + (o + 2 * i) as f64)
    });
    let controller = DMatrix::from_fn(n, n, |o, i| {
        Complex64::from_polar(if o == i { 0.8 } else { 0.0 }, -0.7)
    });
    [plant, controller]
}

fn inverse(matrix: Matrix) -> Matrix {
    matrix.try_inverse().expect("regular")
}

/// Every response by the equations of the loop.
fn truth(n: usize, what: Response, entry: Entry) -> Matrix {
    let [plant, controller] = parts(n);
    let identity = DMatrix::identity(n, n);
    let open = match entry {
        Entry::SetPoint => &plant * &controller,
        Entry::Input => &controller * &plant,
    };
    let sensitivity = inverse(&identity + &open);
    match (what, entry) {
        (Response::Plant, _) => plant,
        (Response::OpenLoop, _) => open,
        (Response::Sensitivity, _) | (Response::RToU, Entry::Input) => sensitivity,
        (Response::ComplementarySensitivity, _) | (Response::RToY, Entry::SetPoint) => {
            identity - sensitivity
        }
        (Response::RToU, Entry::SetPoint) => &controller * sensitivity,
        (Response::RToY, Entry::Input) => plant * sensitivity,
    }
}

/// A campaign with a disturbance at the output, which runs around the loop.
fn measured(n: usize, entry: Entry, disturbance: f64, seed: u64) -> ClosedLoop {
    let mut rng = stream(seed, "closed loop", &[]);
    let [plant, controller] = parts(n);
    let mut campaign = Campaign::new((1..=LINES).map(|k| k as f64).collect()).expect("rising");
    for realization in 0..4 {
        let phases: Vec<f64> = (0..LINES).map(|_| phase(&mut rng)).collect();
        for (period, experiment) in (0..3 * n).map(|at| (at / n, at % n)) {
            let r = DMatrix::from_fn(n, LINES, |channel, k| {
                Complex64::cis(phases[k] + TAU * (channel * experiment) as f64 / n as f64)
            });
            let mut number = || normal(&mut rng) * disturbance / 2f64.sqrt();
            let v = DMatrix::from_fn(n, LINES, |_, _| Complex64::new(number(), number()));
            let loop_of = |open: Matrix| inverse(DMatrix::identity(n, n) + open);
            let y = match entry {
                Entry::SetPoint => loop_of(&plant * &controller) * (&plant * &controller * &r + &v),
                Entry::Input => loop_of(&plant * &controller) * (&plant * &r + &v),
            };
            let u = match entry {
                Entry::SetPoint => &controller * (&r - &y),
                Entry::Input => &r - &controller * &y,
            };
            let [u, y, r] = [u, y, r].map(|x| Array2::from_shape_fn((n, LINES), |at| x[at]));
            let place = PeriodIndex {
                realization,
                period,
                experiment,
            };
            campaign
                .insert(place, RunSpectra { u, y, r: Some(r) })
                .expect("fits");
        }
    }
    campaign.closed_loop(1e10).expect("excited")
}

const RESPONSES: [Response; 6] = [
    Response::Plant,
    Response::RToU,
    Response::RToY,
    Response::Sensitivity,
    Response::ComplementarySensitivity,
    Response::OpenLoop,
];

/// Share of the entries whose 95 % region holds the truth.
fn held(frf: &Frf, truth: &Matrix) -> [f64; 2] {
    let known = [
        (&frf.noise, frf.noise_variance()),
        (&frf.total, frf.total_variance()),
    ];
    known.map(|(known, variance)| {
        let factor = known.as_ref().expect("measured").confidence_factor_95();
        let variance = variance.expect("measured");
        let entries = frf.response.indexed_iter();
        let holds = entries.filter(|((k, o, i), value)| {
            (*value - truth[(*o, *i)]).norm_sqr() <= factor * variance[[*k, *o, *i]]
        });
        holds.count() as f64 / frf.response.len() as f64
    })
}

#[test]
fn every_response_is_that_of_the_loop_within_its_region() {
    for (n, entry) in [
        (1, Entry::SetPoint),
        (1, Entry::Input),
        (2, Entry::SetPoint),
        (2, Entry::Input),
    ] {
        let [clean, noisy] = [0.0, 0.05].map(|noise| measured(n, entry, noise, 3));
        for what in RESPONSES {
            let truth = truth(n, what, entry);
            let exact = clean.response(what, Some(entry)).expect("fits");
            let worst = exact
                .response
                .indexed_iter()
                .map(|((_, o, i), value)| (value - truth[(o, i)]).norm());
            assert!(worst.fold(0.0, f64::max) < 1e-12, "{what:?}, {entry:?}");
            let shares = held(&noisy.response(what, Some(entry)).expect("fits"), &truth);
            println!("{n}, {entry:?}, {what:?}: {shares:.3?}");
            assert!(
                shares.iter().all(|share| (0.93..=0.975).contains(share)),
                "{what:?}, {entry:?}: {shares:?}"
            );
        }
    }
}

#[test]
fn what_is_not_known_of_the_loop_is_asked_for() {
    let measured = measured(1, Entry::SetPoint, 0.0, 1);
    let refused = measured
        .response(Response::Sensitivity, None)
        .expect_err("not known");
    assert!(refused.to_string().contains("say it"), "{refused}");
    assert!(measured.response(Response::Plant, None).is_ok());
}
