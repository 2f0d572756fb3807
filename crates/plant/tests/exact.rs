//! Exact steps against matrix exponentials, energy, Runge-Kutta steps and themselves, alone and side by side.

use std::f64::consts::TAU;
use std::sync::Arc;

use frfid_plant::{
    Acting, Actuation, Arm, Challenges, Hold, Integration, PiController, PlantError, Ripple,
    Robot as _, Simulated, SimulatedRobot, SingleJoint, Trajectory, simulate_robots,
};
use frfid_signals::random::stream;
use frfid_signals::{Run, RunId};
use nalgebra::{DMatrix, DVector};
use ndarray::Array2;
use rand::RngExt as _;

const T: f64 = 1e-3;

/// Three sines, largest sum 1.
fn shape(sample: usize, sample_time_s: f64) -> f64 {
    let t = sample as f64 * sample_time_s;
    ((TAU * 2.3 * t).sin() + (TAU * 7.9 * t + 1.0).sin() + (TAU * 19.0 * t + 2.0).sin()) / 3.0
}

fn run(sample_time_s: f64, duration_s: f64, peak: f64, velocity_rad_s: f64) -> Run {
    let n_samples = (duration_s / sample_time_s) as usize;
    Run {
        id: RunId::excitation(0, 0, 0),
        sample_time_s,
        reference: Array2::from_shape_fn((1, n_samples), |(_, n)| peak * shape(n, sample_time_s)),
        velocity_rad_s: vec![velocity_rad_s],
        start_rad: vec![0.0],
    }
}

fn exact(joint: &SingleJoint, hold: Hold) -> SimulatedRobot {
    SimulatedRobot {
        actuation: Actuation::Torque { hold },
        integration: Integration::Exact,
        ..SimulatedRobot::open_loop(Arc::new(joint.clone()))
    }
}

/// The same by Runge-Kutta steps of a share of what is the default.
fn rk4(joint: &SingleJoint, hold: Hold, share: f64) -> SimulatedRobot {
    SimulatedRobot {
        integration: Integration::Rk4,
        max_step_s: Some(share * joint.default_step_s()),
        ..exact(joint, hold)
    }
}

fn truth(robot: &SimulatedRobot, run: &Run) -> Trajectory {
    robot.simulate(run).expect("sound").truth
}

/// Largest difference of all signals, each relative to its peak.
fn difference(a: &Trajectory, b: &Trajectory) -> f64 {
    let signals = |x: &Trajectory| {
        [
            x.motor_position_rad.clone(),
            x.motor_velocity_rad_s.clone(),
            x.deflection_rad.clone(),
            x.link_velocity_rad_s.clone(),
        ]
    };
    let largest = |x: &Array2<f64>| x.iter().fold(0.0_f64, |peak, value| peak.max(value.abs()));
    let of_signal = |(a, b): (Array2<f64>, Array2<f64>)| largest(&(&a - &b)) / largest(&b);
    let pairs = signals(a).into_iter().zip(signals(b));
    pairs.map(of_signal).fold(0.0, f64::max)
}

/// The linear joint from sample to sample by the exponential of its state matrix with held or ramped
/// torque; (motor velocity, deflection).
fn by_exponential(joint: &SingleJoint, run: &Run, hold: Hold) -> Vec<[f64; 2]> {
    let model = joint.state_space();
    let mut generator = DMatrix::zeros(6, 6);
    generator.view_mut((0, 0), (4, 4)).copy_from(&model.a);
    generator.view_mut((0, 4), (4, 1)).copy_from(&model.b);
    generator[(4, 5)] = 1.0 / run.sample_time_s;
    // the deflection in rad times a rate: all states are of one size, and the exponential keeps its digits
    let rate = joint.fastest_rad_s();
    generator.row_mut(1).scale_mut(rate);
    generator.column_mut(1).unscale_mut(rate);
    let step = (generator * run.sample_time_s).exp();
    let mut x = DVector::zeros(6);
    let u = run.reference.row(0);
    let states = (0..u.len()).map(|n| {
        let now = [x[2], x[1] / rate];
        x[4] = u[n];
        let next = u.get(n + 1).copied().unwrap_or(u[n]);
        x[5] = if hold == Hold::Zoh { 0.0 } else { next - u[n] };
        x = &step * &x;
        now
    });
    states.collect()
}

#[test]
fn without_nonlinearities_it_is_the_matrix_exponential() {
    let mut damped = SingleJoint::default();
    damped.joint.damping_nms_per_rad = 5e4; // its fastest motion is a decay
    damped.joint.friction.viscous_nms_per_rad = 300.0;
    // the resonance of the last lies at 1.1 kHz: its samples are cut into steps
    let mut stiff = SingleJoint::default();
    stiff.joint.spring.stiffness_nm_per_rad = 1.5e9;
    stiff.joint.spring.stiffness_beyond_nm_per_rad = 1.5e9;
    for joint in [SingleJoint::default(), damped, stiff] {
        for hold in [Hold::Zoh, Hold::Linear] {
            for sample_time_s in [2.5e-4, 1e-3, 4e-3] {
                let run = run(sample_time_s, 1.0, 100.0, 0.0);
                let found = truth(&exact(&joint, hold), &run);
                let expected = by_exponential(&joint, &run, hold);
                for (signal, found) in [found.motor_velocity_rad_s, found.deflection_rad]
                    .iter()
                    .enumerate()
                {
                    let expected = expected.iter().map(|x| x[signal]);
                    let peak = expected.clone().fold(0.0_f64, |peak, x| peak.max(x.abs()));
                    let errors = found.iter().zip(expected).map(|(x, y)| (x - y).abs());
                    let error = errors.fold(0.0, f64::max) / peak;
                    assert!(error < 1e-12, "{hold:?}, {sample_time_s} s: {error:e}");
                }
            }
        }
    }
}

/// A joint of the series with numbers of its own: friction, knee and payload, and a run of it.
fn drawn(number: usize) -> (SingleJoint, Run, Hold) {
    let mut random = stream(7, "exact steps", &[number as u64]);
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let mut joint = SingleJoint {
        link_inertia_kg_m2: between(50.0, 300.0),
        ..SingleJoint::default()
    };
    let motor = &mut joint.joint;
    motor.motor_inertia_kg_m2 = between(10.0, 60.0);
    motor.damping_nms_per_rad = between(0.0, 800.0);
    motor.friction.viscous_nms_per_rad = [0.0, between(0.0, 400.0)][number % 2];
    motor.friction.coulomb_nm = [between(5.0, 90.0), 0.0, between(5.0, 90.0)][number % 3];
    motor.spring.stiffness_nm_per_rad = between(5e4, 3e5);
    if number % 4 != 1 {
        motor.spring.stiffness_beyond_nm_per_rad = between(0.4, 2.5) * 1.5e5;
        motor.spring.knee_rad = between(5e-5, 5e-4);
    }
    let sample_time_s = [2.5e-4, 5e-4, 1e-3, 2e-3, 4e-3][number % 5];
    let velocity_rad_s = [0.0, between(-0.05, 0.05)][number / 3 % 2];
    let run = run(sample_time_s, 1.0, between(60.0, 250.0), velocity_rad_s);
    let hold = [Hold::Zoh, Hold::Linear][number % 2];
    (joint, run, hold)
}

#[test]
fn joints_of_any_numbers_move_as_by_short_runge_kutta_steps_and_as_by_short_exact_ones() {
    let mut stuck = 0.0;
    for number in 0..60 {
        let (joint, run, hold) = drawn(number);
        let robot = exact(&joint, hold);
        let found = truth(&robot, &run);
        let short = SimulatedRobot {
            max_step_s: Some(5e-5),
            ..robot
        };
        let short = truth(&short, &run);
        let error = difference(&found, &short);
        assert!(error < 1e-11, "{number}: {error:e} from short exact steps");
        let by_rk4 = truth(&rk4(&joint, hold, 0.2), &run);
        let error = difference(&by_rk4, &found);
        assert!(error < 1e-11, "{number}: {error:e} from RK4");
        let share = found.stuck_share[0];
        assert!((share - by_rk4.stuck_share[0]).abs() < 1e-7, "{number}");
        stuck += share;
    }
    assert!(stuck > 3.0, "{stuck}");
}

#[test]
fn steps_as_long_as_they_may_be_miss_no_turn_of_a_stiff_joint() {
    for number in 0..40 {
        let mut random = stream(8, "stiff joints", &[number]);
        let mut between = |low: f64, high: f64| random.random_range(low..high);
        let mut joint = SingleJoint::default();
        // the period of its resonance is 2 to 13 samples
        let stiffness = between(1e6, 4e7);
        joint.joint.spring.stiffness_nm_per_rad = stiffness;
        joint.joint.spring.stiffness_beyond_nm_per_rad = between(0.5, 1.0) * stiffness;
        joint.joint.spring.knee_rad = between(1e-6, 4e-6);
        joint.joint.friction.coulomb_nm = between(1.0, 60.0);
        joint.joint.damping_nms_per_rad = between(0.0, 800.0);
        let mut run = run(4e-3, 1.0, 1.0, 0.0);
        run.reference.mapv_inplace(|_| between(-150.0, 150.0));
        for hold in [Hold::Zoh, Hold::Linear] {
            let robot = exact(&joint, hold);
            let found = truth(&robot, &run);
            let short = SimulatedRobot {
                max_step_s: Some(4e-6),
                ..robot
            };
            let short = truth(&short, &run);
            let error = difference(&found, &short);
            assert!(error < 1e-11, "{number}, {hold:?}: {error:e}");
            assert!((found.stuck_share[0] - short.stuck_share[0]).abs() < 1e-9);
        }
    }
}

#[test]
fn a_stuck_motor_has_velocity_0_exactly() {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 60.0;
    let x = truth(&exact(&joint, Hold::Zoh), &run(T, 2.0, 100.0, 0.0));
    let velocity = x.motor_velocity_rad_s.row(0);
    let n_still = velocity.iter().filter(|velocity| **velocity == 0.0).count();
    let share = n_still as f64 / velocity.len() as f64;
    assert!(share > 0.1 && share < 0.9, "{share}");
    assert!((share - x.stuck_share[0]).abs() < 0.02, "{share}");
    for n in 1..velocity.len() {
        if velocity[n] == 0.0 && velocity[n - 1] == 0.0 {
            let position = x.motor_position_rad.row(0);
            assert!((position[n] - position[n - 1]).abs() < 1e-6, "sample {n}");
        }
    }
}

#[test]
fn without_losses_the_energy_is_the_work_of_the_torque_through_every_knee() {
    let mut joint = SingleJoint::default();
    joint.joint.damping_nms_per_rad = 0.0;
    joint.joint.spring.stiffness_beyond_nm_per_rad = 4e5;
    joint.joint.spring.knee_rad = 1e-4;
    let run = run(T, 3.0, 150.0, 0.0);
    let x = truth(&exact(&joint, Hold::Zoh), &run);
    let spring = &joint.joint.spring;
    let energy_j = |n: usize| {
        let (motor, link) = (
            x.motor_velocity_rad_s[[0, n]],
            x.link_velocity_rad_s[[0, n]],
        );
        0.5 * joint.joint.motor_inertia_kg_m2 * motor * motor
            + 0.5 * joint.link_inertia_kg_m2 * link * link
            + spring.energy_j(x.deflection_rad[[0, n]])
    };
    let (mut work_j, mut largest_j, mut n_beyond) = (0.0, 0.0_f64, 0);
    for n in 1..run.reference.ncols() {
        let moved_rad = x.motor_position_rad[[0, n]] - x.motor_position_rad[[0, n - 1]];
        work_j += run.reference[[0, n - 1]] * moved_rad;
        largest_j = largest_j.max(energy_j(n));
        n_beyond += usize::from(x.deflection_rad[[0, n]].abs() > spring.knee_rad);
        let error = (energy_j(n) - work_j).abs() / largest_j;
        assert!(error < 1e-11, "sample {n}: {error:e}");
    }
    assert!((100..2900).contains(&n_beyond), "{n_beyond}");
}

fn controller() -> PiController {
    PiController::new(vec![2000.0], vec![16000.0])
}

fn closed_loop(joint: &SingleJoint, integration: Integration) -> SimulatedRobot {
    SimulatedRobot {
        integration,
        ..SimulatedRobot::closed_loop(Arc::new(joint.clone()), Arc::new(controller()), T)
    }
}

#[test]
fn in_closed_loop_it_goes_as_by_runge_kutta() {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 30.0;
    joint.joint.spring.stiffness_beyond_nm_per_rad = 2.55e5;
    joint.joint.spring.knee_rad = 1e-4;
    for velocity_rad_s in [0.0, 0.1] {
        let run = run(T, 2.0, 0.08, velocity_rad_s);
        let found = closed_loop(&joint, Integration::Exact).simulate(&run);
        let Simulated { record, truth, .. } = found.expect("sound");
        let by_rk4 = SimulatedRobot {
            max_step_s: Some(2e-5),
            ..closed_loop(&joint, Integration::Rk4)
        };
        let by_rk4 = by_rk4.simulate(&run).expect("sound");
        let error = difference(&truth, &by_rk4.truth);
        assert!(error < 1e-8, "{error:e}");
        assert!((truth.stuck_share[0] - by_rk4.truth.stuck_share[0]).abs() < 1e-7);
        assert_eq!(record.check(), Ok(()));
    }
}

#[test]
fn side_by_side_each_moves_as_it_does_alone_to_the_last_digit() {
    let drawn: Vec<_> = (0..40).map(drawn).collect();
    let mut stuck = 0.0;
    for (hold, of_hold) in [(Hold::Zoh, 0), (Hold::Linear, 1)] {
        let robots: Vec<SimulatedRobot> =
            drawn.iter().map(|(joint, ..)| exact(joint, hold)).collect();
        let runs: Vec<Run> = (0..40)
            .map(|number| {
                // one after the other of a group ends, until so few are left that each goes on alone
                run(
                    1e-3,
                    0.45 + 0.05 * (number % 8) as f64,
                    60.0 + 4.0 * number as f64,
                    0.01 * f64::from(of_hold),
                )
            })
            .collect();
        let together = simulate_robots(robots.iter().zip(&runs), &|| true);
        for ((robot, run), together) in robots.iter().zip(&runs).zip(together) {
            let alone = robot.simulate(run).expect("sound");
            stuck += alone.truth.stuck_share[0];
            assert_eq!(together.as_ref().ok(), Some(&alone));
        }
    }
    assert!(stuck > 3.0, "{stuck}");
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 30.0;
    let robot = closed_loop(&joint, Integration::Exact);
    let runs: Vec<Run> = (1..20)
        .map(|number| run(T, 0.5, 0.01 * f64::from(number), 0.0))
        .collect();
    for (run, together) in runs.iter().zip(robot.simulate_each(&runs, &|| true)) {
        assert_eq!(together.ok(), robot.simulate(run).ok());
    }
}

#[test]
fn what_is_not_piecewise_linear_is_refused_by_its_name() {
    let refused = |found: Result<(), PlantError>| found.expect_err("refused").to_string();
    let mut rippled = SingleJoint::default();
    rippled.joint.ripple.push(Ripple {
        cycles_per_turn: 12.0,
        amplitude_nm: 3.0,
        phase_rad: 0.0,
    });
    let message = refused(Integration::Exact.check(&rippled));
    assert!(message.contains("torque ripple"), "{message}");
    assert!(message.ends_with("this joint has torque ripple; use integrator = \"rk4\""));
    assert_eq!(Integration::Rk4.check(&rippled), Ok(()));
    let arm = Arm {
        bodies: Vec::new(),
        payload: None,
        gravity_m_s2: [0.0, 0.0, -9.81],
        pose_rad: Vec::new(),
        challenges: Challenges::default(),
    };
    let message = refused(Integration::Exact.check(&arm));
    assert!(message.ends_with("use integrator = \"rk4\""), "{message}");

    let joint = SingleJoint::default();
    let mut motion = joint.start_exact(&[0.0], &[0.0], T).expect("sound");
    let message = refused(motion.advance(1, T, Acting::Function(&|t, _| t)));
    assert!(message.contains("function of time"), "{message}");
    let message = refused(motion.advance(1, 2.0 * T, Acting::Held(&[1.0])));
    assert!(message.starts_with("step_s is 0.002"), "{message}");
    let message = refused(joint.start_exact(&[0.0], &[0.0], 0.01).map(drop));
    assert!(message.contains("32nd of the period"), "{message}");
}
