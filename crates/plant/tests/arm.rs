//! What is known of the arm without simulating it: the numbers of the Manutec r3, and those of an independent multibody code.

use frfid_plant::{Arm, Body, BodyJoint, Challenges, FlexibleJoint, Hold, Payload, Robot as _, SingleJoint, Velocity};
use serde_json::Value;

mod manutec_r3;
use manutec_r3::{IDENTITY, each_joint, manutec_r3};

/// Largest difference from printed numbers.
fn difference<'a>(found: impl IntoIterator<Item = &'a f64>, printed: &[f64]) -> f64 {
    let found: Vec<f64> = found.into_iter().copied().collect();
    assert_eq!(found.len(), printed.len());
    found.iter().zip(printed).map(|(found, printed)| (found - printed).abs()).fold(0.0, f64::max)
}

/// The printed numbers were made by a code that replaces the inertia tensor of b1, which no solid body can have, by a third of
/// its trace for each principal moment, and gives point masses a small tensor (MuJoCo: `balanceinertia`, `boundinertia`). With
/// these every printed digit must come out.
#[test]
fn the_r3_has_the_mass_matrix_gravity_and_modes_of_the_tables() {
    let mut arm = manutec_r3();
    assert_eq!(arm.warnings(), Vec::<String>::new());
    arm.bodies[0].inertia_kg_m2[1][1] = 1.16 / 3.0;
    arm.bodies[5].inertia_kg_m2 = IDENTITY.map(|row| row.map(|value| 1e-5 * value));
    arm.payload.as_mut().expect("the load").inertia_kg_m2 = arm.bodies[5].inertia_kg_m2;
    let mass = arm.mass_matrix(&arm.pose_rad).expect("sound");
    let printed = [77.155, -4.740, -0.472, -4.740, 74.855, 29.070, -0.472, 29.070, 20.264];
    assert!(difference(&mass, &printed) < 0.5e-3, "{mass}");
    let gravity = arm.gravity_torque_nm(&arm.pose_rad).expect("sound");
    assert!(difference(&gravity, &[0.0, -460.57, -256.40]) < 0.5e-2, "{gravity:?}");
    let modes = arm.modes_hz().expect("sound");
    assert!(difference(&modes, &[19.003, 31.533, 42.276]) < 0.5e-3, "{modes:?}");
    let locked = arm.locked_motor_hz().expect("sound");
    assert!(difference(&locked, &[9.559, 12.508, 27.768]) < 0.5e-3, "{locked:?}");
}

#[test]
fn the_r3_with_its_own_b1_differs_in_the_inertia_about_the_first_axis() {
    let arm = manutec_r3();
    let mass = arm.mass_matrix(&arm.pose_rad).expect("sound");
    assert!((mass[(0, 0)] - (77.155 + 1.16 * 2.0 / 3.0)).abs() < 0.5e-3, "{mass}");
    println!("modes {:?}, with locked motors {:?} Hz", arm.modes_hz(), arm.locked_motor_hz());
}

fn numbers(value: &Value) -> Vec<f64> {
    let values = value.as_array().expect("an array").iter();
    values.map(|number| number.as_f64().expect("a number")).collect()
}

fn vector(value: &Value) -> [f64; 3] {
    numbers(value).try_into().expect("three numbers")
}

fn tensor(value: &Value) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|row| vector(&value[row]))
}

fn mass(value: &Value) -> Payload {
    Payload {
        mass_kg: value["mass_kg"].as_f64().expect("a number"),
        center_of_mass_m: vector(&value["center_of_mass_m"]),
        inertia_kg_m2: tensor(&value["inertia_kg_m2"]),
    }
}

/// The arm that was drawn at random, with the joints of a single joint wherever it moves.
fn drawn_arm(golden: &Value) -> Arm {
    let body = |value: &Value| {
        let Payload { mass_kg, center_of_mass_m, inertia_kg_m2 } = mass(value);
        let moving = || BodyJoint::Flexible(SingleJoint::default().flexible_joint());
        let joint =
            value["position_rad"].as_f64().map_or_else(moving, |position_rad| BodyJoint::Locked { position_rad });
        Body {
            name: value["name"].to_string(),
            offset_m: vector(&value["offset_m"]),
            rotation: tensor(&value["rotation"]),
            axis: vector(&value["axis"]),
            mass_kg,
            center_of_mass_m,
            inertia_kg_m2,
            simplified: false,
            joint,
        }
    };
    Arm {
        bodies: golden["bodies"].as_array().expect("an array").iter().map(body).collect(),
        payload: Some(mass(&golden["payload"])),
        gravity_m_s2: vector(&golden["gravity_m_s2"]),
        pose_rad: vec![0.1; 6],
        challenges: Challenges::default(),
    }
}

/// Largest difference relative to the largest number.
fn relative<'a>(found: impl IntoIterator<Item = &'a f64>, golden: &Value) -> f64 {
    let golden = numbers(golden);
    difference(found, &golden) / golden.iter().fold(0.0, |peak: f64, value| peak.max(value.abs()))
}

#[test]
fn mass_matrix_bias_gravity_and_accelerations_are_those_of_an_independent_code() {
    let golden: Value = serde_json::from_str(include_str!("golden/arm_reference.json")).expect("JSON");
    for (mut arm, states) in
        [(manutec_r3(), &golden["manutec_r3"]), (drawn_arm(&golden["six"]), &golden["six"]["states"])]
    {
        assert_eq!(arm.warnings(), Vec::<String>::new());
        for state in states.as_array().expect("an array") {
            let [q, qd, torque] = ["position_rad", "velocity_rad_s", "torque_nm"].map(|name| numbers(&state[name]));
            let errors = [
                relative(&arm.mass_matrix(&q).expect("sound"), &state["mass_kg_m2"]),
                relative(&arm.gravity_torque_nm(&q).expect("sound"), &state["gravity_nm"]),
                relative(&arm.bias_nm(&q, &qd).expect("sound"), &state["bias_nm"]),
                relative(&arm.link_acceleration(&q, &qd, &torque).expect("sound"), &state["acceleration_rad_s2"]),
                relative(&gravity_gradient(&mut arm, &q), &state["gravity_gradient_nm_per_rad"]),
            ];
            assert!(errors.iter().all(|&error| error < 1e-12), "{errors:?}");
        }
    }
}

/// The gradient of gravity, from the linear model: M qo'' = ... - G (qm - dq) with a gear that holds nothing else.
fn gravity_gradient(arm: &mut Arm, q: &[f64]) -> Vec<f64> {
    arm.pose_rad = q.to_vec();
    let n = q.len();
    let model = arm.state_space();
    let mass = arm.mass_matrix(q).expect("sound");
    let gradient = -mass * model.a.view((3 * n, 0), (n, n));
    gradient.transpose().iter().copied().collect()
}
