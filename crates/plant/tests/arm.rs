//! Arm without simulation: the numbers of the Manutec r3, and those of an
//! independent multibody code.

mod manutec_r3;

use frfid_plant::{
    Arm, Body, BodyJoint, Challenges, Inertia, Payload, PlantError, Robot as _, SingleJoint,
};
use manutec_r3::{ball, each_joint, manutec_r3};
use nalgebra::DVector;
use serde_json::Value;

/// Largest difference from printed numbers.
fn difference<'a>(found: impl IntoIterator<Item = &'a f64>, printed: &[f64]) -> f64 {
    let found: Vec<f64> = found.into_iter().copied().collect();
    assert_eq!(found.len(), printed.len());
    found
        .iter()
        .zip(printed)
        .map(|(found, printed)| (found - printed).abs())
        .fold(0.0, f64::max)
}

/// The printed numbers were made by a code that replaces the inertia tensor of b1, which no solid
/// body can have, by a third of its trace for each principal moment, and gives point masses a small
/// tensor (MuJoCo: `balanceinertia`, `boundinertia`). With these every printed digit must come out.
#[test]
fn the_r3_has_the_mass_matrix_gravity_and_modes_of_the_tables() {
    let mut arm = manutec_r3();
    assert_eq!(arm.warnings(), Vec::<String>::new());
    arm.bodies[0].inertia_kg_m2.iyy = 1.16 / 3.0;
    arm.bodies[5].inertia_kg_m2 = ball(1e-5);
    arm.payload.as_mut().expect("the load").inertia_kg_m2 = arm.bodies[5].inertia_kg_m2;
    let mass = arm.mass_matrix(&arm.pose_rad).expect("sound");
    let printed = [
        77.155, -4.740, -0.472, -4.740, 74.855, 29.070, -0.472, 29.070, 20.264,
    ];
    assert!(difference(&mass, &printed) < 0.5e-3, "{mass}");
    let gravity = arm.gravity_torque_nm(&arm.pose_rad).expect("sound");
    assert!(
        difference(&gravity, &[0.0, -460.57, -256.40]) < 0.5e-2,
        "{gravity:?}"
    );
    let modes = arm.modes_hz().expect("sound");
    assert!(
        difference(&modes, &[19.003, 31.533, 42.276]) < 0.5e-3,
        "{modes:?}"
    );
    let locked = arm.locked_motor_hz().expect("sound");
    assert!(
        difference(&locked, &[9.559, 12.508, 27.768]) < 0.5e-3,
        "{locked:?}"
    );
}

#[test]
fn the_r3_with_its_own_b1_differs_in_the_inertia_about_the_first_axis() {
    let arm = manutec_r3();
    let mass = arm.mass_matrix(&arm.pose_rad).expect("sound");
    assert!(
        (mass[(0, 0)] - (77.155 + 1.16 * 2.0 / 3.0)).abs() < 0.5e-3,
        "{mass}"
    );
    println!(
        "modes {:?}, with locked motors {:?} Hz",
        arm.modes_hz(),
        arm.locked_motor_hz()
    );
}

fn numbers(value: &Value) -> Vec<f64> {
    let values = value.as_array().expect("an array").iter();
    values
        .map(|number| number.as_f64().expect("a number"))
        .collect()
}

fn vector(value: &Value) -> [f64; 3] {
    numbers(value).try_into().expect("three numbers")
}

fn inertia(value: &Value) -> Inertia {
    let [[ixx, ixy, ixz], [_, iyy, iyz], [_, _, izz]] = matrix(value);
    Inertia {
        ixx,
        iyy,
        izz,
        ixy,
        ixz,
        iyz,
    }
}

fn matrix(value: &Value) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|row| vector(&value[row]))
}

fn mass(value: &Value) -> Payload {
    Payload {
        mass_kg: value["mass_kg"].as_f64().expect("a number"),
        center_of_mass_m: vector(&value["center_of_mass_m"]),
        inertia_kg_m2: inertia(&value["inertia_kg_m2"]),
    }
}

/// The arm that was drawn at random, with the joints of a single joint wherever it moves.
fn drawn_arm(golden: &Value) -> Arm {
    let body = |value: &Value| {
        let Payload {
            mass_kg,
            center_of_mass_m,
            inertia_kg_m2,
        } = mass(value);
        let moving = || BodyJoint::Flexible(SingleJoint::default().joint);
        let joint = value["position_rad"]
            .as_f64()
            .map_or_else(moving, |position_rad| BodyJoint::Locked { position_rad });
        Body {
            name: value["name"].to_string(),
            offset_m: vector(&value["offset_m"]),
            rotation: matrix(&value["rotation"]),
            axis: vector(&value["axis"]),
            mass_kg,
            center_of_mass_m,
            inertia_kg_m2,
            simplified: false,
            joint,
        }
    };
    Arm {
        bodies: golden["bodies"]
            .as_array()
            .expect("an array")
            .iter()
            .map(body)
            .collect(),
        payload: Some(mass(&golden["payload"])),
        gravity_m_s2: vector(&golden["gravity_m_s2"]),
        pose_rad: vec![0.1; 6],
        challenges: Challenges::default(),
    }
}

/// Largest difference relative to the largest number.
fn relative<'a>(found: impl IntoIterator<Item = &'a f64>, golden: &Value) -> f64 {
    let golden = numbers(golden);
    difference(found, &golden)
        / golden
            .iter()
            .fold(0.0, |peak: f64, value| peak.max(value.abs()))
}

#[test]
fn mass_matrix_bias_gravity_and_accelerations_are_those_of_an_independent_code() {
    let golden: Value =
        serde_json::from_str(include_str!("golden/arm_reference.json")).expect("JSON");
    for (mut arm, states) in [
        (manutec_r3(), &golden["manutec_r3"]),
        (drawn_arm(&golden["six"]), &golden["six"]["states"]),
    ] {
        assert_eq!(arm.warnings(), Vec::<String>::new());
        for state in states.as_array().expect("an array") {
            let [q, qd, torque] =
                ["position_rad", "velocity_rad_s", "torque_nm"].map(|name| numbers(&state[name]));
            let errors = [
                relative(&arm.mass_matrix(&q).expect("sound"), &state["mass_kg_m2"]),
                relative(
                    &arm.gravity_torque_nm(&q).expect("sound"),
                    &state["gravity_nm"],
                ),
                relative(&arm.bias_nm(&q, &qd).expect("sound"), &state["bias_nm"]),
                relative(
                    &arm.link_acceleration(&q, &qd, &torque).expect("sound"),
                    &state["acceleration_rad_s2"],
                ),
                relative(
                    &gravity_gradient(&mut arm, &q),
                    &state["gravity_gradient_nm_per_rad"],
                ),
            ];
            assert!(errors.iter().all(|&error| error < 1e-12), "{errors:?}");
        }
    }
}

/// The gradient of gravity, from the linear model: M qo'' = ... - G (qm - dq) with a gear that
/// holds nothing else.
fn gravity_gradient(arm: &mut Arm, q: &[f64]) -> Vec<f64> {
    arm.pose_rad = q.to_vec();
    let n = q.len();
    let model = arm.state_space();
    let mass = arm.mass_matrix(q).expect("sound");
    let gradient = -mass * model.a.view((3 * n, 0), (n, n));
    gradient.transpose().iter().copied().collect()
}

#[test]
fn coriolis_torques_do_the_work_that_the_mass_matrix_asks_for() {
    // qd (dM/dt - 2 C) qd = 0: dM/dt by differences of fourth order along the motion
    let golden: Value =
        serde_json::from_str(include_str!("golden/arm_reference.json")).expect("JSON");
    for arm in [manutec_r3(), drawn_arm(&golden["six"])] {
        let q: Vec<f64> = (0..arm.n_axes())
            .map(|axis| 0.3 + 0.7 * axis as f64)
            .collect();
        let qd: Vec<f64> = (0..arm.n_axes())
            .map(|axis| 1.0 - 0.6 * axis as f64)
            .collect();
        let velocity = DVector::from_row_slice(&qd);
        let twice_kinetic = |time: f64| {
            let at: Vec<f64> = q.iter().zip(&qd).map(|(q, qd)| q + time * qd).collect();
            let mass = arm.mass_matrix(&at).expect("sound");
            assert_eq!(mass, mass.transpose());
            velocity.dot(&(mass * &velocity))
        };
        let secant = |time: f64| (twice_kinetic(time) - twice_kinetic(-time)) / (2.0 * time);
        let rate = (4.0 * secant(1e-3) - secant(2e-3)) / 3.0;
        let bias = DVector::from(arm.bias_nm(&q, &qd).expect("sound"));
        let gravity = DVector::from(arm.gravity_torque_nm(&q).expect("sound"));
        let power = 2.0 * velocity.dot(&(bias - gravity));
        assert!(
            (power - rate).abs() < 1e-9 * twice_kinetic(0.0),
            "{power} {rate}"
        );
    }
}

#[test]
fn without_gravity_there_is_no_bias_and_without_position_dependence_one_mass_matrix() {
    let mut arm = manutec_r3();
    let (there, fast) = ([0.4, -0.3, 0.2], [1.0, 2.0, -3.0]);
    arm.challenges.gravity = Some(false);
    assert_eq!(arm.bias_nm(&there, &fast), Ok(vec![0.0; 3]));
    assert_ne!(arm.mass_matrix(&there), arm.mass_matrix(&arm.pose_rad));
    arm.challenges = Challenges {
        position_dependence: Some(false),
        ..Challenges::default()
    };
    assert_eq!(
        arm.mass_matrix(&there),
        manutec_r3().mass_matrix(&arm.pose_rad)
    );
    assert_eq!(arm.bias_nm(&there, &fast), arm.gravity_torque_nm(&there));
    assert_eq!(arm.modes_hz(), manutec_r3().modes_hz());
}

#[test]
fn what_cannot_be_is_refused_by_name_and_value() {
    let refused = |spoil: &dyn Fn(&mut Arm)| {
        let mut arm = manutec_r3();
        spoil(&mut arm);
        assert!(
            arm.default_step_s().is_nan()
                || matches!(arm.start(&[0.0; 3], &[0.0; 3]), Err(PlantError::Signal(_)))
        );
        assert_eq!(arm.state_space().c.ncols(), 4 * arm.n_axes());
        arm.check().expect_err("unsound").to_string()
    };
    let expect = |spoil: &dyn Fn(&mut Arm), parts: &[&str]| {
        let message = refused(spoil);
        assert!(
            parts.iter().all(|part| message.contains(part)),
            "{message} lacks some of {parts:?}"
        );
    };
    expect(
        &|arm| arm.bodies[3].inertia_kg_m2.izz = -2.0,
        &["body b4", "principal moment is -2,"],
    );
    expect(
        &|arm| arm.bodies[1].inertia_kg_m2.ixy = f64::NAN,
        &["body b2: inertia_kg_m2 is NaN"],
    );
    expect(
        &|arm| arm.bodies[3].mass_kg = -1.0,
        &["body b4: mass_kg is -1"],
    );
    expect(
        &|arm| arm.bodies[3].center_of_mass_m[1] = 1e200,
        &["mass matrix at the pose is NaN"],
    );
    expect(
        &|arm| arm.bodies[3].offset_m[1] = f64::NAN,
        &["body b4: offset_m is NaN"],
    );
    expect(
        &|arm| arm.bodies[2].axis = [0.0; 3],
        &["body b3: ", "axis", "is 0"],
    );
    expect(
        &|arm| arm.bodies[2].rotation[0][0] = 1.1,
        &["body b3: rotation", "rotation matrix"],
    );
    expect(
        &|arm| arm.bodies[2].rotation[0][0] = -1.0,
        &["body b3: rotation's determinant is -1"],
    );
    expect(
        &|arm| arm.pose_rad = vec![0.0; 2],
        &["pose_rad has shape [2], needed (3)"],
    );
    expect(&|arm| arm.pose_rad[1] = f64::INFINITY, &["pose_rad is inf"]);
    expect(
        &|arm| arm.gravity_m_s2[1] = f64::NAN,
        &["gravity_m_s2 is NaN"],
    );
    expect(
        &|arm| {
            each_joint(arm, |axis, joint| {
                if axis == 1 {
                    joint.spring.stiffness_nm_per_rad = 0.0;
                }
            });
        },
        &["body b2: stiffness_nm_per_rad is 0"],
    );
    expect(
        &|arm| arm.payload.as_mut().expect("the load").mass_kg = f64::NAN,
        &["payload: mass_kg is NaN"],
    );
    expect(&|arm| arm.bodies.clear(), &["moving joints is 0", "1 to 7"]);
    let eight = |arm: &mut Arm| {
        arm.bodies.extend(vec![arm.bodies[1].clone(); 5]);
        arm.pose_rad = vec![0.1; 8];
    };
    expect(&eight, &["moving joints is 8", "1 to 7"]);
    let massless = |arm: &mut Arm| {
        let axis = arm.bodies[2].axis;
        arm.payload = None;
        arm.bodies.truncate(3);
        let body = &mut arm.bodies[2];
        (body.mass_kg, body.inertia_kg_m2, body.axis) = (0.0, Inertia::default(), axis);
    };
    expect(&massless, &["smallest eigenvalue", "above 0"]);
}

#[test]
fn a_tensor_that_no_body_can_have_is_warned_of_unless_the_body_is_simplified() {
    let mut arm = manutec_r3();
    arm.bodies[0].simplified = false;
    let warnings = arm.warnings();
    assert!(
        warnings.len() == 1 && warnings[0].starts_with("body b1: ") && warnings[0].contains("1.16"),
        "{warnings:?}"
    );
    assert_eq!(arm.check(), Ok(()));
}
