//! Machines side by side against the same machines alone: every digit is the same.

use std::f64::consts::TAU;

use frfid_signals::random::stream;
use rand::RngExt as _;

use crate::arm::challenges::Challenges;
use crate::arm::inertia::Inertia;
use crate::arm::{Arm, Body, BodyJoint, Payload};
use crate::joint::flexible_joint::FlexibleJoint;
use crate::joint::ripple::Ripple;
use crate::lanes::LANES;
use crate::motion::fleet::{Fleet, squads};
use crate::motion::{Acting, Motion};
use crate::robot::Robot;
use crate::single_joint::SingleJoint;

const SAMPLE_TIME_S: f64 = 1e-3;

/// Joints that stick, slip and stiffen, each with numbers of its own.
fn joints(count: usize) -> Vec<SingleJoint> {
    let mut random = stream(1, "joints side by side", &[]);
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let joint = |index: usize| {
        let mut joint = SingleJoint {
            link_inertia_kg_m2: between(50.0, 200.0),
            ..SingleJoint::default()
        };
        joint.joint.motor_inertia_kg_m2 = between(20.0, 60.0);
        joint.joint.damping_nms_per_rad = between(100.0, 800.0);
        joint.joint.friction.viscous_nms_per_rad = between(0.0, 100.0);
        joint.joint.friction.coulomb_nm = [60.0, 20.0, 0.0][index % 3];
        if index % 2 == 1 {
            joint.joint.spring.stiffness_beyond_nm_per_rad = 2.55e5;
            joint.joint.spring.knee_rad = between(1e-4, 1e-3);
        }
        let ripple = |order: usize| Ripple {
            cycles_per_turn: 12.0 * order as f64,
            amplitude_nm: 3.0,
            phase_rad: 0.1,
        };
        joint.joint.ripple = (1..=index % 4).map(ripple).collect();
        joint
    };
    (0..count).map(joint).collect()
}

/// Arms that stick, slip and stiffen, each with numbers, gravity and a payload of its own; one in four
/// poses no challenge G.
fn arms(axes: usize, count: usize) -> Vec<Arm> {
    let mut random = stream(2, "arms side by side", &[]);
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let joints = joints(axes * count);
    let mut joints = joints.into_iter().map(|joint| FlexibleJoint {
        motor_inertia_kg_m2: 0.05 * joint.joint.motor_inertia_kg_m2,
        damping_nms_per_rad: 0.02 * joint.joint.damping_nms_per_rad,
        ..joint.joint
    });
    let mut body = |index: usize| Body {
        name: format!("body {index}"),
        offset_m: [between(-0.2, 0.2), between(-0.2, 0.2), between(0.1, 0.3)],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        axis: [between(-0.3, 0.3), (index % 2) as f64, between(0.2, 1.0)],
        mass_kg: between(2.0, 10.0),
        center_of_mass_m: [between(-0.1, 0.1), between(-0.1, 0.1), between(0.0, 0.3)],
        inertia_kg_m2: Inertia::default(),
        simplified: true,
        joint: BodyJoint::Flexible(joints.next().expect("one for each")),
    };
    let bodies = |_| (0..axes).map(&mut body).collect::<Vec<_>>();
    let bodies: Vec<_> = (0..count).map(bodies).collect();
    let arm = |(index, bodies): (usize, _)| Arm {
        bodies,
        payload: (!index.is_multiple_of(3)).then(|| Payload {
            mass_kg: between(1.0, 20.0),
            center_of_mass_m: [0.1, between(-0.1, 0.1), 0.2],
            inertia_kg_m2: Inertia::default(),
        }),
        gravity_m_s2: [0.0, between(-3.0, 3.0), -9.81],
        pose_rad: (0..axes).map(|_| between(-2.0, 2.0)).collect(),
        challenges: Challenges {
            gravity: Some(index % 4 < 3),
            ..Challenges::default()
        },
    };
    bodies.into_iter().enumerate().map(arm).collect()
}

/// Where a robot is and for how long it stuck.
fn place(motion: &dyn Motion) -> Vec<f64> {
    [
        motion.motor_position_rad(),
        motion.motor_velocity_rad_s(),
        motion.deflection_rad(),
        motion.link_velocity_rad_s(),
        motion.stuck_s(),
        &[motion.time_s()],
    ]
    .concat()
}

/// Robots side by side.
fn together(robots: &[impl Robot]) -> Vec<Box<dyn Fleet>> {
    let started = start(robots).into_iter().map(|motion| ((), motion));
    let squads = squads(started).into_iter();
    squads.map(|squad| squad.fleet).collect()
}

fn start(robots: &[impl Robot]) -> Vec<Box<dyn Motion>> {
    let axes = |robot: &dyn Robot| vec![0.0; robot.n_axes()];
    let started = robots.iter().map(|robot| {
        let rest = axes(robot);
        robot.start(&rest, &rest).expect("sound")
    });
    started.collect()
}

/// A torque in N m of three sines on every axis, others for every robot.
fn torque(robot: usize, axes: usize, sample: usize) -> Vec<f64> {
    let time_s = sample as f64 * SAMPLE_TIME_S;
    let sine = |k: usize| (TAU * (3.0 + 4.1 * k as f64) * time_s + (robot * k) as f64).sin();
    vec![50.0 * (0..3).map(sine).sum::<f64>(); axes]
}

/// Moves robots for a second, together and each alone; robot 2 is left out after a while.
fn assert_alike(robots: &[impl Robot], is_line: bool) {
    let (mut alone, mut together) = (start(robots), together(robots));
    let axes = robots[0].n_axes();
    for sample in 0..1000 {
        let torques: Vec<[Vec<f64>; 2]> = (0..robots.len())
            .map(|robot| [sample, sample + 1].map(|sample| torque(robot, axes, sample)))
            .collect();
        let acting = |robot: usize| {
            let [from, to] = &torques[robot];
            let acting = if is_line {
                Acting::Line(from, to)
            } else {
                Acting::Held(from)
            };
            (robot != 2 || sample < 300).then_some(acting)
        };
        for (robot, motion) in alone.iter_mut().enumerate() {
            if let Some(acting) = acting(robot) {
                motion.advance(10, 1e-4, acting).expect("sound");
            }
        }
        let mut first = 0;
        for fleet in &mut together {
            let range = first..first + fleet.n_robots();
            let failed = fleet.advance(10, 1e-4, &range.clone().map(acting).collect::<Vec<_>>());
            assert_eq!(failed, []);
            first = range.end;
        }
        let moved = together
            .iter()
            .flat_map(|fleet| (0..fleet.n_robots()).map(|robot| fleet.motion(robot)));
        for (robot, (together, alone)) in moved.zip(&alone).enumerate() {
            let same = place(together) == place(&**alone);
            assert!(same, "robot {robot}, sample {sample}");
        }
    }
    let stuck = alone.iter().map(|motion| motion.stuck_s()[0]);
    assert!(stuck.sum::<f64>() > 0.01);
}

#[test]
fn joints_side_by_side_move_as_each_does_alone_to_the_last_digit() {
    for count in [2, 5, LANES, LANES + 3] {
        for is_line in [false, true] {
            assert_alike(&joints(count), is_line);
        }
    }
}

#[test]
fn arms_side_by_side_move_as_each_does_alone_to_the_last_digit() {
    let several = [(1, 2), (2, 5), (3, LANES), (3, LANES + 1), (6, 5), (7, 3)];
    for (axes, count) in several {
        for is_line in [false, true] {
            assert_alike(&arms(axes, count), is_line);
        }
    }
}

#[test]
fn a_joint_that_diverges_does_not_touch_those_beside_it() {
    let (mut alone, together) = (start(&joints(4)), &mut together(&joints(4))[0]);
    for sample in 0..20 {
        let torques: Vec<f64> = (0..4)
            .map(|robot| {
                if robot == 1 {
                    f64::MAX
                } else {
                    torque(robot, 1, sample)[0]
                }
            })
            .collect();
        let acting = |robot: usize| Acting::Held(std::slice::from_ref(&torques[robot]));
        let acting: Vec<_> = (0..4)
            .map(|robot| (robot != 1 || sample == 0).then(|| acting(robot)))
            .collect();
        let found = together.advance(10, 1e-4, &acting);
        let alone_too = (0..4).filter_map(|robot| {
            let moved = alone[robot].advance(10, 1e-4, acting[robot]?);
            Some((robot, moved.err()?))
        });
        assert_eq!(found, alone_too.collect::<Vec<_>>(), "sample {sample}");
        for robot in [0, 2, 3] {
            assert_eq!(place(together.motion(robot)), place(&*alone[robot]));
        }
    }
}
