//! The stated 95 % region of recordings that are not as in a textbook: with holes, at uneven times,
//! drifting, with slow transients. A thousand recordings of each kind, through files and the whole
//! chain.

use std::f64::consts::TAU;
use std::fmt::Write;

use frfid::experiment::{EstimateOptions, estimate_logs, silent};
use frfid::files::{LogMap, Signal};
use frfid::signals::random::{normal, phase, stream};
use num_complex::Complex64;

const LINES: [usize; 6] = [1, 3, 5, 7, 11, 13];
const PERIOD: usize = 64;
const PERIODS: usize = 6;
const RUNS: u64 = 1000;

/// A low-pass with a delay of its own.
fn frf(line: usize) -> Complex64 {
    1.0 / Complex64::new(1.0, 0.2 * line as f64)
}

/// What a recorder and a machine do to a recording.
#[derive(Default, Clone, Copy)]
struct Case {
    /// Share of the rows that are lost.
    lost: f64,
    /// Deviation of the sample times, in samples.
    uneven: f64,
    /// Drift of the output over a period, over its rms.
    drift: f64,
    /// Size of a decay at the start over the rms of the output, and its time constant in periods.
    decay: (f64, f64),
}

/// A recording as CSV.
fn recording(case: Case, seed: u64) -> String {
    let mut chance = stream(seed, "recording", &[]);
    let phases: Vec<f64> = LINES.iter().map(|_| phase(&mut chance)).collect();
    let mut text = String::from("t,u,y\n");
    for row in 0..PERIOD * PERIODS {
        let uniform = |chance: &mut _| phase(chance) / TAU;
        let time = row as f64 + case.uneven * (2.0 * uniform(&mut chance) - 1.0);
        let is_lost = uniform(&mut chance) < case.lost && row > 0;
        let noise = 0.1 * normal(&mut chance);
        let (mut u, mut y) = (0.0, noise);
        for (&line, phase) in LINES.iter().zip(&phases) {
            let turn = Complex64::cis(TAU * line as f64 * time / PERIOD as f64 + phase);
            u += turn.re;
            y += (frf(line) * turn).re;
        }
        let periods = time / PERIOD as f64;
        let rms = 0.9; // of the output, by and large
        y +=
            rms * (case.drift * periods + case.decay.0 * (-periods / case.decay.1.max(1e-9)).exp());
        if !is_lost {
            writeln!(text, "{time:.9},{u:.12},{y:.12}").expect("a text takes all");
        }
    }
    text
}

/// Share of the lines whose 95 % region holds the truth, and how many there should be.
fn coverage(case: Case) -> f64 {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("recording.csv");
    let (mut inside, mut all) = (0, 0);
    for seed in 0..RUNS {
        std::fs::write(&path, recording(case, seed)).expect("written");
        let outcome =
            estimate_logs(std::slice::from_ref(&path), &options(), &silent).expect("sound");
        let frf_found = &outcome.result.frf;
        let noise = frf_found.noise.as_ref().expect("several periods");
        let factor = noise.degrees_of_freedom;
        let quantile = factor * (0.05_f64.powf(-1.0 / factor) - 1.0);
        for (place, &line) in LINES.iter().enumerate() {
            let error = (frf_found.response[[place, 0, 0]] - frf(line)).norm_sqr();
            inside += usize::from(error <= quantile * noise.covariance[[place, 0, 0]].re);
            all += 1;
        }
    }
    assert_eq!(all, LINES.len() * RUNS as usize);
    inside as f64 / all as f64
}

fn options() -> EstimateOptions {
    let signal = Signal::of;
    let map = LogMap {
        time: Some(signal("t", "s")),
        ..LogMap::new(vec![signal("u", "N m")], vec![signal("y", "rad/s")])
    };
    EstimateOptions {
        map: Some(map),
        ..EstimateOptions::default()
    }
}

fn holds(name: &str, case: Case) {
    let share = coverage(case);
    println!("{name}: the 95 % region holds {:.1} %", 100.0 * share);
    assert!((0.93..=0.97).contains(&share), "{name}: {share}");
}

#[test]
fn of_a_sound_recording() {
    holds("sound", Case::default());
}

#[test]
fn with_holes() {
    for lost in [0.075, 0.3] {
        let case = Case {
            lost,
            ..Case::default()
        };
        holds(&format!("{lost} lost"), case);
    }
}

#[test]
fn at_uneven_times() {
    let case = Case {
        uneven: 0.2,
        ..Case::default()
    };
    holds("uneven", case);
}

#[test]
fn with_drift() {
    for drift in [0.03, 0.1, 1.0] {
        let case = Case {
            drift,
            ..Case::default()
        };
        holds(&format!("drift {drift}"), case);
    }
}

#[test]
fn with_slow_transients() {
    for decay in [(0.3, 2.0), (1.0, 3.0), (1.0, 10.0)] {
        let case = Case {
            decay,
            ..Case::default()
        };
        holds(&format!("decay {decay:?}"), case);
    }
}
