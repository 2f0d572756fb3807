//! Friction of simulated joints, against what they have.

use frfid_signals::random::{normal, stream};
use ndarray::{Array1, ArrayView1};

use crate::friction::find_friction;
use crate::friction::noise_level::noise_level;
use crate::spectra::mean;

const SAMPLE_TIME_S: f64 = 1e-3;
const BAND_HZ: [f64; 2] = [1.0, 60.0];

/// A chirp of 20 s and 1 s of rest.
fn chirp(amplitude_nm: f64) -> Vec<f64> {
    let [low, high] = BAND_HZ;
    let rate = (high / low).ln() / 20.0;
    let torque = |k: usize| {
        let time_s = k as f64 * SAMPLE_TIME_S;
        let turns = low * ((rate * time_s).exp() - 1.0) / rate;
        let is_on = f64::from(u8::from(k < 20_000));
        is_on * amplitude_nm * (std::f64::consts::TAU * turns).sin()
    };
    (0..21_000).map(torque).collect()
}

/// The paper's joint with friction: velocities before each sample, and the torque of the friction, its mean over
/// each sample, by small implicit steps.
fn joint(torque_nm: &[f64], coulomb_nm: f64) -> (Vec<f64>, Vec<f64>) {
    let [motor, link, stiffness, damping] = [35.0, 150.0, 1.5e5, 400.0];
    let steps = 200;
    let step_s = SAMPLE_TIME_S / f64::from(steps);
    let (mut v, mut link_v, mut twist) = (0.0, 0.0, 0.0);
    let mut frictions = Vec::new();
    let mut velocities = Vec::new();
    for u in torque_nm {
        velocities.push(v);
        let mut sum = 0.0;
        for _ in 0..steps {
            let spring = stiffness * twist + damping * (v - link_v);
            let free = v + step_s / motor * (u - spring);
            let friction = (free * motor / step_s).clamp(-coulomb_nm, coulomb_nm);
            let next = free - step_s / motor * friction;
            link_v += step_s / link * spring;
            twist += step_s * (next - link_v);
            v = next;
            sum += friction;
        }
        frictions.push(sum / f64::from(steps));
    }
    (velocities, frictions)
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    (values.clone().map(|value| value * value).sum::<f64>() / values.count() as f64).sqrt()
}

fn with_noise(velocity: &[f64], share: f64, seed: u64) -> Array1<f64> {
    let (mut rng, size) = (stream(seed, "friction", &[]), rms(velocity.iter().copied()));
    velocity
        .iter()
        .map(|y| y + share * size * normal(&mut rng))
        .collect()
}

#[test]
fn friction_is_found_that_was_never_told() {
    for (coulomb_nm, noise, most_off, most_rest) in [
        (50.0, 0.0, 0.001, 0.05),
        (50.0, 0.01, 0.002, 0.15),
        (20.0, 0.01, 0.005, 0.25),
    ] {
        let torque = chirp(150.0);
        let (velocity, friction) = joint(&torque, coulomb_nm);
        let y = with_noise(&velocity, noise, 1);
        let found = find_friction(ArrayView1::from(&torque), y.view(), SAMPLE_TIME_S, BAND_HZ);
        let found = found.expect("friction");
        let off = (found.coulomb_nm / coulomb_nm - 1.0).abs();
        let rest = found.torque_nm.iter().zip(&friction).map(|(a, b)| a - b);
        let rest = rms(rest) / rms(friction.iter().copied());
        println!(
            "F_c {coulomb_nm}, noise {noise}: off by {off:.4}, rest {rest:.3}, {found:?}",
            found = (
                found.coulomb_nm,
                found.motor_inertia_kg_m2,
                found.stuck_share
            )
        );
        assert!(
            off < most_off && rest < most_rest,
            "{coulomb_nm} {noise}: {off} {rest}"
        );
        assert!((found.motor_inertia_kg_m2 / 35.0 - 1.0).abs() < 0.02);
    }
}

/// Beside the noise F_c is off by up to 0.05 %: friction is taken as constant over a sample.
#[test]
fn the_standard_error_of_friction_holds() {
    const SEEDS: u64 = 16;
    for (amplitude_nm, coulomb_nm, noise) in [
        (150.0, 50.0, 0.01),
        (150.0, 20.0, 0.03),
        (300.0, 50.0, 0.01),
    ] {
        let torque = chirp(amplitude_nm);
        let (velocity, _) = joint(&torque, coulomb_nm);
        let errors = (0..SEEDS).filter_map(|seed| {
            let y = with_noise(&velocity, noise, seed);
            let found = find_friction(ArrayView1::from(&torque), y.view(), SAMPLE_TIME_S, BAND_HZ);
            found
                .ok()
                .map(|found| (found.coulomb_nm - coulomb_nm) / found.standard_error_nm)
        });
        let errors: Vec<f64> = errors.collect();
        let n_held = errors.iter().filter(|error| error.abs() < 2.0).count();
        let scatter = rms(errors.iter().map(|error| error - mean(&errors)));
        println!("{amplitude_nm} {coulomb_nm} {noise}: {scatter:.2}, {n_held} held");
        assert!(
            errors.len() > 12 && (0.4..1.3).contains(&scatter),
            "{scatter} {errors:?}"
        );
        assert!(10 * n_held > 7 * errors.len(), "{errors:?}");
    }
}

#[test]
fn what_has_no_friction_is_refused() {
    let torque = chirp(150.0);
    let (velocity, _) = joint(&torque, 0.0);
    let y = Array1::from(velocity);
    let found = find_friction(ArrayView1::from(&torque), y.view(), SAMPLE_TIME_S, BAND_HZ);
    println!(
        "{found:?}",
        found = found.as_ref().map(|found| found.coulomb_nm)
    );
    assert!(found.is_err() || found.expect("some").coulomb_nm < 0.5);
    let short = find_friction(
        ArrayView1::from(&torque[..10]),
        y.slice(ndarray::s![..10]),
        SAMPLE_TIME_S,
        BAND_HZ,
    );
    assert!(short.is_err());
}

#[test]
fn the_noise_of_a_slow_signal_is_told() {
    let slow: Vec<f64> = (0..5000).map(|k| (0.1 * f64::from(k)).sin()).collect();
    let noisy = with_noise(&slow, 0.01, 1);
    let found = noise_level(&noisy.to_vec()) / (0.01 / 2f64.sqrt());
    assert!((found - 1.0).abs() < 0.1, "{found}");
}
