//! The arm under its controller: held against gravity, coupled between axes, stable with its gains.

mod manutec_r3;

use std::f64::consts::TAU;
use std::sync::Arc;

use frfid_plant::{
    Challenges, LoopFrf, Payload, PiController, PlantError, Sensor, SimulatedRobot,
    check_stability, simulate_robots,
};
use frfid_signals::{Record, Run, RunId, RunKind, Testbed as _};
use manutec_r3::{ball, each_joint, manutec_r3, with_ripple};
use ndarray::Array2;
use num_complex::Complex64;

const T: f64 = 1e-3;
const PERIOD: usize = 500;

fn controller() -> PiController {
    PiController::new(
        vec![1500.0, 1500.0, 400.0],
        vec![12_000.0, 12_000.0, 3200.0],
    )
}

fn run(reference: Array2<f64>) -> Run {
    let id = RunId {
        kind: RunKind::Excitation,
        realization: 0,
        experiment: 0,
        repetition: 0,
    };
    Run {
        id,
        sample_time_s: T,
        reference,
        velocity_rad_s: vec![0.0; 3],
        start_rad: vec![0.0; 3],
    }
}

#[test]
fn at_rest_the_controller_holds_the_arm_against_gravity_from_the_first_sample() {
    for coulomb_friction in [true, false] {
        let mut arm = manutec_r3();
        arm.challenges = Challenges {
            coulomb_friction: Some(coulomb_friction),
            ..arm.challenges
        };
        let gravity = arm.gravity_torque_nm(&arm.pose_rad).expect("sound");
        assert!(gravity[1].abs() > 400.0);
        let record = SimulatedRobot::closed_loop(Arc::new(arm), Arc::new(controller()), T)
            .run(&run(Array2::zeros((3, 500))))
            .expect("sound");
        for ((axis, _), u) in record.u.indexed_iter() {
            assert!(
                (u - gravity[axis]).abs() < 1e-6,
                "{u} for {}",
                gravity[axis]
            );
        }
        assert!(record.y.iter().all(|y| y.abs() < 1e-9));
    }
}

#[test]
fn a_small_motion_of_one_axis_moves_all_torques_and_axes_as_the_linear_loop_says() {
    let mut arm = manutec_r3();
    arm.challenges = Challenges {
        coulomb_friction: Some(false),
        ..arm.challenges
    };
    let lines = [1, 4, 7, 12, 15, 21, 29]; // of 2 Hz
    let sine = |n: usize, line: usize| {
        (TAU * (n * line % PERIOD) as f64 / PERIOD as f64 + (line * line) as f64).sin()
    };
    let moved = |n: usize| lines.iter().map(|&line| 1e-6 * sine(n, line)).sum();
    let reference = Array2::from_shape_fn(
        (3, 16 * PERIOD),
        |(axis, n): (usize, usize)| if axis == 1 { moved(n) } else { 0.0 },
    );
    let hz: Vec<f64> = lines
        .iter()
        .map(|&line| line as f64 / (T * PERIOD as f64))
        .collect();
    let truth = LoopFrf::new(&arm, &controller(), T, &[Sensor::default(); 3], &hz).expect("sound");
    let Record { u, y, .. } = SimulatedRobot::closed_loop(Arc::new(arm), Arc::new(controller()), T)
        .run(&run(reference.clone()))
        .expect("sound");
    let dft = |x: &Array2<f64>, axis: usize, line: usize| -> Complex64 {
        let turn = |n: usize| Complex64::cis(-TAU * (n * line % PERIOD) as f64 / PERIOD as f64);
        let last = x.ncols() - PERIOD;
        let mean = x.row(axis).iter().skip(last).sum::<f64>() / PERIOD as f64;
        (0..PERIOD)
            .map(|n| (x[[axis, last + n]] - mean) * turn(n))
            .sum()
    };
    for (what, signal, frf) in [
        ("u", &u, &truth.reference_to_torque),
        ("y", &y, &truth.reference_to_velocity),
    ] {
        for (k, &line) in lines.iter().enumerate() {
            let input = dft(&reference, 1, line);
            let column = frf.response.slice(ndarray::s![k, .., 1]);
            let size = column.iter().map(|value| value.norm()).fold(0.0, f64::max);
            for axis in 0..3 {
                let error = (dft(signal, axis, line) / input - column[axis]).norm() / size;
                assert!(
                    error < 1e-5,
                    "{what} of axis {} at {} Hz: {error:e}",
                    axis + 1,
                    hz[k]
                );
            }
        }
    }
}

/// Arms that differ in payload and friction, with ripple and knees, under an excitation that stops and
/// turns them.
fn closed_loops(count: usize) -> Vec<SimulatedRobot> {
    let closed_loop = |index: usize| {
        let mut arm = with_ripple(manutec_r3());
        arm.payload = (!index.is_multiple_of(3)).then(|| Payload {
            mass_kg: 2.0 * index as f64,
            center_of_mass_m: [0.0, 0.1, 0.2],
            inertia_kg_m2: ball(0.1),
        });
        each_joint(&mut arm, |_, joint| {
            joint.friction.coulomb_nm *= index as f64 / 8.0;
            joint.spring.knee_rad = 1e-3;
            joint.spring.stiffness_beyond_nm_per_rad *= 1.7;
        });
        let mut robot = SimulatedRobot::closed_loop(Arc::new(arm), Arc::new(controller()), T);
        robot.sensors = vec![Sensor::default(); 3];
        robot.sensors[0].velocity_by_differencing = true;
        robot.seed = index as u64;
        robot
    };
    (0..count).map(closed_loop).collect()
}

#[test]
fn arms_in_closed_loops_side_by_side_move_as_each_does_alone_to_the_last_digit() {
    let wave = |(axis, sample): (usize, usize)| {
        let time_s = sample as f64 * T;
        0.1 * (TAU * (2.0 + 3.0 * axis as f64) * time_s).sin() + 0.05 * (TAU * 17.0 * time_s).sin()
    };
    let run = run(Array2::from_shape_fn((3, 400), wave));
    for count in [1, 2, 5, 16, 17] {
        let robots = closed_loops(count);
        let together = simulate_robots(robots.iter().map(|robot| (robot, &run)), &|| true);
        for (robot, together) in robots.iter().zip(together) {
            let alone = robot.simulate(&run).expect("stable");
            assert!(together.expect("stable") == alone);
        }
    }
}

#[test]
fn unstable_gains_are_named_with_their_axis() {
    let (arm, sensors) = (manutec_r3(), [Sensor::default(); 3]);
    assert_eq!(arm.n_axes(), 3);
    check_stability(&arm, &controller(), T, &sensors).expect("stable");
    for axis in 0..3 {
        let mut wild = controller();
        wild.gain_nms_per_rad[axis] = 1e6;
        let error = check_stability(&arm, &wild, T, &sensors).expect_err("unstable");
        assert!(
            matches!(error, PlantError::Unstable { channel, .. } if channel == axis),
            "{error}"
        );
        assert!(
            error.to_string().contains(&format!(
                "lower the gain of axis {} (1000000 N m s/rad)",
                axis + 1
            )),
            "{error}"
        );
    }
    let limp = PiController {
        gain_nms_per_rad: vec![10.0; 3],
        integral_gain_nm_per_rad: vec![0.0; 3],
        ..controller()
    };
    let error = check_stability(&arm, &limp, T, &sensors).expect_err("gravity pulls it down");
    assert!(
        error
            .to_string()
            .contains("at 0.000 Hz; it drifts away: raise the integral"),
        "{error}"
    );
}
