//! Runs in closed loop: what is held, recorded, refused and stopped.

use std::f64::consts::TAU;
use std::sync::Arc;

use frfid_plant::{PiController, Simulated, SimulatedRobot, SingleJoint, Torque, Watch, simulate};
use frfid_signals::{
    Event, EventKind, Limit, Record, Run, RunId, RunKind, Testbed as _, TestbedError,
};
use ndarray::{Array2, s};

const T: f64 = 1e-3;

fn controller() -> PiController {
    PiController::new(vec![2000.0], vec![16000.0])
}

fn run(velocity: f64, amplitude: f64) -> Run {
    let reference = |(_, n)| velocity + amplitude * (TAU * 3.0 * n as f64 * 1e-3).sin();
    Run {
        id: RunId {
            kind: RunKind::Excitation,
            realization: 0,
            experiment: 0,
            repetition: 0,
        },
        sample_time_s: 1e-3,
        reference: Array2::from_shape_fn((1, 1000), reference),
        velocity_rad_s: vec![velocity],
        start_rad: vec![0.0],
    }
}

#[test]
fn a_constant_velocity_is_held_against_friction_from_the_first_sample() {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    joint.joint.friction.viscous_nms_per_rad = 20.0;
    for velocity in [0.1, -0.1] {
        let record =
            SimulatedRobot::closed_loop(Arc::new(joint.clone()), Arc::new(controller()), T)
                .run(&run(velocity, 0.0))
                .expect("sound");
        assert!(record.y.iter().all(|y| (y - velocity).abs() < 1e-12));
        assert!(record.u.iter().all(|u| (u - 520.0 * velocity).abs() < 1e-9));
        assert_eq!(record.check(), Ok(()));
    }
}

#[test]
fn the_recorded_torque_makes_the_recorded_motion() {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    let Simulated { record, truth, .. } =
        SimulatedRobot::closed_loop(Arc::new(joint.clone()), Arc::new(controller()), T)
            .simulate(&run(0.0, 0.1))
            .expect("sound");
    let again = simulate(&joint, Torque::Zoh(record.u.view()), 1e-3, 0.0, None).expect("sound");
    assert_eq!(again, truth);
    assert!(
        truth.stuck_share[0] > 0.0 && truth.stuck_share[0] < 0.2,
        "{:?}",
        truth.stuck_share
    );
}

#[test]
fn reaching_the_torque_limit_is_an_event_and_not_an_error() {
    let limited = PiController {
        max_torque_nm: Some(vec![100.0]),
        ..controller()
    };
    let record =
        SimulatedRobot::closed_loop(Arc::new(SingleJoint::default()), Arc::new(limited), T)
            .run(&run(0.0, 0.1))
            .expect("sound");
    assert!(record.u.iter().all(|u| u.abs() <= 100.0));
    // a sine of 3 Hz over 1 s meets the limit once per half-wave
    assert!(
        (3..=12).contains(&record.events.len()),
        "{:?}",
        record.events
    );
    let EventKind::Limit {
        channel: 0,
        limit: Limit::Torque,
        value,
        allowed,
    } = record.events[0].kind
    else {
        panic!("no limit")
    };
    assert!(value.abs() > allowed && allowed == 100.0);
}

#[test]
fn an_unstable_loop_says_where_it_left_the_numbers() {
    let wild = PiController {
        gain_nms_per_rad: vec![1e9],
        ..controller()
    };
    let error = SimulatedRobot::closed_loop(Arc::new(SingleJoint::default()), Arc::new(wild), T)
        .run(&run(0.0, 0.1))
        .expect_err("unstable");
    assert!(
        matches!(
            error,
            TestbedError::Diverged {
                quantity: "motor velocity",
                channel: 0,
                ..
            }
        ),
        "{error}"
    );
    let told = error.to_string();
    assert!(
        told.contains("axis 1") && told.ends_with("is 1000000000 N m s/rad: lower the gains"),
        "{told}"
    );
}

#[test]
fn runs_that_do_not_fit_are_refused() {
    let testbed =
        SimulatedRobot::closed_loop(Arc::new(SingleJoint::default()), Arc::new(controller()), T);
    let refused = |run: Run| testbed.run(&run).expect_err("does not fit").to_string();
    assert!(
        refused(Run {
            sample_time_s: 2e-3,
            ..run(0.0, 0.1)
        })
        .contains("controller's sample time")
    );
    assert!(
        refused(Run {
            velocity_rad_s: vec![],
            ..run(0.0, 0.1)
        })
        .starts_with("velocity_rad_s has shape [0]")
    );
    assert!(
        refused(Run {
            reference: Array2::zeros((2, 5)),
            ..run(0.0, 0.1)
        })
        .starts_with("reference has shape")
    );
    assert!(
        refused(Run {
            reference: Array2::from_elem((1, 5), f64::NAN),
            ..run(0.0, 0.1)
        })
        .contains("NaN")
    );
}

/// What stopped a run and the times in s of the excess and of the stop.
fn stop(record: &Record) -> (&str, f64, f64) {
    let Some(Event {
        time_s,
        kind: EventKind::Stopped {
            reason,
            since_s: Some(since_s),
        },
    }) = record.events.last()
    else {
        panic!("not stopped: {:?}", record.events)
    };
    (reason, *since_s, *time_s)
}

#[test]
fn an_excess_brings_the_reference_smoothly_to_zero_and_ends_the_record_there() {
    let free =
        SimulatedRobot::closed_loop(Arc::new(SingleJoint::default()), Arc::new(controller()), T);
    let planned = Run {
        start_rad: vec![-0.02],
        ..run(0.2, 0.1)
    };
    let whole = free.run(&planned).expect("sound");
    let position = whole.position_rad.as_ref().expect("recorded");
    let peaks = [&whole.u, &whole.y, position]
        .map(|x| x.iter().fold(0.0, |peak: f64, x| peak.max(x.abs())));
    let quantities = [Limit::Torque, Limit::Velocity, Limit::Travel];
    let signals = [&whole.u, &whole.y, position];
    for ((limited, signal), peak) in quantities.into_iter().zip(signals).zip(peaks) {
        let watch = Watch {
            limits: [(limited, vec![0.8 * peak])].into_iter().collect(),
            ramp_s: 0.1,
        };
        let word = limited.quantity();
        let first = signal
            .iter()
            .position(|x| x.abs() > 0.8 * peak)
            .expect("0.8 of the peak is exceeded");
        let record = SimulatedRobot {
            watch: Some(watch),
            ..free.clone()
        }
        .run(&planned)
        .expect("sound");
        let (reason, since_s, time_s) = stop(&record);
        assert!(
            reason.starts_with(&format!("axis 1: {word} "))
                && reason.contains("gain 2000 N m s/rad"),
            "{reason}"
        );
        assert!(
            (since_s - 1e-3 * first as f64).abs() < 1e-9 && (time_s - since_s - 0.1).abs() < 1e-9,
            "{reason}"
        );
        assert_eq!(
            (record.n_steady_samples(), record.n_samples()),
            (first, first + 101)
        );
        assert_eq!(record.check(), Ok(()));
        let Event {
            kind: EventKind::Limit {
                channel: 0, limit, ..
            },
            ..
        } = &record.events[0]
        else {
            panic!("{:?}", record.events)
        };
        assert_eq!(*limit, limited);
        let r = record.r.as_ref().expect("recorded").row(0).to_owned();
        assert_eq!(
            r.slice(s![..=first]),
            planned.reference.slice(s![0, ..=first])
        );
        assert_eq!(
            record.u.slice(s![.., ..=first]),
            whole.u.slice(s![.., ..=first])
        );
        assert!(
            r[first + 100].abs() < 1e-15
                && (r[first + 50] / planned.reference[[0, first + 50]] - 0.5).abs() < 1e-12
        );
    }
}

#[test]
fn an_unstable_loop_is_cut_off_at_the_first_limit() {
    let wild = PiController {
        gain_nms_per_rad: vec![1e9],
        ..controller()
    };
    let watch = Watch {
        limits: [(Limit::Torque, vec![1000.0])].into_iter().collect(),
        ramp_s: 0.5,
    };
    let testbed = SimulatedRobot {
        watch: Some(watch),
        ..SimulatedRobot::closed_loop(Arc::new(SingleJoint::default()), Arc::new(wild), T)
    };
    let record = testbed.run(&run(0.0, 0.1)).expect("stopped, not lost");
    assert_eq!(
        (
            record.n_samples(),
            record.n_steady_samples(),
            record.check()
        ),
        (2, 1, Ok(()))
    );
    let (reason, ..) = stop(&record);
    for part in [
        "axis 1: torque ",
        "limit 1000 N m, at 0.0010 s",
        "gain 1000000000 N m s/rad",
        "lower the gains",
    ] {
        assert!(reason.contains(part), "{reason}");
    }
}
