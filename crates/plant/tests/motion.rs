//! Motion of the joint: conservation laws, sticking, reversal, the knee, ripple, holds, and events
//! that hide in a step.

use std::f64::consts::TAU;

use frfid_plant::{Hold, Ripple, Robot as _, SingleJoint, Torque, Trajectory, simulate};
use frfid_signals::random::{normal, stream, uniform};
use ndarray::Array2;

const SAMPLE_TIME_S: f64 = 1e-3;

fn held(joint: &SingleJoint, velocity: f64, torque: &[f64]) -> Trajectory {
    let torque = Array2::from_shape_fn((1, torque.len()), |(_, n)| torque[n]);
    simulate(
        joint,
        Torque::Zoh(torque.view()),
        SAMPLE_TIME_S,
        velocity,
        None,
    )
    .expect("the joint is sound")
}

/// A torque for the first `on` of `n` samples, then none.
fn kick(torque: f64, on: usize, n: usize) -> Vec<f64> {
    (0..n).map(|k| if k < on { torque } else { 0.0 }).collect()
}

fn energy(joint: &SingleJoint, x: &Trajectory, n: usize) -> f64 {
    let kinetic = |inertia: f64, v: f64| 0.5 * inertia * v * v;
    kinetic(
        joint.joint.motor_inertia_kg_m2,
        x.motor_velocity_rad_s[[0, n]],
    ) + kinetic(joint.link_inertia_kg_m2, x.link_velocity_rad_s[[0, n]])
        + joint.joint.spring.energy_j(x.deflection_rad[[0, n]])
}

#[test]
fn momentum_grows_by_the_torque_less_the_friction() {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    let x = held(&joint, 0.5, &[150.0; 500]);
    for n in 0..500 {
        let momentum =
            35.0 * x.motor_velocity_rad_s[[0, n]] + 150.0 * x.link_velocity_rad_s[[0, n]];
        assert!((momentum - (185.0 * 0.5 + 100.0 * n as f64 * SAMPLE_TIME_S)).abs() < 1e-10);
    }
}

#[test]
fn an_undamped_joint_keeps_its_energy_through_both_knees() {
    let mut joint = SingleJoint::default();
    joint.joint.damping_nms_per_rad = 0.0;
    joint.joint.spring.stiffness_beyond_nm_per_rad = 2.55e5;
    joint.joint.spring.knee_rad = 4e-4;
    let x = held(&joint, 0.0, &kick(150.0, 30, 1000));
    let start = energy(&joint, &x, 30);
    assert!((30..1000).all(|n| (energy(&joint, &x, n) / start - 1.0).abs() < 1e-8));
    let (low, high) = x
        .deflection_rad
        .iter()
        .fold((0.0_f64, 0.0_f64), |(low, high), &dq| {
            (low.min(dq), high.max(dq))
        });
    assert!(
        low < -1.2 * joint.joint.spring.knee_rad && high > 1.2 * joint.joint.spring.knee_rad,
        "{low} {high}"
    );
}

#[test]
fn friction_takes_its_torque_times_the_way_and_nothing_when_stuck() {
    let mut joint = SingleJoint::default();
    joint.joint.damping_nms_per_rad = 0.0;
    joint.joint.friction.coulomb_nm = 20.0;
    let x = held(&joint, 0.0, &kick(150.0, 40, 1500));
    let (v, q) = (&x.motor_velocity_rad_s, &x.motor_position_rad);
    let mut kinds = [0; 2];
    for n in 40..1499 {
        let (before, after) = (v[[0, n]], v[[0, n + 1]]);
        let way = (q[[0, n + 1]] - q[[0, n]]).abs();
        if before * after > 0.0 || way == 0.0 {
            kinds[usize::from(way == 0.0)] += 1;
            let lost = energy(&joint, &x, n) - energy(&joint, &x, n + 1);
            assert!((lost - 20.0 * way).abs() < 1e-9, "{n}: {lost} for {way}");
        }
    }
    assert!(kinds.iter().all(|&count| count > 50), "{kinds:?}");
    assert!(x.stuck_share[0] > 0.1);
}

#[test]
fn a_stuck_motor_rests_exactly_until_friction_is_overcome() {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    for torque in [50.0, -50.0, 0.0] {
        let x = held(&joint, 0.0, &[torque; 300]);
        assert!(
            x.motor_velocity_rad_s
                .iter()
                .chain(&x.motor_position_rad)
                .all(|&value| value == 0.0)
        );
        assert!((x.stuck_share[0] - 1.0).abs() < 1e-12);
    }
    let x = held(&joint, 0.0, &[50.001; 300]);
    assert!(x.stuck_share[0] == 0.0 && x.motor_velocity_rad_s.iter().skip(1).all(|&v| v > 0.0));
}

#[test]
fn a_strong_reversal_does_not_stick_and_a_weak_one_does() {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    let reversal = |torque: f64| held(&joint, 0.005, &vec![-torque; 400]);
    let strong = reversal(400.0);
    assert_eq!(strong.stuck_share[0], 0.0);
    assert!(strong.motor_velocity_rad_s[[0, 399]] < -0.5);
    assert!(reversal(20.0).stuck_share[0] > 0.3);
}

#[test]
fn a_step_hides_no_break_away_and_no_reversal() {
    // one step of 1 ms; the torque crosses F_c upwards and downwards within it, seen at both ends
    // below it
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    let pulse = |time: f64, _| 50.5 - 4e6 * (time - 0.5e-3).powi(2);
    let torque = Torque::Analytic {
        torque: &pulse,
        n_samples: 2,
    };
    let x = simulate(&joint, torque, SAMPLE_TIME_S, 0.0, Some(1e-3)).expect("sound");
    // above F_c from 0.146 to 0.854 ms; then the motor slips until its momentum is spent, still
    // within the step
    assert!(
        x.stuck_share[0] > 0.14 && x.stuck_share[0] < 0.4,
        "{:?}",
        x.stuck_share
    );
    assert!(
        x.motor_position_rad[[0, 1]] > 1e-10,
        "{}",
        x.motor_position_rad
    );

    // a velocity that dips below 0 within the step: slow forward motion, braked, then driven on
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 5.0;
    let brake = |time: f64, _| -400.0 * (1.0 - 2.0 * time / 1e-3);
    let torque = Torque::Analytic {
        torque: &brake,
        n_samples: 2,
    };
    let x = simulate(&joint, torque, SAMPLE_TIME_S, 2e-3, Some(1e-3)).expect("sound");
    let fine = simulate(&joint, torque, SAMPLE_TIME_S, 2e-3, Some(1e-6)).expect("sound");
    assert!((x.motor_velocity_rad_s[[0, 1]] - fine.motor_velocity_rad_s[[0, 1]]).abs() < 1e-8);
}

#[test]
fn chance_finds_no_chatter_and_a_coarse_step_agrees_with_a_fine_one() {
    for seed in 0..200 {
        let mut rng = stream(seed, "joints", &[]);
        let mut between = |low: f64, high: f64| low * (high / low).powf(uniform(&mut rng));
        let mut joint = SingleJoint::default();
        joint.joint.damping_nms_per_rad = between(1.0, 1e4);
        joint.joint.friction.coulomb_nm = between(0.1, 100.0);
        joint.joint.spring.stiffness_beyond_nm_per_rad = between(1e5, 5e5);
        joint.joint.spring.knee_rad = between(1e-6, 1e-3);
        joint.joint.friction.viscous_nms_per_rad = between(0.1, 100.0);
        joint.joint.ripple = vec![Ripple {
            cycles_per_turn: between(1.0, 1e4),
            amplitude_nm: between(0.01, 10.0),
            phase_rad: 0.0,
        }];
        let strength = between(1.0, 500.0);
        let torque = Array2::from_shape_fn((1, 500), |_| (strength * normal(&mut rng)).round());
        for torque in [Torque::Zoh(torque.view()), Torque::Linear(torque.view())] {
            let run = |step_s| {
                simulate(&joint, torque, SAMPLE_TIME_S, 0.0, Some(step_s))
                    .unwrap_or_else(|e| panic!("seed {seed} {step_s} {joint:?} {strength}: {e}"))
            };
            let (coarse, fine) = (run(5e-4), run(5e-5));
            let peak = fine
                .motor_velocity_rad_s
                .iter()
                .fold(1e-9_f64, |peak, v| peak.max(v.abs()));
            let differences = (&coarse.motor_velocity_rad_s - &fine.motor_velocity_rad_s) / peak;
            let worst = differences
                .iter()
                .fold(0.0_f64, |worst, d| worst.max(d.abs()));
            assert!(worst < 1e-4, "seed {seed}: {worst}");
        }
    }
}

#[test]
fn ripple_shows_at_its_cycles_times_the_speed_with_the_truth_s_gain() {
    let (speed, cycles) = (0.5, 120.0);
    let ripple = vec![Ripple {
        cycles_per_turn: cycles,
        amplitude_nm: 0.01,
        phase_rad: 0.3,
    }];
    let mut joint = SingleJoint::default();
    joint.joint.ripple = ripple;
    let x = held(&joint, speed, &[0.0; 4000]);
    let hz = cycles * speed / TAU;
    let truth = joint
        .frf(&[hz], Hold::Continuous, SAMPLE_TIME_S)
        .expect("sound")
        .response[[0, 0, 0]];
    // after 2 s the transient is gone: nothing is left but the sine -0.01 |P| sin(2 pi f t + 0.3 +
    // arg P) and a constant
    let sine = |n: usize| {
        -0.01 * truth.norm() * (TAU * hz * n as f64 * SAMPLE_TIME_S + 0.3 + truth.arg()).sin()
    };
    let rest: Vec<f64> = (2000..4000)
        .map(|n| x.motor_velocity_rad_s[[0, n]] - sine(n))
        .collect();
    let (low, high) = rest.iter().fold((f64::MAX, f64::MIN), |(low, high), &v| {
        (low.min(v), high.max(v))
    });
    assert!(
        high - low < 0.01 * 0.01 * truth.norm(),
        "{} of {}",
        high - low,
        0.01 * truth.norm()
    );
}

#[test]
fn an_analytic_torque_meets_the_continuous_truth() {
    let joint = SingleJoint::default();
    for hz in [2.0, 11.6211, 60.0] {
        let sine = |time: f64, _| (TAU * hz * time).cos();
        let torque = Torque::Analytic {
            torque: &sine,
            n_samples: 4000,
        };
        // RK4 takes the integral of the torque by Simpson's rule, (2 pi f step)^4 / 2880: 4e-11 at
        // 60 Hz
        let x = simulate(&joint, torque, SAMPLE_TIME_S, 0.0, Some(5e-5)).expect("sound");
        let truth = joint
            .frf(&[hz], Hold::Continuous, SAMPLE_TIME_S)
            .expect("sound")
            .response[[0, 0, 0]];
        let steady =
            |n: usize| truth.norm() * (TAU * hz * n as f64 * SAMPLE_TIME_S + truth.arg()).cos();
        let offset = x.motor_velocity_rad_s[[0, 3999]] - steady(3999); // the rigid body keeps what the start gave it
        let worst = (3500..4000)
            .map(|n| (x.motor_velocity_rad_s[[0, n]] - steady(n) - offset).abs())
            .fold(0.0, f64::max);
        assert!(
            worst < 1e-9 * truth.norm(),
            "{hz} Hz: {}",
            worst / truth.norm()
        );
    }
}
