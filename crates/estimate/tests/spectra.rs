//! Covariances of spectra and coherence against what made the data.

use std::f64::consts::TAU;

use frfid_estimate::{Campaign, Method, PeriodIndex, RunSpectra};
use frfid_signals::random::{normal, phase, stream};
use ndarray::Array2;
use num_complex::Complex64;

const LINES: usize = 1500;
const N_P: usize = 6;
const N_Q: usize = 4;

/// Two inputs, two outputs; noise on both that is correlated between them, distortion on y that is another in
/// each realization and the same in its periods.
fn campaign(noise_u: f64, noise_y: f64, distortion: f64) -> Campaign {
    let mut rng = stream(5, "spectra", &[]);
    let mut campaign = Campaign::new((1..=LINES).map(|k| k as f64).collect()).expect("rising");
    for realization in 0..N_P {
        let phases: Vec<f64> = (0..LINES).map(|_| phase(&mut rng)).collect();
        for experiment in 0..2 {
            let r = Array2::from_shape_fn((2, LINES), |(c, k)| {
                Complex64::cis(phases[k] + TAU * (c * experiment) as f64 / 2.0)
            });
            let mut drawn = |size: f64| {
                let mut number = || normal(&mut rng) * size / 2f64.sqrt();
                Array2::from_shape_simple_fn((2, LINES), || Complex64::new(number(), number()))
            };
            let distorted = &r + &drawn(distortion);
            for period in 0..N_Q {
                let shared = drawn(noise_u);
                let run = RunSpectra {
                    u: &r + &shared,
                    y: &distorted + &drawn(noise_y) + shared.mapv(|x| 0.5 * x),
                    r: Some(r.clone()),
                };
                let place = PeriodIndex {
                    realization,
                    period,
                    experiment,
                };
                campaign.insert(place, run).expect("fits");
            }
        }
    }
    campaign
}

/// Mean over the lines of an entry, which 1500 lines tell to a few per cent.
fn mean(covariance: &ndarray::Array3<Complex64>, row: usize, column: usize) -> Complex64 {
    (0..LINES)
        .map(|k| covariance[[k, row, column]])
        .sum::<Complex64>()
        / LINES as f64
}

#[test]
fn covariances_of_spectra_are_those_that_made_them() {
    let (noise_u, noise_y, distortion) = (0.05, 0.1, 0.2);
    let campaign = campaign(noise_u, noise_y, distortion);
    let frf = campaign.estimate(&Method::Auto.into()).expect("excited");
    let found = campaign.spectra_covariance(&frf).expect("fits");
    let noise = found.noise.as_ref().expect("four periods");
    let (u2, y2, d2) = (
        noise_u * noise_u,
        noise_y * noise_y,
        distortion * distortion,
    );
    let close = |found: Complex64, needed: f64, size: f64| (found - needed).norm() < 0.05 * size;
    for (row, column, needed) in [
        (0, 0, u2),
        (1, 1, u2),
        (2, 2, y2 + 0.25 * u2),
        (0, 2, 0.5 * u2),
        (2, 0, 0.5 * u2),
        (0, 1, 0.0),
        (2, 3, 0.0),
    ] {
        let value = mean(noise, row, column);
        assert!(
            close(value, needed, u2.max(needed)),
            "{row} {column}: {value} for {needed}"
        );
    }
    // y - u = distortion + noise of y - half of that of u
    let of_mean = (y2 + 0.25 * u2) / N_Q as f64;
    let part = found.equation_noise.as_ref().expect("four periods");
    assert!(close(mean(part, 0, 0), of_mean, of_mean));
    let nonlinear = found.nonlinear().expect("six realizations");
    let value = mean(&nonlinear, 1, 1);
    assert!(
        (value.re / d2 - 1.0).abs() < 0.1 && value.im.abs() < 0.01 * d2,
        "{value} for {d2}"
    );
}

#[test]
fn on_a_linear_machine_the_distortion_is_0_on_average() {
    let campaign = campaign(0.0, 0.1, 0.0);
    let frf = campaign.estimate(&Method::Auto.into()).expect("excited");
    let nonlinear = campaign.spectra_covariance(&frf).expect("fits").nonlinear();
    let nonlinear = nonlinear.expect("both are known");
    let of_mean = 0.01 / N_Q as f64;
    let mean = mean(&nonlinear, 0, 0).re;
    assert!(mean.abs() < 0.15 * of_mean, "{mean} of {of_mean}");
    let negative = (0..LINES)
        .filter(|&k| nonlinear[[k, 0, 0]].re < 0.0)
        .count();
    assert!(
        (0.4..0.75).contains(&(negative as f64 / LINES as f64)),
        "{negative}"
    );
}

#[test]
fn the_true_coherence_lies_in_its_interval() {
    for noise_y in [0.02, 0.3, 1.0, 3.0] {
        let campaign = campaign(0.0, noise_y, 0.0);
        let found = campaign.coherence().expect("complete");
        // one input and one output are one: the power of the signal is 1
        let truth = 1.0 / (1.0 + noise_y * noise_y);
        let within =
            |&(k, o): &(usize, usize)| (found.low[[k, o]]..=found.high[[k, o]]).contains(&truth);
        let entries = (0..2 * LINES).map(|at| (at / 2, at % 2));
        let share = entries.filter(within).count() as f64 / (2 * LINES) as f64;
        println!("noise {noise_y}: coherence {truth:.4}, held {share:.3}");
        assert!((0.93..=0.975).contains(&share), "noise {noise_y}: {share}");
    }
}
