//! Harmonics against their analytic values.

use std::f64::consts::TAU;

use frfid_signals::random::{normal, stream};
use frfid_signals::{Chirp, Harmonics, Profile};
use ndarray::{Array1, ArrayView1, Axis};
use num_complex::Complex64;

use super::*;

const SAMPLE_TIME_S: f64 = 1e-3;

fn chirp(fade_s: f64, tail_s: f64) -> Chirp {
    Chirp {
        low_hz: 1.0,
        high_hz: 60.0,
        duration_s: 20.0,
        amplitude: vec![Profile::constant(2.0)],
        fade_s,
        tail_s,
    }
}

/// A resonance of unit static gain, `y_k + a_1 y_(k-1) + a_2 y_(k-2) = b u_(k-1)`.
struct Resonance {
    b: f64,
    a: [f64; 2],
}

impl Resonance {
    fn at(hz: f64, damping: f64) -> Self {
        let pole =
            Complex64::new(-damping, (1.0 - damping * damping).sqrt()) * (TAU * hz * SAMPLE_TIME_S);
        let pole = pole.exp();
        let a = [-2.0 * pole.re, pole.norm_sqr()];
        Self {
            b: 1.0 + a[0] + a[1],
            a,
        }
    }

    /// Its frequency response.
    fn frf(&self, hz: f64) -> Complex64 {
        let z = Complex64::cis(-TAU * hz * SAMPLE_TIME_S);
        self.b * z / (1.0 + self.a[0] * z + self.a[1] * z * z)
    }

    fn next(&self, u: f64, before: &mut [f64; 2]) -> f64 {
        let y = self.b * u - self.a[0] * before[0] - self.a[1] * before[1];
        *before = [y, before[0]];
        y
    }

    fn answer(&self, u: &[f64]) -> Array1<f64> {
        let mut before = [0.0; 2];
        let delayed = [0.0].into_iter().chain(u.iter().copied()).take(u.len());
        delayed.map(|u| self.next(u, &mut before)).collect()
    }
}

fn bent(u: f64) -> f64 {
    u + 0.05 * u.powi(2) + 0.03 * u.powi(3) + 0.004 * u.powi(4) + 0.002 * u.powi(5)
}

/// Harmonics of `bent` of a sine of amplitude 2 in the form `sum |X_n| sin(n phi + arg X_n)`: powers of a sine.
fn bent_harmonics() -> [Complex64; 5] {
    let powers = |k: i32, part: f64| 2.0_f64.powi(k) * part;
    let even = Complex64::new(0.0, -1.0); // -cos 2 phi = sin(2 phi - pi/2)
    [
        (powers(1, 1.0) + 0.03 * powers(3, 0.75) + 0.002 * powers(5, 0.625)).into(),
        even * (0.05 * powers(2, 0.5) + 0.004 * powers(4, 0.5)),
        (-0.03 * powers(3, 0.25) - 0.002 * powers(5, 0.3125)).into(),
        -even * (0.004 * powers(4, 0.125)),
        (0.002 * powers(5, 0.0625)).into(),
    ]
}

fn harmonics_of(chirp: &Chirp, runs: &[(ArrayView1<f64>, ArrayView1<f64>)]) -> Harmonics {
    let n_samples = runs[0].0.len();
    let planned = ChirpHarmonics::new(chirp, SAMPLE_TIME_S, n_samples).expect("sound");
    let of_run = |(period, (u, y)): (usize, &(ArrayView1<f64>, ArrayView1<f64>))| {
        let place = PeriodIndex {
            realization: 0,
            period,
            experiment: 0,
        };
        let spectra = planned.spectra(u.insert_axis(Axis(0)), y.insert_axis(Axis(0)));
        (place, spectra.expect("sound"))
    };
    let runs: Vec<_> = runs.iter().enumerate().map(of_run).collect();
    planned.harmonics(&runs).expect("there are runs")
}

fn input(chirp: &Chirp) -> Array1<f64> {
    let n_samples = ((chirp.duration_s + chirp.tail_s) / SAMPLE_TIME_S) as usize;
    Array1::from(chirp.harmonic(1, SAMPLE_TIME_S, n_samples)) * 2.0
}

/// Worst error in dB of the order at `place` between two frequencies, all of which must be known.
fn worst_db(
    found: &Harmonics,
    place: usize,
    [low, high]: [f64; 2],
    expected: impl Fn(f64) -> Complex64,
) -> f64 {
    let response = found.response.as_ref().expect("one input, one output");
    let lines = found.frequency_hz.iter().enumerate();
    let within = lines.filter(|(_, hz)| (low..=high).contains(*hz));
    let error = |(line, hz): (usize, &f64)| {
        let ratio = response[[place, line]] / expected(*hz);
        assert!(!ratio.is_nan(), "order {} at {hz} Hz", place + 1);
        20.0 * (1.0 + (ratio - 1.0).norm()).log10()
    };
    within.map(error).fold(0.0, f64::max)
}

/// A nonlinearity before a resonance: known orders through a known FRF.
#[test]
fn harmonics_of_a_hammerstein_system_are_its_chebyshev_coefficients_through_its_frf() {
    for (hz, damping) in [(25.0, 0.3), (11.0, 0.03), (11.0, 0.01)] {
        let (chirp, plant) = (chirp(0.0, 0.0), Resonance::at(hz, damping));
        let u = input(&chirp);
        let y = plant.answer(&u.mapv(bent).to_vec());
        let found = harmonics_of(&chirp, &[(u.view(), y.view())]);
        for (place, known) in bent_harmonics().iter().enumerate() {
            let order = place as f64 + 1.0;
            let expected = |hz: f64| known / 2.0 * plant.frf(order * hz);
            let worst = worst_db(&found, place, [1.25, 58.0], expected);
            assert!(worst < 0.1, "order {order}, {hz} Hz: {worst} dB");
        }
        assert!(found.output.deviation.is_none());
    }
}

/// A fade ends orders otherwise than the fundamental: the first and last tenths of the band, and where orders pass
/// the end of stronger ones, are less exact.
#[test]
fn fades_cost_accuracy_at_the_ends_alone() {
    let (chirp, plant) = (chirp(0.2, 2.0), Resonance::at(11.0, 0.03));
    let u = input(&chirp);
    let y = plant.answer(&u.mapv(bent).to_vec());
    let found = harmonics_of(&chirp, &[(u.view(), y.view())]);
    for (place, known) in bent_harmonics().iter().enumerate().take(3) {
        let order = place as f64 + 1.0;
        let worst = worst_db(&found, place, [1.3, 50.0], |hz| {
            known / 2.0 * plant.frf(order * hz)
        });
        assert!(worst < 0.5, "order {order}: {worst} dB");
    }
}

#[test]
fn a_linear_machine_has_none_and_noise_has_a_deviation() {
    let (chirp, plant) = (chirp(0.0, 0.0), Resonance::at(11.0, 0.03));
    let u = input(&chirp);
    let y = plant.answer(&u.to_vec());
    let found = harmonics_of(&chirp, &[(u.view(), y.view())]);
    for place in 1..5 {
        let levels = found.output.level_db(0, place);
        assert!(
            levels.iter().all(|level| level.is_nan() || *level <= -80.0),
            "{levels:?}"
        );
    }
    let noisy = |seed: u64| {
        let mut rng = stream(seed, "noise", &[]);
        y.mapv(|y| y + 0.01 * normal(&mut rng))
    };
    let (first, second) = (noisy(1), noisy(2));
    let found = harmonics_of(
        &chirp,
        &[(u.view(), first.view()), (u.view(), second.view())],
    );
    let deviation = found.output.deviation.as_ref().expect("two runs");
    assert!(deviation.iter().any(|deviation| *deviation > 0.0));
    let levels = found.output.levels(0, &found.orders);
    assert!(levels.iter().all(|level| level.is_bound), "{levels:?}");
}

/// `y = G (u + 0.03 u^3)`, `u = r - y/2`: the loop puts harmonics into u, too.
#[test]
fn in_closed_loop_what_the_plant_adds_is_told_from_what_the_input_has() {
    let (chirp, plant) = (chirp(0.0, 0.0), Resonance::at(25.0, 0.8));
    let (mut before, mut y) = ([0.0; 2], 0.0);
    let step = |r: &f64| {
        let u = r - 0.5 * y;
        let now = y;
        y = plant.next(u + 0.03 * u.powi(3), &mut before);
        (u, now)
    };
    let (u, y): (Vec<f64>, Vec<f64>) = input(&chirp).iter().map(step).unzip();
    let (u, y) = (Array1::from(u), Array1::from(y));
    let found = harmonics_of(&chirp, &[(u.view(), y.view())]);
    let response = found.response.as_ref().expect("one input, one output");
    for (line, hz) in found
        .frequency_hz
        .iter()
        .enumerate()
        .filter(|(_, hz)| (1.3..=19.0).contains(*hz))
    {
        let amplitude = found.input.amplitude[[0, 0, line]];
        let expected = -0.03 * amplitude.powi(2) * 0.25 * plant.frf(3.0 * hz);
        let ratio = response[[2, line]] / expected;
        let second_order = 20.0 * (1.0 + (ratio - 1.0).norm()).log10();
        assert!(second_order < 1.5, "{hz} Hz: {second_order} dB");
        assert!(found.input.level_db(0, 2)[line] > -60.0);
    }
    let beyond = found
        .frequency_hz
        .iter()
        .position(|hz| *hz > 21.0)
        .expect("in the band");
    assert!(
        response[[2, beyond]].re.is_nan(),
        "G is not known at three times that"
    );
}
