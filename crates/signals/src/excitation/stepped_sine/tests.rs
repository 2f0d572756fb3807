//! Stepped sine: what is measured at every frequency, rest at both ends, and what is refused.

use std::f64::consts::TAU;

use ndarray::s;

use crate::excitation::phasing::Phasing;
use crate::excitation::profile::Profile;
use crate::excitation::stepped_sine::SteppedSine;
use crate::excitation::waveform::{Draw, GoOn, Waveform};
use crate::number::spacing::log_spaced;

const T: f64 = 1e-3;
const GO_ON: GoOn = &|| true;
const DRAW: Draw = Draw {
    seed: 0,
    realization: 0,
    phasing: Phasing::SignFlip,
};

fn stepped() -> SteppedSine {
    let points = vec![(2.0, 100.0), (50.0, 20.0)];
    SteppedSine {
        low_hz: 1.0,
        high_hz: 60.0,
        n_frequencies: 17,
        amplitude: vec![Profile { points }],
        ramp_s: 0.3,
        settle_s: 0.4,
        periods: 3,
        measure_s: 0.25,
    }
}

#[test]
fn every_frequency_is_measured_over_whole_periods_at_its_amplitude() {
    let (stepped, signal) = (
        stepped(),
        stepped().period(T, 1, &DRAW, GO_ON).expect("sound"),
    );
    let dwells = stepped.dwells(T).expect("sound");
    assert_eq!(dwells.len(), 17);
    for (dwell, asked) in dwells.iter().zip(log_spaced(1.0, 60.0, 17).expect("sound")) {
        let n = dwell.measured.len() as f64;
        assert!((dwell.hz / asked - 1.0).abs() < 0.5 / n + 1e-12);
        assert!(dwell.periods >= 3 && n * T >= 0.25 - T);
        let window = signal.slice(s![0, 0, dwell.measured.clone()]);
        let turn = |k: usize| TAU * (dwell.periods * k) as f64 / n;
        let part = |of: fn(f64) -> f64| {
            let terms = window.iter().enumerate().map(|(k, r)| r * of(turn(k)));
            2.0 / n * terms.sum::<f64>()
        };
        let amplitude = part(f64::cos).hypot(part(f64::sin));
        assert!((amplitude / stepped.amplitude[0].at(dwell.hz) - 1.0).abs() < 1e-10);
        let power = window.iter().map(|r| r * r).sum::<f64>() / n;
        assert!(
            (2.0 * power / amplitude.powi(2) - 1.0).abs() < 1e-10,
            "one line and no other"
        );
    }
}

#[test]
fn it_starts_and_ends_at_rest_and_never_jumps() {
    let stepped = stepped();
    let signal = stepped.period(T, 1, &DRAW, GO_ON).expect("sound");
    let signal = signal.slice(s![0, 0, ..]).to_vec();
    assert_eq!(Some(signal.len()), stepped.period_samples(T).ok());
    assert_eq!(signal[0], 0.0);
    assert!(signal[signal.len() - 1].abs() < 1e-2);
    let largest = signal
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .fold(0.0, f64::max);
    // amplitude 100 at 2 Hz, 20 at 60 Hz: no slope exceeds what lies between
    assert!(largest < TAU * 20.0 * 60.0 * T * 1.7, "{largest}");
}

#[test]
fn inputs_differ_by_the_phasing() {
    let of = |phasing| {
        stepped()
            .period(T, 3, &Draw { phasing, ..DRAW }, GO_ON)
            .expect("sound")
    };
    let (flipped, single) = (of(Phasing::SignFlip), of(Phasing::OneAtATime));
    assert_eq!(flipped.slice(s![0, 1, ..]), single.slice(s![1, 1, ..]));
    assert!(
        (&flipped.slice(s![1, 1, ..]) + &flipped.slice(s![0, 1, ..]))
            .iter()
            .all(|x| x.abs() < 1e-9)
    );
    assert!(single.slice(s![1, 2, ..]).iter().all(|r| *r == 0.0));
    let error = stepped().period(
        T,
        1,
        &Draw {
            phasing: Phasing::Independent,
            ..DRAW
        },
        GO_ON,
    );
    assert_eq!(error.expect_err("no lines").path(), ["mimo"]);
}

#[test]
fn bands_are_passed_one_after_the_other_and_leave_no_frequency_out() {
    let stepped = stepped();
    let dwells = stepped.dwells(T).expect("sound");
    let bands = [[1.0, 3.0], [3.0, 17.0], [17.0, 60.0]];
    let seconds = bands.map(|band| stepped.seconds_in(band, T).expect("passed"));
    let end_s = dwells[16].measured.end as f64 * T;
    assert_eq!((seconds[0][0], seconds[2][1]), (0.0, end_s));
    assert!(seconds.windows(2).all(|pair| pair[0][1] == pair[1][0]));
    assert_eq!(stepped.seconds_in([1.01, 1.02], T), Some([0.0, 0.0]));
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let refused = |change: &dyn Fn(&mut SteppedSine)| {
        let mut stepped = stepped();
        change(&mut stepped);
        let error = stepped
            .period(T, 1, &DRAW, GO_ON)
            .expect_err("out of range");
        error
            .path()
            .last()
            .map(|&key| key.to_owned())
            .unwrap_or_default()
    };
    assert_eq!(refused(&|s| s.high_hz = 500.0), "high_hz");
    assert_eq!(refused(&|s| s.high_hz = 0.5), "high_hz");
    assert_eq!(refused(&|s| s.low_hz = -1.0), "low_hz");
    assert_eq!(refused(&|s| s.low_hz = 1e-9), "low_hz");
    assert_eq!(refused(&|s| s.n_frequencies = 1), "n_frequencies");
    assert_eq!(refused(&|s| s.n_frequencies = 5000), "n_frequencies");
    assert_eq!(refused(&|s| s.n_frequencies = usize::MAX), "n_frequencies");
    assert_eq!(refused(&|s| s.periods = 0), "periods");
    assert_eq!(refused(&|s| s.ramp_s = f64::NAN), "ramp_s");
    assert_eq!(refused(&|s| s.settle_s = f64::INFINITY), "settle_s");
    assert_eq!(refused(&|s| s.measure_s = -1.0), "measure_s");
    assert_eq!(refused(&|s| s.amplitude = vec![]), "amplitude");
}
