//! Multisine: one factor for all channels, power on the excited lines alone, and what is refused.

use std::cell::Cell;
use std::f64::consts::TAU;

use ndarray::{Axis, indices, s};
use num_complex::Complex64;

use crate::error::SignalError;
use crate::excitation::grid::{GridDesign, GridKind, LineGrid};
use crate::excitation::multisine::{Multisine, Phases};
use crate::excitation::phasing::Phasing;
use crate::excitation::profile::Profile;
use crate::excitation::waveform::{Draw, Waveform};
use crate::number::power::sample_peak;

fn multisine(peak: &[f64]) -> Multisine {
    let grid = GridDesign {
        low_hz: 1.0,
        high_hz: 60.0,
        sample_time_s: 1e-3,
        resolution_hz: 0.1,
        n_lines: Some(80),
        kind: GridKind::Odd,
        seed: 0,
    };
    Multisine {
        grid: grid.design().expect("sound"),
        shape: Profile::constant(1.0),
        phases: Phases::Random,
        peak: peak.to_vec(),
    }
}

const DRAW: Draw = Draw {
    seed: 1,
    realization: 0,
    phasing: Phasing::Orthogonal,
};

#[test]
fn one_factor_serves_all_and_no_channel_exceeds_its_peak() {
    let peaks = [150.0, 100.0, 50.0];
    for phasing in [Phasing::Orthogonal, Phasing::SignFlip, Phasing::Independent] {
        let realization = multisine(&peaks)
            .realize(&Draw { phasing, ..DRAW })
            .expect("sound");
        let reached = realization
            .peak
            .iter()
            .zip(peaks)
            .map(|(reached, limit)| reached / limit)
            .fold(0.0, f64::max);
        assert!(
            (reached - 1.0).abs() < 1e-12,
            "the largest channel touches its peak: {reached}"
        );
        for (channel, &peak) in realization.peak.iter().enumerate() {
            for experiment in 0..3 {
                assert!(
                    sample_peak(
                        &realization
                            .signal
                            .slice(s![experiment, channel, ..])
                            .to_vec()
                    ) <= peak * (1.0 + 1e-12)
                );
            }
        }
    }
}

#[test]
fn a_period_is_the_signal_of_the_realization_to_the_bit() {
    for phasing in [
        Phasing::Orthogonal,
        Phasing::SignFlip,
        Phasing::Independent,
        Phasing::AllAtOnce,
        Phasing::Zippered,
        Phasing::OneAtATime,
    ] {
        let (multisine, draw) = (multisine(&[150.0, 100.0, 50.0]), Draw { phasing, ..DRAW });
        let period = multisine.period(1e-3, 3, &draw, &|| true);
        let realization = multisine.realize(&draw).expect("sound");
        assert_eq!(period.expect("sound"), realization.signal, "{phasing:?}");
    }
}

#[test]
fn only_the_excited_lines_carry_power_and_channels_differ_by_the_phasing() {
    let signal = multisine(&[1.0, 1.0, 1.0])
        .realize(&DRAW)
        .expect("sound")
        .signal;
    let n = signal.len_of(Axis(2));
    let line = |experiment: usize, channel: usize, k: usize| {
        let row = signal.slice(s![experiment, channel, ..]);
        row.iter()
            .enumerate()
            .map(|(i, x)| x * Complex64::cis(-TAU * ((k * i) % n) as f64 / n as f64))
            .sum::<Complex64>()
            * 2.0
            / n as f64
    };
    let amplitude = line(0, 0, 13).norm();
    assert!(line(0, 0, 14).norm() < 1e-13 && (line(2, 1, 737).norm() - amplitude).abs() < 1e-13);
    let turn = line(2, 1, 13) / line(0, 0, 13);
    assert!((turn - Complex64::cis(Phasing::Orthogonal.phase_rad(1, 2, 3))).norm() < 1e-10);
}

#[test]
fn the_shape_sets_the_ratios_of_the_lines() {
    let shaped = Multisine {
        shape: Profile {
            points: vec![(30.0, 2.0), (40.0, 1.0)],
        },
        ..multisine(&[1.0])
    };
    let signal = shaped.realize(&DRAW).expect("sound").signal;
    let row: Vec<f64> = signal.iter().copied().collect();
    let n = row.len();
    let line = |k: usize| {
        row.iter()
            .enumerate()
            .map(|(i, x)| x * Complex64::cis(-TAU * ((k * i) % n) as f64 / n as f64))
            .sum::<Complex64>()
            .norm()
    };
    assert!((line(13) / line(737) - 2.0).abs() < 1e-9);
}

#[test]
fn one_at_a_time_every_experiment_has_one_channel_at_its_peak() {
    let draw = Draw {
        phasing: Phasing::OneAtATime,
        ..DRAW
    };
    let drawn = multisine(&[3.0, 1.0]).realize(&draw).expect("sound");
    assert!(
        drawn
            .peak
            .iter()
            .zip([3.0, 1.0])
            .all(|(peak, limit)| (peak - limit).abs() < 1e-12)
    );
    for ((experiment, channel), row) in indices((2, 2)).into_iter().zip(drawn.signal.rows()) {
        assert_eq!(row.iter().any(|r| *r != 0.0), experiment == channel);
    }
}

#[test]
fn zippered_every_line_is_excited_in_one_channel() {
    let draw = Draw {
        phasing: Phasing::Zippered,
        ..DRAW
    };
    let zippered = multisine(&[3.0, 1.0]);
    let drawn = zippered.realize(&draw).expect("sound");
    assert_eq!(drawn.signal.dim().0, 1);
    let powers = drawn.signal.rows().into_iter().map(|row| {
        let power = |&line: &usize| {
            let n = row.len();
            let turn = |i: usize| Complex64::cis(-TAU * ((line * i) % n) as f64 / n as f64);
            let sum: Complex64 = row.iter().enumerate().map(|(i, x)| x * turn(i)).sum();
            sum.norm()
        };
        zippered.grid.excited.iter().map(power).collect::<Vec<_>>()
    });
    let powers: Vec<Vec<f64>> = powers.collect();
    for (place, (first, second)) in powers[0].iter().zip(&powers[1]).enumerate() {
        let (on, off) = if place % 2 == 0 {
            (first, second)
        } else {
            (second, first)
        };
        assert!(on * 1e-9 > *off, "{place}: {on} and {off}");
    }
    let few = Multisine {
        grid: LineGrid {
            excited: vec![13],
            ..zippered.grid.clone()
        },
        ..zippered
    };
    let error = few.realize(&draw).expect_err("one line for two inputs");
    assert!(
        error.to_string().contains("no line is left for input 2"),
        "{error}"
    );
}

#[test]
fn bad_peaks_and_shapes_are_refused() {
    for peak in [vec![], vec![0.0], vec![f64::NAN], vec![1.0, -1.0]] {
        let error = multisine(&peak).realize(&DRAW).expect_err("a bad peak");
        assert_eq!(error.path(), ["peak"]);
    }
    let silent = Multisine {
        shape: Profile::constant(0.0),
        ..multisine(&[1.0])
    };
    assert!(matches!(
        silent.realize(&DRAW),
        Err(SignalError::Derived { key: "shape", .. })
    ));
}

#[test]
fn phases_for_a_low_crest_factor_end_where_somebody_says_so() {
    let low_crest = Multisine {
        phases: Phases::LowCrest,
        ..multisine(&[150.0])
    };
    let asked = Cell::new(0);
    let go_on = || {
        asked.set(asked.get() + 1);
        asked.get() < 7
    };
    let ended = low_crest.realize_while(&DRAW, &go_on);
    assert_eq!(ended.expect_err("ended"), SignalError::Interrupted);
    assert_eq!(asked.get(), 7);
}

#[test]
fn signals_that_cannot_be_held_are_refused() {
    let refused = |multisine: &Multisine, phasing| {
        let error = multisine.realize(&Draw { phasing, ..DRAW });
        let error = error.expect_err("cannot be held");
        error.path().join(".")
    };
    let many = multisine(&vec![1.0; 1001]);
    assert_eq!(refused(&many, Phasing::Orthogonal), "n_inputs");
    let wide = multisine(&[1.0; 200]);
    assert_eq!(refused(&wide, Phasing::Orthogonal), "n_inputs");
    let mut long = multisine(&[1.0; 3]);
    long.grid.n_samples = 1 << 26;
    assert_eq!(refused(&long, Phasing::AllAtOnce), "n_samples");
    long.grid.n_samples = 1 << 27;
    assert_eq!(refused(&long, Phasing::Orthogonal), "n_samples");
}
