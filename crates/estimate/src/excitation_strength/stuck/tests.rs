//! Sticking of a mass with Coulomb friction, read by sensors of all kinds.

use std::f64::consts::TAU;

use frfid_signals::random::{normal, phase, stream};
use frfid_signals::{InputKind, Record};
use ndarray::Array2;

use super::{Readings, standing_share, stuck_samples};

const N: usize = 16_384;

/// True velocity in rad/s and position in rad at 1 kHz of a mass of 1 kg m^2 that is driven by a
/// multisine of 2 to 60 Hz and 50 N m rms about a torque, and by viscous friction held near a velocity.
fn motion(coulomb_nm: f64, mean_nm: f64) -> (Vec<f64>, Vec<f64>) {
    const SUBSTEPS: usize = 10;
    let mut rng = stream(1, "motion", &[]);
    let lines: Vec<(f64, f64)> = (8..246)
        .step_by(2)
        .map(|line| (f64::from(line), phase(&mut rng)))
        .collect();
    let scale = 50.0 * (2.0 / lines.len() as f64).sqrt();
    let (mut v, mut q) = (0.0_f64, 0.0);
    let sample = |k: usize| {
        let seconds = k as f64 / 4096.0;
        let terms = lines
            .iter()
            .map(|&(line, phase)| (TAU * line * seconds + phase).cos());
        let torque = mean_nm + scale * terms.sum::<f64>();
        let read = (v, q);
        for _ in 0..SUBSTEPS {
            let step = 1e-3 / SUBSTEPS as f64;
            let free = v + step * (torque - 5.0 * v);
            let friction = step * coulomb_nm;
            let next = free.signum() * (free.abs() - friction).max(0.0);
            v = if next * v < 0.0 { 0.0 } else { next };
            q += step * v;
        }
        read
    };
    (0..N).map(sample).unzip()
}

/// A record with noise of these rms on velocity and position, and an encoder of this increment, by which
/// the velocity is differenced if it is not 0.
fn record((v, q): &(Vec<f64>, Vec<f64>), noise: [f64; 2], increment: f64) -> Record {
    let mut rng = stream(2, "readings", &[]);
    let mut noisy = |x: &f64, rms: f64| {
        if rms > 0.0 {
            x + rms * normal(&mut rng)
        } else {
            *x
        }
    };
    let mut y: Vec<f64> = v.iter().map(|v| noisy(v, noise[0])).collect();
    let mut position: Vec<f64> = q.iter().map(|q| noisy(q, noise[1])).collect();
    if increment > 0.0 {
        position
            .iter_mut()
            .for_each(|q| *q = increment * (*q / increment).round());
        y = (0..N)
            .map(|k| 1e3 * (position[k] - position[k.saturating_sub(1)]))
            .collect();
    }
    let row = |samples: Vec<f64>| Array2::from_shape_vec((1, N), samples).expect("one row");
    Record {
        sample_time_s: 1e-3,
        u: row(vec![0.0; N]),
        y: row(y),
        r: None,
        position_rad: Some(row(position)),
        input_kind: InputKind::Commanded,
        events: Vec::new(),
    }
}

fn share(record: &Record) -> Option<f64> {
    Readings::of(record, 0).stuck_share(0..N)
}

fn without_position(record: &Record) -> Option<f64> {
    let record = Record {
        position_rad: None,
        ..record.clone()
    };
    share(&record)
}

/// Share of the samples in which any reading repeats, whatever the reason.
fn repeating(record: &Record) -> f64 {
    let stuck = stuck_samples(record, 0.0);
    stuck.iter().filter(|&&stuck| stuck).count() as f64 / N as f64
}

#[test]
fn ideal_readings_tell_exactly() {
    for coulomb_nm in [0.0, 20.0, 50.0, 90.0] {
        let ideal = record(&motion(coulomb_nm, 0.0), [0.0; 2], 0.0);
        let stuck = Some(repeating(&ideal));
        assert_eq!([share(&ideal), without_position(&ideal)], [stuck; 2]);
        assert_eq!(standing_share(ideal.y.row(0)), stuck);
    }
    let mut rests = motion(50.0, 0.0);
    for k in N / 8..N {
        rests.1[k] = rests.1[N / 8]; // for most of the parts of the run
    }
    rests.0[N / 8..].fill(0.0);
    let stuck = share(&record(&rests, [0.0; 2], 0.0)).expect("ideal");
    assert!((0.92..0.95).contains(&stuck), "{stuck}");
    let never_moved = record(&motion(1e4, 0.0), [0.0; 2], 0.0);
    assert_eq!(share(&never_moved), None, "an encoder of any step");
}

#[test]
fn noise_hides_what_is_stuck_and_is_not_taken_for_motion() {
    for coulomb_nm in [20.0, 50.0, 90.0] {
        let true_motion = motion(coulomb_nm, 0.0);
        for noise in [[1e-9, 1e-12], [1e-6, 1e-9], [1e-3, 1e-6], [1.0, 1e-3]] {
            let both = record(&true_motion, noise, 0.0);
            assert_eq!(
                [share(&both), without_position(&both)],
                [None; 2],
                "{noise:?}"
            );
            let velocity = record(&true_motion, [noise[0], 0.0], 0.0);
            assert_eq!(standing_share(velocity.y.row(0)), None, "{noise:?}");
            let stuck = share(&velocity).expect("the position tells");
            assert!((stuck - repeating(&velocity)).abs() < 1e-12 && stuck > 0.04);
            let flickering = record(&true_motion, [0.0, 1e-7], 1e-7);
            assert_eq!(share(&flickering), None);
        }
    }
}

#[test]
fn a_motion_clearly_away_from_standstill_is_never_stuck() {
    let (gliding, free) = (motion(20.0, 400.0), motion(0.0, 0.0));
    for noise in [1e-6, 1e-3, 0.1] {
        let glide = record(&gliding, [noise, 1e-3 * noise], 0.0);
        assert_eq!(share(&glide), Some(0.0), "{noise}");
    }
    assert_eq!(share(&record(&free, [1e-6, 1e-9], 0.0)), Some(0.0));
    assert_eq!(share(&record(&free, [1.0, 1e-3], 0.0)), None);
}

#[test]
fn an_encoder_too_coarse_for_the_motion_tells_nothing() {
    for coulomb_nm in [0.0, 20.0, 50.0, 90.0] {
        let true_motion = motion(coulomb_nm, 0.0);
        // but for a sample at the begin of each stick, in which the velocity is 0 already
        let truth = repeating(&record(&true_motion, [0.0; 2], 0.0));
        for increment in [1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1] {
            let read = record(&true_motion, [0.0; 2], increment);
            for told in [share(&read), without_position(&read)] {
                let error = told.map_or(0.0, |told| (told - truth).abs());
                assert!(error < 0.04, "{coulomb_nm} {increment}: {told:?}, {truth}");
                assert!(
                    told.is_none() || increment < 1e-3,
                    "{coulomb_nm} {increment}"
                );
            }
            assert!(coulomb_nm < 50.0 || increment > 1e-6 || share(&read).is_some());
        }
    }
}
