//! Tests of the excerpts on the paper's linear joint.

use super::*;
use crate::testing::refusal;
use std::f64::consts::TAU;

use frfid_signals::random::{normal, stream};
use frfid_signals::{Phasing, Profile};
use nalgebra::{Matrix4, Matrix5, Vector4};
use ndarray::{Array4, s};
use num_complex::Complex64;

const SAMPLE_TIME_S: f64 = 1e-3;

fn chirp() -> Chirp {
    Chirp {
        low_hz: 1.0,
        high_hz: 60.0,
        duration_s: 20.0,
        amplitude: vec![Profile::constant(150.0)],
        fade_s: 0.0,
        tail_s: 0.0,
    }
}

/// The paper's linear joint, states motor angle, arm angle and their speeds; zero-order hold by
/// the matrix exponential.
fn joint() -> (Matrix4<f64>, Vector4<f64>) {
    let (motor, arm, damping, stiffness) = (35.0, 150.0, 400.0, 1.5e5);
    #[rustfmt::skip]
    let continuous = Matrix5::new(
        0.0, 0.0, 1.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 1.0, 0.0,
        -stiffness / motor, stiffness / motor, -damping / motor, damping / motor, 1.0 / motor,
        stiffness / arm, -stiffness / arm, damping / arm, -damping / arm, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0,
    );
    let held = (continuous * SAMPLE_TIME_S).exp();
    (
        held.fixed_view::<4, 4>(0, 0).into_owned(),
        held.fixed_view::<4, 1>(0, 4).into_owned(),
    )
}

/// Motor velocity, before each sample of the input acts.
fn simulate(u: &Array4<f64>) -> Array4<f64> {
    let (a, b) = joint();
    let mut y = u.clone();
    for mut lane in y.lanes_mut(Axis(3)) {
        let mut state = Vector4::zeros();
        for value in &mut lane {
            let input = *value;
            *value = state[2];
            state = a * state + b * input;
        }
    }
    y
}

fn truth(hz: f64) -> Complex64 {
    let (a, b) = joint();
    let z = Complex64::cis(TAU * hz * SAMPLE_TIME_S);
    let system = Matrix4::from_diagonal_element(z) - a.map(Complex64::from);
    system
        .lu()
        .solve(&b.map(Complex64::from))
        .expect("regular on the unit circle")[2]
}

fn grid_hz() -> Vec<f64> {
    (0..150)
        .map(|k| 1.3 * (55.0f64 / 1.3).powf(f64::from(k) / 149.0))
        .collect()
}

fn recording() -> Array4<f64> {
    chirp()
        .sample(SAMPLE_TIME_S, 1, Phasing::Orthogonal)
        .expect("sound")
        .insert_axis(Axis(0))
}

fn estimate(
    u: &Array4<f64>,
    y: &Array4<f64>,
    hz: &[f64],
    start_s: f64,
) -> Result<Frf, EstimateError> {
    estimate_chirp(
        u.view(),
        y.view(),
        None,
        &chirp(),
        SAMPLE_TIME_S,
        hz,
        start_s,
        &FrfOptions::default(),
    )
}

#[test]
fn on_the_papers_linear_joint_the_error_is_the_known_one() {
    let u = recording();
    let frf = estimate(&u, &simulate(&u), &grid_hz(), 0.0).expect("sound");
    assert!(frf.noise.is_none() && frf.total.is_none());
    let ratio: Vec<Complex64> = grid_hz()
        .iter()
        .enumerate()
        .map(|(k, &hz)| frf.response[[k, 0, 0]] / truth(hz))
        .collect();
    let mut error_db: Vec<f64> = ratio
        .iter()
        .map(|ratio| (20.0 * ratio.norm().log10()).abs())
        .collect();
    let error_deg = ratio
        .iter()
        .map(|ratio| ratio.arg().to_degrees().abs())
        .fold(0.0, f64::max);
    error_db.sort_by(f64::total_cmp);
    let (median, worst) = (error_db[75], error_db[149]);
    println!("excerpts: median {median:.4} dB, worst {worst:.2} dB, {error_deg:.1} deg");
    assert!(
        median < 0.05 && worst < 2.0 && error_deg < 15.0,
        "{median} {worst} {error_deg}"
    );
}

#[test]
fn a_late_start_shifts_the_excerpts_along() {
    let u = recording();
    let mut late = Array4::zeros((1, 1, 1, 20_700));
    late.slice_mut(s![.., .., .., 500..20_500]).assign(&u);
    let (plain, shifted) = (
        estimate(&u, &simulate(&u), &[2.0, 20.0], 0.0),
        estimate(&late, &simulate(&late), &[2.0, 20.0], 0.5),
    );
    let (plain, shifted) = (
        plain.expect("sound").response,
        shifted.expect("sound").response,
    );
    plain
        .iter()
        .zip(&shifted)
        .for_each(|(a, b)| assert!((a - b).norm() < 1e-9 * a.norm()));
}

#[test]
fn repeats_give_the_noise_variance() {
    let clean = recording();
    let shape = (40, 1, 1, clean.len());
    let u = clean.broadcast(shape).expect("repeats").to_owned();
    let mut y = simulate(&u);
    let mut rng = stream(1, "excerpt", &[]);
    y.mapv_inplace(|value| value + 1e-3 * normal(&mut rng));
    let frf = estimate(&u, &y, &[5.0, 20.0], 0.0).expect("sound");
    let exact = estimate(&clean, &simulate(&clean), &[5.0, 20.0], 0.0).expect("sound");
    let variance = frf.noise_variance().expect("40 repeats");
    assert_eq!(
        frf.noise.as_ref().expect("40 repeats").degrees_of_freedom,
        39.0
    );
    for (line, variance) in variance.iter().enumerate() {
        let squared = (frf.response[[line, 0, 0]] - exact.response[[line, 0, 0]]).norm_sqr();
        assert!(
            squared < 12.0 * variance && *variance > 0.0,
            "{squared:e} against {variance:e}"
        );
    }
}

#[test]
fn frequencies_outside_the_sweep_and_bad_arrays_are_refused() {
    let u = recording();
    let (never, too_short) = ("the chirp never has", "less than one period of it");
    for (hz, start_s, reason) in [
        (0.9, 0.0, never),
        (61.0, 0.0, never),
        (20.0, 30.0, too_short),
        (20.0, -30.0, too_short),
        (20.0, f64::NAN, "start_s is NaN"),
    ] {
        let said = refusal(estimate(&u, &u, &[hz], start_s));
        assert!(said.contains(reason), "{hz} Hz from {start_s} s: {said}");
    }
    let said = refusal(estimate(&u, &u, &[f64::NAN], 0.0));
    assert!(said.contains(never), "{said}");
    let short = u.slice(s![.., .., .., ..100]).to_owned();
    let said = refusal(estimate(&u, &short, &[20.0], 0.0));
    assert_eq!(
        said,
        "y has shape [1, 1, 1, 100], needed (1, 1, channel, 20000), as u"
    );
    let said = refusal(estimate(&short, &short, &[20.0], 0.0));
    assert!(said.contains(too_short), "{said}");
    let mut holed = u.clone();
    holed[[0, 0, 0, 100]] = f64::NAN;
    // the NaN lies within this excerpt
    let said = refusal(estimate(&u, &holed, &[1.3], 0.0));
    assert!(
        said.starts_with("y: 1 samples are NaN or infinite, the first in channel 0 at sample 100"),
        "{said}"
    );
}
