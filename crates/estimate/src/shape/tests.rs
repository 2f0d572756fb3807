//! Shaping on a small simulated machine: two coupled inertias under velocity control, with or
//! without friction.

use std::f64::consts::TAU;

use frfid_signals::{
    Chirp, Event, EventKind, Excess, InputKind, Limit, Limits, Peaks, Phasing, Profile, Record,
    Run, Testbed, TestbedError,
};
use ndarray::{Array2, Array3, Axis};

use crate::shape::limits::KEPT;
use crate::shape::note::Note;
use crate::shape::options::{Step, Target};
use crate::shape::summary::Stop;
use crate::shape::*;
use crate::testing::refusal;

const SAMPLE_TIME_S: f64 = 4e-3;

/// `M y' = u - c y - friction`, `u = K (r - y)`; friction only where it does not stop the motion
/// within a sample.
#[derive(Clone)]
struct Machine {
    coulomb_nm: f64,
    /// Gains; 0 for a motor that is switched off.
    gain: [f64; 2],
    /// Torque in N m at which a run is stopped.
    trips_at_nm: f64,
}

const SOUND: Machine = Machine {
    coulomb_nm: 0.0,
    gain: [60.0, 40.0],
    trips_at_nm: f64::INFINITY,
};

impl Testbed for Machine {
    fn n_inputs(&self) -> usize {
        2
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        let n_samples = run.reference.ncols();
        let mut signals = [0; 3].map(|_| Array2::zeros((2, n_samples)));
        let (mut y, mut q, mut events, mut end) = ([0.0; 2], [0.0; 2], Vec::new(), n_samples);
        for k in 0..n_samples {
            let u = [0, 1].map(|axis| self.gain[axis] * (run.reference[[axis, k]] - y[axis]));
            for (signal, value) in signals.iter_mut().zip([u, y, q]) {
                (0..2).for_each(|axis| signal[[axis, k]] = value[axis]);
            }
            if u.iter().any(|u| u.abs() > self.trips_at_nm) {
                let kind = EventKind::Stopped {
                    reason: "tripped".into(),
                    since_s: None,
                };
                events.push(Event {
                    time_s: k as f64 * run.sample_time_s,
                    kind,
                });
                end = k + 1;
                break;
            }
            // inverse of M = [[2, 0.5], [0.5, 1]]
            let pull = [0, 1].map(|axis| u[axis] - 5.0 * y[axis]);
            let free = [
                (pull[0] - 0.5 * pull[1]) / 1.75,
                (2.0 * pull[1] - 0.5 * pull[0]) / 1.75,
            ];
            for axis in 0..2 {
                let free = y[axis] + run.sample_time_s * free[axis];
                q[axis] += run.sample_time_s * y[axis];
                y[axis] =
                    free.signum() * (free.abs() - run.sample_time_s * self.coulomb_nm).max(0.0);
            }
        }
        let [u, y, q] = signals.map(|signal| signal.slice(ndarray::s![.., ..end]).to_owned());
        let input_kind = InputKind::Commanded;
        Ok(Record {
            sample_time_s: run.sample_time_s,
            u,
            y,
            r: None,
            position_rad: Some(q),
            input_kind,
            events,
        })
    }
}

fn chirp(amplitude: f64) -> Array3<f64> {
    let amplitude = vec![Profile::constant(amplitude)];
    let chirp = Chirp {
        low_hz: 1.0,
        high_hz: 20.0,
        duration_s: 12.0,
        amplitude,
        fade_s: 0.25,
        tail_s: 2.0,
    };
    chirp
        .sample(SAMPLE_TIME_S, 2, Phasing::Orthogonal)
        .expect("a sound chirp")
}

fn options() -> ShapeOptions {
    ShapeOptions {
        low_hz: 1.0,
        high_hz: 20.0,
        sample_time_s: SAMPLE_TIME_S,
        n_iterations: 12,
        good_enough: 0.03, // beginning at rest costs 2.7 % at the lowest lines of this short sweep
        ..ShapeOptions::default()
    }
}

fn shaped(
    machine: &Machine,
    desired: f64,
    start: f64,
    options: ShapeOptions,
) -> Result<Shaped, ShapeError> {
    shape(machine, chirp(desired), chirp(start), options, &mut |_| {
        Ok(true)
    })
}

fn keeps(peaks: &Peaks, limits: &Limits) -> bool {
    let reached = |limit, axis: usize| peaks.get(limit).expect("known")[axis];
    KEPT.iter()
        .all(|&limit| (0..2).all(|axis| reached(limit, axis) <= limits.of(limit, axis)))
}

#[test]
fn a_linear_machine_is_led_to_the_torque_or_the_velocity_asked_for() {
    let torque = shaped(&SOUND, 10.0, 0.05, options()).expect("it responds");
    assert_eq!(torque.stop, Stop::GoodEnough, "{:?}", torque.iterations);
    assert!(torque.sticking.is_empty() && torque.best.number == torque.iterations.len());
    let growth = |i: usize| {
        let peak = |i: usize| {
            torque.iterations[i]
                .peaks
                .get(Limit::Torque)
                .expect("known")[0]
        };
        peak(i) / peak(i - 1)
    };
    assert!(
        (1..torque.iterations.len()).all(|i| growth(i) < 3.3),
        "a reference grows threefold at most"
    );
    let condition = &torque.best.estimate.as_ref().expect("complete").condition;
    assert!(
        condition
            .iter()
            .all(|condition| (condition - 1.0).abs() < 0.05),
        "orthogonal at u"
    );
    let velocity = ShapeOptions {
        target: Target::Velocity,
        ..options()
    };
    let velocity = shaped(&SOUND, 0.3, 0.05, velocity).expect("it responds");
    assert!(
        velocity.best.error().is_some_and(|error| error < 0.03),
        "{:?}",
        velocity.iterations
    );
}

#[test]
fn a_machine_that_sticks_at_first_is_freed() {
    let machine = Machine {
        coulomb_nm: 3.0,
        ..SOUND
    };
    let shaped = shaped(&machine, 10.0, 0.02, options()).expect("it responds");
    assert_eq!(shaped.iterations[0].notes[0], Note::AllStuck);
    assert!(
        shaped.best.error().is_some_and(|error| error < 0.05),
        "{:?}",
        shaped.iterations
    );
}

#[test]
fn a_torque_below_the_friction_is_reached_and_said_to_stick() {
    let machine = Machine {
        coulomb_nm: 6.0,
        ..SOUND
    };
    let weak = ShapeOptions {
        coulomb_nm: Some(vec![6.0; 2]),
        ..options()
    };
    let shaped = shaped(&machine, 4.0, 0.02, weak).expect("it responds");
    assert_eq!(shaped.stop, Stop::Sticking);
    let words: Vec<String> = shaped.sticking.iter().map(ToString::to_string).collect();
    assert!(
        words[0].starts_with("axis 1 sticks 100 % of the time from 1 to 20 Hz"),
        "{words:?}"
    );
    assert!(
        words[1].starts_with("axis 2") && words[1].ends_with("against 6 N m of friction"),
        "{words:?}"
    );
}

#[test]
fn no_limit_is_ever_exceeded() {
    let unlimited = shaped(&SOUND, 10.0, 0.05, options())
        .expect("it responds")
        .best
        .peaks;
    for limited in KEPT {
        let reached = unlimited.get(limited).expect("known");
        let limits: Limits = [(limited, reached.iter().map(|peak| 0.7 * peak).collect())]
            .into_iter()
            .collect();
        for coulomb_nm in [0.0, 2.0] {
            let machine = Machine {
                coulomb_nm,
                ..SOUND
            };
            let shaped = shaped(
                &machine,
                10.0,
                0.05,
                ShapeOptions {
                    limits: limits.clone(),
                    ..options()
                },
            )
            .expect("responds");
            assert!(
                shaped.iterations.iter().all(|i| keeps(&i.peaks, &limits)),
                "{limited:?}: {:?}",
                shaped.iterations
            );
            let ahead = |note: &Note| matches!(note, Note::LimitAhead { .. });
            assert!(
                shaped.iterations.iter().flat_map(|i| &i.notes).any(ahead),
                "{limited:?}"
            );
        }
    }
}

#[test]
fn recorded_iterations_lead_to_the_same_references_again() {
    let machine = Machine {
        coulomb_nm: 3.0,
        ..SOUND
    };
    let begin = || Shaper::new(chirp(10.0), chirp(0.02), options()).expect("sound");
    let (mut live, mut again) = (begin(), begin());
    for number in 1..=4 {
        assert_eq!(
            (live.number(), live.reference()),
            (number, again.reference())
        );
        let records: Vec<Record> = live
            .runs()
            .iter()
            .map(|run| machine.run(run).expect("it runs"))
            .collect();
        assert_eq!(
            live.measured(records.clone()).expect("sound"),
            again.measured(records).expect("sound")
        );
    }
}

#[test]
fn a_run_that_was_stopped_is_taken_back() {
    let machine = Machine {
        trips_at_nm: 6.0,
        ..SOUND
    };
    let small = shaped(&machine, 10.0, 0.05, options()).expect("the first iteration is sound");
    let stopped = |note: &Note| matches!(note, Note::Stopped { reason, .. } if reason == "tripped");
    let tripped = small
        .iterations
        .iter()
        .find(|i| i.notes.iter().any(stopped))
        .expect("10 N m trip it");
    assert!(
        tripped.error.is_none() && !tripped.within_limits && small.best.number != tripped.number
    );
    assert!(matches!(
        shaped(&machine, 10.0, 1.0, options()),
        Err(ShapeError::FirstTooMuch { reason }) if reason.contains("tripped")
    ));
}

#[test]
fn what_cannot_be_shaped_is_refused() {
    let mut shaper = Shaper::new(chirp(10.0), chirp(0.05), options()).expect("sound");
    let mut records: Vec<Record> = shaper
        .runs()
        .iter()
        .map(|run| SOUND.run(run).expect("it runs"))
        .collect();
    records[1].sample_time_s *= 2.0;
    assert!(
        shaper
            .measured(records)
            .expect_err("another clock")
            .to_string()
            .starts_with("sample_time_s of a record")
    );
    let off = Machine {
        gain: [60.0, 0.0],
        ..SOUND
    };
    assert!(matches!(
        shaped(&off, 10.0, 0.05, options()),
        Err(ShapeError::NoResponse {
            axis: 1,
            target: "torque",
            ..
        })
    ));
    let limits = [(Limit::Velocity, vec![0.04; 2])].into_iter().collect();
    let fast = shaped(
        &SOUND,
        10.0,
        0.05,
        ShapeOptions {
            limits,
            ..options()
        },
    );
    assert!(matches!(
        fast,
        Err(ShapeError::StartTooLarge(Excess {
            limit: Limit::Velocity,
            ..
        }))
    ));
    let growing = ShapeOptions {
        largest_change: 1.0,
        ..options()
    };
    let too_high = ShapeOptions {
        high_hz: 200.0,
        ..options()
    };
    let undamped = ShapeOptions {
        step: Step::Damped {
            damping: 0.0,
            smoothing_bins: 30,
            adaptive: true,
        },
        ..options()
    };
    let one_axis = ShapeOptions {
        coulomb_nm: Some(vec![1.0]),
        ..options()
    };
    for (wrong, said) in [
        (growing, "largest_change is 1,"),
        (
            too_high,
            "high_hz = 200 Hz is not below the Nyquist frequency 125 Hz",
        ),
        (undamped, "damping is 0,"),
        (one_axis, "coulomb_nm has shape [1], needed (2)"),
    ] {
        let found = refusal(Shaper::new(chirp(10.0), chirp(0.05), wrong));
        assert!(found.starts_with(said), "{found}");
    }
    let silent = chirp(10.0) * &ndarray::arr3(&[[[1.0], [0.0]]]);
    let found = refusal(Shaper::new(silent, chirp(0.05), options()));
    assert!(found.ends_with("input 1 is not excited there"), "{found}");
    let short = chirp(10.0).slice(ndarray::s![.., .., 1..]).to_owned();
    let found = refusal(Shaper::new(short, chirp(0.05), options()));
    assert!(
        found.starts_with("desired has shape [2, 2, 3499]"),
        "{found}"
    );
    assert!(matches!(
        Shaper::new(chirp(10.0), chirp(0.05), options())
            .expect("sound")
            .finish(),
        Err(ShapeError::NothingMeasured)
    ));
}

#[test]
fn a_multisine_is_shaped_on_its_lines() {
    let lines = [15, 35, 55, 95, 155, 255, 275];
    let multisine = |amplitude: f64| {
        Array3::from_shape_fn((2, 2, 3500), |(m, c, k)| {
            let sign = if m * c == 1 { -1.0 } else { 1.0 };
            let phase =
                |line: usize| TAU * (line * k % 3500) as f64 / 3500.0 + (line * line) as f64;
            sign * amplitude * lines.iter().map(|&line| phase(line).sin()).sum::<f64>()
        })
    };
    let shaped = shape(
        &SOUND,
        multisine(2.0),
        multisine(0.02),
        options(),
        &mut |_| Ok(true),
    )
    .expect("it responds");
    let estimate = shaped.best.estimate.as_ref().expect("complete");
    assert_eq!(estimate.r_to_u.n_frequencies(), lines.len());
    assert!(estimate.error < 0.02, "{:?}", shaped.iterations);
    assert_eq!(shaped.best.reference.len_of(Axis(2)), 3500);
}

#[test]
fn whoever_watches_may_end_it() {
    let ended = shape(&SOUND, chirp(10.0), chirp(0.05), options(), &mut |i| {
        Ok(i.number < 2)
    })
    .expect("sound");
    assert_eq!((ended.stop, ended.iterations.len()), (Stop::Watcher, 2));
    let failed = shape(&SOUND, chirp(10.0), chirp(0.05), options(), &mut |_| {
        Err("disk full".into())
    });
    assert!(matches!(failed, Err(ShapeError::Watch(error)) if error.to_string() == "disk full"));
}
