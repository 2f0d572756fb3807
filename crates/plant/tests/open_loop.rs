//! Runs in open loop: what is injected, recorded, refused and stopped.

use std::f64::consts::TAU;
use std::sync::Arc;

use frfid_plant::{Actuation, Hold, Sensor, Simulated, SimulatedRobot, SingleJoint, Watch};
use frfid_signals::{
    Event, EventKind, InputKind, Limit, Run, RunId, RunKind, SignalError, Testbed as _,
    TestbedError,
};
use ndarray::{Array2, s};

const ID: RunId = RunId {
    kind: RunKind::Excitation,
    realization: 0,
    experiment: 0,
    repetition: 0,
};

fn run(velocity: f64, amplitude: f64) -> Run {
    let reference = Array2::from_shape_fn((1, 2000), |(_, n)| {
        amplitude * (TAU * 7.0 * n as f64 * 1e-3).sin()
    });
    Run {
        id: ID,
        sample_time_s: 1e-3,
        reference,
        velocity_rad_s: vec![velocity],
        start_rad: vec![0.0],
    }
}

fn joint() -> SingleJoint {
    {
        let mut robot = SingleJoint::default();
        robot.joint.friction.coulomb_nm = 50.0;
        robot.joint.friction.viscous_nms_per_rad = 20.0;
        robot
    }
}

#[test]
fn riding_on_a_constant_velocity_friction_is_invisible() {
    let free = SimulatedRobot::open_loop(Arc::new({
        let mut robot = joint();
        robot.joint.friction.coulomb_nm = 0.0;
        robot
    }));
    for velocity in [0.4, -0.4] {
        let record = SimulatedRobot::open_loop(Arc::new(joint()))
            .run(&run(velocity, 100.0))
            .expect("sound");
        let still = free.run(&run(0.0, 100.0)).expect("sound");
        let holding = 50.0 * velocity.signum() + 20.0 * velocity;
        assert!(
            (&record.u - &still.u - holding)
                .iter()
                .all(|difference| difference.abs() < 1e-9)
        );
        assert!(
            (&record.y - &still.y - velocity)
                .iter()
                .all(|difference| difference.abs() < 1e-10)
        );
        assert_eq!(record.r, Some(run(velocity, 100.0).reference));
    }
}

#[test]
fn sensors_see_increments_quanta_and_noise() {
    let sensor = Sensor {
        velocity_by_differencing: true,
        position_increment_rad: Some(1e-6),
        torque_quantum_nm: Some(0.5),
        torque_noise_nm: Some(0.3),
        ..Sensor::default()
    };
    let testbed = SimulatedRobot {
        sensors: vec![sensor],
        seed: 3,
        ..SimulatedRobot::open_loop(Arc::new(joint()))
    };
    let Simulated { record, truth, .. } = testbed.simulate(&run(0.0, 100.0)).expect("sound");
    assert_eq!(record.check(), Ok(()));
    assert_eq!(record.input_kind, InputKind::Measured);
    assert_eq!(
        record,
        testbed
            .run(&run(0.0, 100.0))
            .expect("the same seed gives the same record")
    );
    let position = record.position_rad.expect("positions are recorded");
    for n in 1..2000 {
        let difference = (position[[0, n]] - position[[0, n - 1]]) / 1e-3;
        assert!((record.y[[0, n]] - difference).abs() < 1e-15);
        assert!((position[[0, n]] - truth.motor_position_rad[[0, n]]).abs() <= 0.5e-6 + 1e-15);
    }
}

#[test]
fn runs_and_settings_that_do_not_fit_are_refused() {
    let refused = |testbed: SimulatedRobot, run: Run| {
        testbed.run(&run).expect_err("does not fit").to_string()
    };
    let testbed = || SimulatedRobot::open_loop(Arc::new(joint()));
    assert!(
        refused(
            SimulatedRobot {
                actuation: Actuation::Torque {
                    hold: Hold::Continuous
                },
                ..testbed()
            },
            run(0.0, 1.0)
        )
        .contains("continuous")
    );
    assert!(
        refused(
            SimulatedRobot {
                sensors: vec![],
                ..testbed()
            },
            run(0.0, 1.0)
        )
        .starts_with("sensors has shape [0]")
    );
    assert!(
        refused(
            SimulatedRobot {
                max_step_s: Some(0.0),
                ..testbed()
            },
            run(0.0, 1.0)
        )
        .starts_with("max_step_s is 0")
    );
    assert!(
        refused(
            SimulatedRobot {
                max_step_s: Some(1e-12),
                ..testbed()
            },
            run(0.0, 1.0)
        )
        .contains("too stiff")
    );
    let mut joint = joint();
    joint.joint.motor_inertia_kg_m2 = -35.0;
    assert!(
        refused(SimulatedRobot::open_loop(Arc::new(joint)), run(0.0, 1.0))
            .starts_with("motor_inertia_kg_m2 is -35")
    );
    let mut holed = run(0.0, 1.0);
    holed.reference[[0, 17]] = f64::NAN;
    let error = SimulatedRobot::open_loop(Arc::new(SingleJoint::default()))
        .run(&holed)
        .expect_err("NaN");
    assert!(
        matches!(
            error,
            TestbedError::Run(SignalError::NotFinite { sample: 17, .. })
        ),
        "{error}"
    );
    assert!(
        refused(
            testbed(),
            Run {
                velocity_rad_s: vec![f64::NAN],
                ..run(0.0, 1.0)
            }
        )
        .starts_with("velocity_rad_s is NaN")
    );
}

#[test]
fn steps_too_long_for_the_joint_are_reported_with_their_run() {
    let reported = |coulomb_nm: f64| {
        let mut joint = joint();
        joint.joint.motor_inertia_kg_m2 = 1e-4;
        joint.joint.friction.coulomb_nm = coulomb_nm; // its resonance lies at 6 kHz
        let testbed = SimulatedRobot {
            max_step_s: Some(1e-3),
            ..SimulatedRobot::open_loop(Arc::new(joint))
        };
        let error = testbed.run(&run(0.0, 100.0)).expect_err("RK4 is unstable");
        assert!(error.to_string().starts_with("run p000-m0-q0: "), "{error}");
        error
    };
    assert!(matches!(
        reported(0.0),
        TestbedError::Diverged { channel: 0, .. }
    ));
    assert!(reported(50.0).to_string().ends_with("lower max_step_s"));
}

#[test]
fn an_excess_takes_the_excitation_away_and_leaves_what_holds_the_robot() {
    let watch = Watch {
        limits: [(Limit::Velocity, vec![0.42])].into_iter().collect(),
        ramp_s: 0.05,
    };
    for hold in [Hold::Zoh, Hold::Linear] {
        let free = SimulatedRobot {
            actuation: Actuation::Torque { hold },
            ..SimulatedRobot::open_loop(Arc::new(joint()))
        };
        let (whole, record) = (
            free.run(&run(0.4, 100.0)),
            SimulatedRobot {
                watch: Some(watch.clone()),
                ..free
            }
            .run(&run(0.4, 100.0)),
        );
        let (whole, record) = (whole.expect("sound"), record.expect("stopped, not lost"));
        let first = whole
            .y
            .iter()
            .position(|y| y.abs() > 0.42)
            .expect("the sine moves the motor by more than 0.02");
        assert_eq!(
            (
                record.n_steady_samples(),
                record.n_samples(),
                record.check()
            ),
            (first, first + 51, Ok(()))
        );
        assert_eq!(
            record.y.slice(s![.., ..=first]),
            whole.y.slice(s![.., ..=first])
        );
        assert!((record.u[[0, first + 50]] - (50.0 + 20.0 * 0.4)).abs() < 1e-12);
        let kinds: Vec<&EventKind> = record.events.iter().map(|event| &event.kind).collect();
        let [
            EventKind::Limit {
                channel: 0,
                limit: Limit::Velocity,
                allowed: 0.42,
                ..
            },
            EventKind::Stopped { reason, .. },
        ] = kinds[..]
        else {
            panic!("{kinds:?}")
        };
        assert!(
            reason.starts_with("axis 1: velocity ") && reason.ends_with("; brought to rest"),
            "{reason}"
        );
    }
}

/// How a run of a torque ends under a limit of one of its changes.
fn under_limit(torque_nm: &[f64], limit: Limit, allowed: f64) -> Vec<Event> {
    let watch = Watch {
        limits: [(limit, vec![allowed])].into_iter().collect(),
        ramp_s: 0.05,
    };
    let testbed = SimulatedRobot {
        watch: Some(watch),
        ..SimulatedRobot::open_loop(Arc::new(joint()))
    };
    let reference = Array2::from_shape_fn((1, torque_nm.len()), |(_, n)| torque_nm[n]);
    let run = Run {
        reference,
        ..run(0.0, 0.0)
    };
    testbed.run(&run).expect("stopped, not lost").events
}

#[test]
fn steps_from_rest_and_to_rest_are_watched() {
    let at = |events: &[Event]| events.first().map(|event| event.time_s);
    let rate = |torque: &[f64], allowed| under_limit(torque, Limit::TorqueRate, allowed);
    // 90 N m in the first millisecond, 90 N m back to rest after the last of 100, or gently both ways
    let (from_rest, mut to_rest) = ([90.0; 100], [90.0; 100]);
    let mut gently = to_rest;
    for k in 0..10 {
        to_rest[k] = 9.0 * k as f64;
        (gently[k], gently[99 - k]) = (to_rest[k], to_rest[k]);
    }
    assert_eq!(at(&rate(&from_rest, 41e3)), Some(0.0));
    assert_eq!(at(&rate(&to_rest, 41e3)), Some(0.1));
    assert_eq!(rate(&gently, 41e3), []);
    assert_eq!(rate(&from_rest, 91e3), []);
    // what the torque does to the motion: the acceleration of a motor of 1 kg m^2 behind friction
    let accelerated = under_limit(&from_rest, Limit::Acceleration, 1.0);
    let jerked = under_limit(&from_rest, Limit::Jerk, 100.0);
    for (events, limit) in [(accelerated, Limit::Acceleration), (jerked, Limit::Jerk)] {
        let EventKind::Limit { limit: found, .. } = events[0].kind else {
            panic!("{events:?}")
        };
        assert_eq!((found, events[0].time_s), (limit, 1e-3));
    }
}
