//! The robots under `examples/robots/`: the numbers of their source, one arm from TOML and from
//! URDF, and what is refused.

use std::path::{Path, PathBuf};

use frfid_experiment::{ConfigError, RobotTable};
use frfid_plant::Inertia;
use frfid_signals::Limit;

fn robots() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots")
}

fn load(name: &str) -> RobotTable {
    RobotTable::load(&robots().join(name)).unwrap_or_else(|error| panic!("{error}"))
}

fn close(found: &[f64], needed: &[f64], tolerance: f64) {
    assert_eq!(found.len(), needed.len());
    for (found, needed) in found.iter().zip(needed) {
        assert!(
            (found - needed).abs() <= tolerance,
            "{found} instead of {needed}"
        );
    }
}

/// Mass matrix and gravity from an independent multibody code, modes from scipy (METHOD.md section
/// 4, to the printed digits).
#[test]
fn the_manutec_r3_has_the_numbers_of_its_source() {
    let mut robot = load("manutec_r3.toml");
    // that code spreads the moment of inertia of the simplified first body over its three axes, and
    // has no point masses
    robot.body[0].inertia_kg_m2.iyy /= 3.0;
    let speck = Inertia {
        ixx: 1e-5,
        iyy: 1e-5,
        izz: 1e-5,
        ..Inertia::default()
    };
    robot.body[5].inertia_kg_m2 = speck;
    robot.payload.as_mut().expect("the load").inertia_kg_m2 = speck;
    let arm = robot.arm().expect("an arm");
    let mass = arm.mass_matrix(&arm.pose_rad).expect("sound");
    let printed = [
        77.155, -4.740, -0.472, -4.740, 74.855, 29.070, -0.472, 29.070, 20.264,
    ];
    close(mass.as_slice(), &printed, 0.5001e-3);
    close(
        &arm.gravity_torque_nm(&arm.pose_rad).expect("sound"),
        &[0.0, -460.57, -256.40],
        0.5001e-2,
    );
    close(
        &arm.modes_hz().expect("sound"),
        &[19.003, 31.533, 42.276],
        0.5001e-3,
    );
    close(
        &arm.locked_motor_hz().expect("sound"),
        &[9.559, 12.508, 27.768],
        0.5001e-3,
    );
    let joints: Vec<_> = arm.joints().collect();
    close(
        &joints
            .iter()
            .map(|joint| joint.friction.viscous_nms_per_rad)
            .collect::<Vec<_>>(),
        &[8.958, 33.92, 5.538],
        0.5001e-2,
    );
    close(
        &joints
            .iter()
            .map(|joint| joint.ripple[0].cycles_per_turn)
            .collect::<Vec<_>>(),
        &[1260.0, 2520.0, 720.0],
        0.0,
    );
    assert_eq!(arm.warnings(), Vec::<String>::new());
}

#[test]
fn one_arm_from_toml_and_from_urdf_is_the_same() {
    let (tables, urdf) = (load("six_axis.toml"), load("six_axis_flexibility.toml"));
    let limits = |robot: &RobotTable| {
        let limits = robot.limits();
        [Limit::Torque, Limit::Velocity].map(|limit| limits.get(limit).map(<[f64]>::to_vec))
    };
    assert_eq!(
        limits(&tables),
        limits(&urdf),
        "those of URDF stand in where the tables are silent"
    );
    assert_eq!(
        (tables.sensors(), tables.joint_names()),
        (urdf.sensors(), urdf.joint_names())
    );
    let (ours, theirs) = (tables.arm().expect("an arm"), urdf.arm().expect("an arm"));
    assert_eq!(
        (ours.warnings(), theirs.warnings()),
        (Vec::new(), Vec::new())
    );
    for pose in [ours.pose_rad.clone(), vec![0.3, -0.7, 1.1, 0.9, -0.4, 2.0]] {
        let mass = [&ours, &theirs].map(|arm| arm.mass_matrix(&pose).expect("sound"));
        close(mass[0].as_slice(), mass[1].as_slice(), 1e-10);
        let gravity = [&ours, &theirs].map(|arm| arm.gravity_torque_nm(&pose).expect("sound"));
        close(&gravity[0], &gravity[1], 1e-9);
    }
}

/// What is said of a robot file with `from` replaced by `to`.
fn complaint(name: &str, from: &str, to: &str) -> ConfigError {
    let text = std::fs::read_to_string(robots().join(name)).expect("readable");
    assert!(text.contains(from), "{from} is not in {name}");
    let folder = std::env::temp_dir().join(format!(
        "frfid-robot-{}-{}",
        std::process::id(),
        to.len() * 1000 + from.len()
    ));
    std::fs::create_dir_all(&folder).expect("writable");
    for file in ["six_axis.urdf", "six_axis_flexibility.toml"] {
        std::fs::copy(robots().join(file), folder.join(file)).expect("writable");
    }
    std::fs::write(folder.join(name), text.replacen(from, to, 1)).expect("writable");
    let read = if name.ends_with(".urdf") {
        "six_axis_flexibility.toml"
    } else {
        name
    };
    let error = RobotTable::load(&folder.join(read)).expect_err(to);
    std::fs::remove_dir_all(&folder).expect("ours");
    error
}

#[test]
fn a_robot_that_cannot_be_is_refused_with_its_place() {
    let r3 = "manutec_r3.toml";
    let arm = "six_axis_flexibility.toml";
    let all = [
        (
            r3,
            "ixx = 2.58",
            "ixx = -2.58",
            "principal moment",
            "inertia_kg_m2",
        ),
        (
            r3,
            "mass_kg = 56.5",
            "mass_kg = -56.5",
            "body joint_2: mass_kg is -56.5",
            "-56.5",
        ),
        (
            r3,
            "axis = [1.0, 0.0, 0.0]",
            "axis = [0.0, 0.0, 0.0]",
            "body joint_2: axis",
            "[0.0, 0.0, 0.0]",
        ),
        (
            r3,
            "stiffness_nm_per_rad = 352800.0",
            "stiffness_nm_per_rad = 0.0",
            "joint joint_2: stiffness",
            "0.0",
        ),
        (
            r3,
            "gear_ratio = 210.0",
            "gear_ratio = 0",
            "of either sign",
            "0",
        ),
        (
            r3,
            "torque_quantum_nm = 0.5",
            "torque_quantum_nm = -0.5",
            "torque_quantum_nm is -0.5",
            "-0.5",
        ),
        (
            r3,
            "max_velocity = 1.5",
            "max_velocity = 1.5\nmin_position = 0.5",
            "joint joint_2 at 0.349",
            "0.3490658503988659",
        ),
        (
            r3,
            "max_velocity = 1.5",
            "max_velocity = 0.0",
            "max_velocity is 0, needed",
            "0.0",
        ),
        (
            r3,
            "locked_position_rad = 0.0",
            "",
            "needed: locked_position_rad",
            "",
        ),
        (
            r3,
            "name = \"joint_5\"",
            "name = \"joint_4\"",
            "two bodies are called",
            "\"joint_4\"",
        ),
        (
            r3,
            "stiffness_nm_per_rad",
            "stiffness",
            "unknown field `stiffness`",
            "stiffness",
        ),
        (
            arm,
            "urdf.joint.joint_3",
            "urdf.joint.joint_9",
            "no joint of the chain is called joint_9",
            "joint",
        ),
        (
            arm,
            "file = \"six_axis",
            "file = \"seven_axis",
            "cannot read",
            "\"seven_axis.urdf\"",
        ),
        (
            arm,
            "simplified = [\"joint_1\"]",
            "simplified = [\"joint_7\"]",
            "no joint of the chain is called joint_7",
            "joint_7",
        ),
        (
            arm,
            "motor_inertia_kg_m2 = 14.3325",
            "motor_inertia_kg_m2 = 0.0",
            "joint joint_1: motor_inertia",
            "0.0",
        ),
        (
            "six_axis.urdf",
            "type=\"continuous\"",
            "type=\"prismatic\"",
            "joint joint_1 is prismatic",
            "\"six_axis.urdf\"",
        ),
        (
            "six_axis.urdf",
            "value=\"56.5\"",
            "value=\"-56.5\"",
            "body joint_2: mass_kg is -56.5",
            "\"six_axis.urdf\"",
        ),
        (
            "six_axis.urdf",
            "</robot>",
            "<robot>",
            "not URDF",
            "\"six_axis.urdf\"",
        ),
    ];
    for (name, from, to, reason, marked) in all {
        let error = complaint(name, from, to);
        let place = error
            .place
            .clone()
            .unwrap_or_else(|| panic!("no place: {error}"));
        let found: String = place
            .text
            .chars()
            .skip(place.column - 1)
            .take(place.width)
            .collect();
        assert!(error.message.contains(reason), "{error}");
        assert!(found.contains(marked), "{error}");
    }
}

#[test]
fn an_inertia_that_no_body_has_is_a_warning_unless_the_body_is_simplified() {
    let mut robot = load("manutec_r3.toml");
    robot.body[1].inertia_kg_m2.ixx = 25.8;
    let warnings = robot.arm().expect("an arm").warnings();
    assert!(
        warnings.len() == 1 && warnings[0].contains("joint_2"),
        "{warnings:?}"
    );
    robot.body[1].simplified = true;
    assert_eq!(
        robot.arm().expect("an arm").warnings(),
        Vec::<String>::new()
    );
}
