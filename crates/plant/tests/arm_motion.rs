//! Motion of the arm: conservation of energy, rest under gravity, the single joint as its simplest
//! case, the linear truth.

mod manutec_r3;

use frfid_plant::{
    Acting, Arm, Body, BodyJoint, Challenges, Hold, Motion, Ripple, Robot as _, SingleJoint,
    Torque, simulate,
};
use frfid_signals::random::{normal, stream};
use manutec_r3::{IDENTITY, ball, each_joint, manutec_r3, with_ripple};
use nalgebra::{DMatrix, DVector};
use ndarray::Array2;
use num_complex::Complex64;

/// The r3 without friction and damping, in motion under gravity.
fn lossless() -> Arm {
    let mut arm = manutec_r3();
    each_joint(&mut arm, |_, joint| {
        (
            joint.damping_nms_per_rad,
            joint.friction.coulomb_nm,
            joint.friction.viscous_nms_per_rad,
        ) = (0.0, 0.0, 0.0);
    });
    arm
}

/// Largest change of energy in J over 10 s without input, and the largest kinetic energy.
fn energy_error(arm: &Arm, step_s: f64) -> (f64, f64) {
    let mut motion = arm.start(&[0.0; 3], &[0.3, -0.2, 0.4]).expect("sound");
    let start = arm.energy_j(&*motion).expect("sound");
    let mut worst = (0.0_f64, 0.0_f64);
    let n_steps = (0.1 / step_s).round() as usize;
    for _ in 0..100 {
        motion
            .advance(n_steps, 0.1 / n_steps as f64, Acting::Held(&[0.0; 3]))
            .expect("finite");
        let energy = arm.energy_j(&*motion).expect("sound");
        let mass = arm.mass_matrix(&link_position(&*motion)).expect("sound");
        let velocity = DVector::from_row_slice(motion.link_velocity_rad_s());
        worst = (
            worst.0.max((energy - start).abs()),
            worst.1.max(0.5 * velocity.dot(&(mass * &velocity))),
        );
    }
    worst
}

fn link_position(motion: &dyn Motion) -> Vec<f64> {
    motion
        .motor_position_rad()
        .iter()
        .zip(motion.deflection_rad())
        .map(|(qm, dq)| qm - dq)
        .collect()
}

#[test]
fn energy_is_kept_to_the_fifth_power_of_the_step() {
    let arm = lossless();
    // what oscillates: the energy of gears that carry gravity until the motors let go
    let gravity = arm.gravity_torque_nm(&arm.pose_rad).expect("sound");
    let oscillation: f64 = arm
        .joints()
        .zip(&gravity)
        .map(|(joint, g)| 0.5 * g * g / joint.spring.stiffness_nm_per_rad)
        .sum();
    let errors = [4e-4, 2e-4, 1e-4].map(|step| energy_error(&arm, step).0);
    for pair in errors.windows(2) {
        assert!(
            (pair[0] / pair[1]).log2() > 4.9 && (pair[0] / pair[1]).log2() < 5.1,
            "{errors:?}"
        );
    }
    let (finest, kinetic) = energy_error(&arm, 4e-5);
    println!(
        "oscillation {oscillation} J, links up to {kinetic} J, errors {errors:?}, at 40 us {finest:e} J"
    );
    assert!(finest < 1e-9 * oscillation, "{finest} of {oscillation}");
}

#[test]
fn held_under_gravity_the_arm_rests() {
    let mut stiffening = with_ripple(manutec_r3());
    each_joint(&mut stiffening, |_, joint| {
        joint.spring.knee_rad = 1e-3; // 460 N m deflect the second gear by 1.3 mrad
        joint.spring.stiffness_beyond_nm_per_rad *= 1.7;
    });
    let mut smooth = stiffening.clone();
    smooth.challenges = Challenges {
        coulomb_friction: Some(false),
        torque_ripple: Some(false),
        ..Challenges::default()
    };
    for arm in [stiffening, smooth] {
        for start in [[0.0; 3], [0.05, -0.04, 0.03]] {
            let mut motion = arm.start(&start, &[0.0; 3]).expect("sound");
            let at: Vec<f64> = arm
                .pose_rad
                .iter()
                .zip(start)
                .map(|(pose, start)| pose + start)
                .collect();
            assert!(motion.deflection_rad()[1].abs() > 1e-3);
            let holding = motion.holding_nm();
            let gravity = arm.gravity_torque_nm(&at).expect("sound");
            assert!(
                holding
                    .iter()
                    .zip(&gravity)
                    .all(|(holding, gravity)| (holding - gravity).abs() < 1e-9)
            );
            for _ in 0..1000 {
                motion
                    .advance(4, 0.25e-3, Acting::Held(&holding))
                    .expect("finite");
            }
            let velocities = motion
                .motor_velocity_rad_s()
                .iter()
                .chain(motion.link_velocity_rad_s());
            assert!(
                velocities.into_iter().all(|v| v.abs() < 1e-11),
                "{motion:?}",
                motion = motion.link_velocity_rad_s()
            );
            let moved = link_position(&*motion)
                .iter()
                .zip(&at)
                .map(|(q, at)| (q - at).abs())
                .fold(0.0, f64::max);
            assert!(moved < 1e-12, "{moved}");
        }
    }
}

#[test]
fn a_stuck_axis_rests_exactly_while_the_others_move() {
    let arm = with_ripple(manutec_r3());
    let mut motion = arm.start(&[0.0; 3], &[0.0; 3]).expect("sound");
    let mut torque = motion.holding_nm();
    torque[2] += 80.0; // 38 N m above friction
    for _ in 0..200 {
        motion
            .advance(4, 0.25e-3, Acting::Held(&torque))
            .expect("finite");
    }
    assert_eq!(motion.motor_velocity_rad_s()[0], 0.0);
    assert!(
        (motion.stuck_s()[0] - 0.2).abs() < 1e-12,
        "{:?}",
        motion.stuck_s()
    );
    assert!(
        motion.stuck_s()[2] < 1e-3 && motion.motor_velocity_rad_s()[2] > 0.1,
        "{:?}",
        motion.motor_velocity_rad_s()
    );
}

/// An arm of one body that turns about a vertical axis, with the joint and the inertia of a single
/// joint.
fn turntable(joint: &SingleJoint) -> Arm {
    let (mass_kg, arm_m) = (20.0, 0.5);
    let own = joint.link_inertia_kg_m2 - mass_kg * arm_m * arm_m;
    let body = Body {
        name: "table".into(),
        offset_m: [0.1, 0.2, 0.3],
        rotation: IDENTITY,
        axis: [0.0, 0.0, 2.0],
        mass_kg,
        center_of_mass_m: [0.3, 0.4, 0.7],
        inertia_kg_m2: ball(own),
        simplified: false,
        joint: BodyJoint::Flexible(joint.joint.clone()),
    };
    Arm {
        bodies: vec![body],
        payload: None,
        gravity_m_s2: [0.0, 0.0, -9.81],
        pose_rad: vec![0.0],
        challenges: Challenges::default(),
    }
}

#[test]
fn one_body_about_a_vertical_axis_is_the_single_joint() {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    joint.joint.friction.viscous_nms_per_rad = 20.0;
    joint.joint.spring.stiffness_beyond_nm_per_rad = 2.55e5;
    joint.joint.spring.knee_rad = 4e-4;
    joint.joint.ripple = vec![Ripple {
        cycles_per_turn: 120.0,
        amplitude_nm: 3.0,
        phase_rad: 0.1,
    }];
    let arm = turntable(&joint);
    let mut rng = stream(1, "arm", &[]);
    let torque = Array2::from_shape_fn((1, 2000), |_| 200.0 * normal(&mut rng));
    let run =
        |robot| simulate(robot, Torque::Zoh(torque.view()), 1e-3, 0.0, Some(2e-4)).expect("sound");
    let (single, body) = (run(&joint), run(&arm));
    let difference = (&single.motor_velocity_rad_s - &body.motor_velocity_rad_s)
        .iter()
        .fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(difference < 1e-12, "{difference}");
    assert!((single.stuck_share[0] - body.stuck_share[0]).abs() < 1e-12);
    let (a, b) = (joint.state_space(), arm.state_space());
    assert!((&a.a - &b.a).amax() < 1e-12 * a.a.amax() && a.b == b.b && a.c == b.c && a.d == b.d);
}

/// States (qm, dq, qm', qo') of the linear model behind a zero-order hold, the integrator's own or
/// the exact ones.
fn sampled(arm: &Arm, sample_time_s: f64, n_steps: Option<usize>) -> (DMatrix<f64>, DMatrix<f64>) {
    let model = arm.state_space();
    let (n, inputs) = model.b.shape();
    let mut generator = DMatrix::zeros(n + inputs, n + inputs);
    generator.view_mut((0, 0), (n, n)).copy_from(&model.a);
    generator.view_mut((0, n), (n, inputs)).copy_from(&model.b);
    let flow = match n_steps {
        None => (generator * sample_time_s).exp(),
        Some(n_steps) => {
            let one = DMatrix::identity(n + inputs, n + inputs);
            let g = generator * (sample_time_s / n_steps as f64);
            let step = &one + &g * (&one + &g / 2.0 * (&one + &g / 3.0 * (&one + &g / 4.0)));
            (0..n_steps).fold(one, |flow, _| flow * &step)
        }
    };
    (
        flow.view((0, 0), (n, n)).into_owned(),
        flow.view((0, n), (n, inputs)).into_owned(),
    )
}

/// Challenge D off, and what the linear truth leaves out.
fn linear() -> Arm {
    let mut arm = with_ripple(manutec_r3());
    arm.challenges = Challenges {
        position_dependence: Some(false),
        coulomb_friction: Some(false),
        torque_ripple: Some(false),
        ..Challenges::default()
    };
    arm
}

#[test]
fn without_position_dependence_the_linear_truth_holds_however_far_the_arm_travels() {
    let arm = linear();
    let mut rng = stream(2, "arm", &[]);
    let change = Array2::from_shape_fn((3, 2000), |_| 1000.0 * normal(&mut rng));
    let gravity = arm.gravity_torque_nm(&arm.pose_rad).expect("sound");
    let torque = Array2::from_shape_fn((3, 2000), |(axis, n)| gravity[axis] + change[[axis, n]]);
    let x = simulate(&arm, Torque::Zoh(torque.view()), 1e-3, 0.0, Some(5e-5)).expect("sound");
    let (phi, gamma) = sampled(&arm, 1e-3, None);
    let mut state = DVector::<f64>::zeros(12);
    let (mut worst, mut peak, mut travel) = (0.0_f64, 0.0_f64, 0.0_f64);
    for n in 0..2000 {
        for axis in 0..3 {
            worst = worst.max((x.motor_velocity_rad_s[[axis, n]] - state[6 + axis]).abs());
            peak = peak.max(state[6 + axis].abs());
            travel = travel.max(state[axis].abs());
        }
        state = &phi * state + &gamma * DVector::from_iterator(3, change.column(n).iter().copied());
    }
    assert!(
        travel > 1.0 && worst < 1e-8 * peak,
        "{worst} of {peak} rad/s over {travel} rad"
    );
}

#[test]
fn the_default_step_keeps_the_frf_within_a_millionth() {
    let arm = linear();
    let hz: Vec<f64> = (4..=600).map(|k| 0.1 * f64::from(k)).collect();
    let truth = arm.frf(&hz, Hold::Zoh, 1e-3).expect("sound").response;
    let error = |n_steps: usize| {
        let (phi, gamma) = sampled(&arm, 1e-3, Some(n_steps));
        let mut worst = 0.0_f64;
        for (line, f) in hz.iter().enumerate() {
            let z = Complex64::cis(std::f64::consts::TAU * f * 1e-3);
            let pencil = DMatrix::from_diagonal_element(12, 12, z) - phi.map(Complex64::from);
            let states = pencil
                .lu()
                .solve(&gamma.map(Complex64::from))
                .expect("no pole here");
            let truth = DMatrix::from_fn(3, 3, |i, j| truth[[line, i, j]]);
            worst = worst.max((states.rows(6, 3) - &truth).norm() / truth.norm());
        }
        worst
    };
    let n_steps = (1e-3 / arm.default_step_s() - 1e-9).ceil() as usize;
    println!(
        "{} s: {n_steps} steps, {:?}",
        arm.default_step_s(),
        [2, 4, 6, 10, 20].map(error)
    );
    assert_eq!(n_steps, 6);
    assert!(
        error(n_steps) < 1e-6 && error(n_steps - 1) > 1e-6,
        "{}",
        error(n_steps)
    );
    assert!(error(4) < 4e-6 && error(10) < 1e-7 && error(20) < 6.2e-9);
}

#[test]
fn gears_beyond_their_knee_under_gravity_are_as_stiff_as_there_in_the_truth() {
    let mut arm = manutec_r3();
    each_joint(&mut arm, |_, joint| {
        (
            joint.spring.knee_rad,
            joint.spring.stiffness_beyond_nm_per_rad,
        ) = (1.25e-3, 1e6);
    });
    // motor: -k / J in the column of the deflection; axis 2 rests at 1.306 mrad, axis 3 at 1.228
    // mrad, axis 1 at 0
    let slope =
        |arm: &Arm, axis: usize, inertia: f64| -arm.state_space().a[(6 + axis, 3 + axis)] * inertia;
    let slopes = |arm: &Arm| {
        [
            slope(arm, 0, 14.3325),
            slope(arm, 1, 57.33),
            slope(arm, 2, 4.68),
        ]
    };
    let near = |found: [f64; 3], needed: [f64; 3]| {
        found
            .iter()
            .zip(needed)
            .all(|(f, n)| (f - n).abs() < 1e-6 * n)
    };
    assert!(
        near(slopes(&arm), [474_075.0, 1e6, 208_800.0]),
        "{:?}",
        slopes(&arm)
    );
    arm.challenges.stiffening = Some(false);
    assert!(
        near(slopes(&arm), [474_075.0, 352_800.0, 208_800.0]),
        "{:?}",
        slopes(&arm)
    );
}
