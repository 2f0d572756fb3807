//! Descriptions to start from, of arms in URDF: sound at once, and what cannot be guessed is named.

use std::fs;
use std::path::Path;

use frfid_experiment::{ConfigError, Experiment, TomlText, description_of_urdf};

/// The description of a URDF, and the experiment that it describes, links named where it has several.
fn started(urdf: &str, tip_link: Option<&str>) -> Result<(String, Experiment), ConfigError> {
    let folder = tempfile::tempdir().expect("writable");
    let path = folder.path().join("arm.urdf");
    fs::write(&path, urdf).expect("writable");
    let text = description_of_urdf(&path, "arm.urdf", None, tip_link)?;
    let experiment = Experiment::new(TomlText::new("x.toml", text.clone()), folder.path())?;
    Ok((text, experiment))
}

fn link(name: &str, mass: f64) -> String {
    format!(
        "<link name='{name}'><inertial><mass value='{mass}'/><inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/>\
         </inertial></link>"
    )
}

fn joint(name: &str, kind: &str, [parent, child]: [&str; 2], limit: &str) -> String {
    format!(
        "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/><axis xyz='0 1 0'/>\
         <origin xyz='0 0 0.3'/><limit {limit}/></joint>"
    )
}

/// Two joints that turn and a gripper with a sliding finger of this mass.
fn arm(finger: f64) -> String {
    let links = [
        ("base", 1.0),
        ("upper", 5.0),
        ("fore", 3.0),
        ("hand", 1.0),
        ("finger", finger),
    ];
    let links: String = links.map(|(name, mass)| link(name, mass)).concat();
    let joints = [
        joint(
            "shoulder.pan",
            "continuous",
            ["base", "upper"],
            "effort='150' velocity='3'",
        ),
        joint(
            "elbow",
            "revolute",
            ["upper", "fore"],
            "lower='-3' upper='-0.07' effort='0' velocity='0'",
        ),
        joint(
            "flange",
            "fixed",
            ["fore", "hand"],
            "effort='0' velocity='0'",
        ),
        joint(
            "grip",
            "prismatic",
            ["hand", "finger"],
            "effort='20' velocity='1'",
        ),
    ];
    format!(
        "<robot name='two joints'>{links}{}</robot>",
        joints.concat()
    )
}

#[test]
fn the_arm_of_the_examples_is_sound_at_once() {
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/robots");
    let urdf = fs::read_to_string(robots.join("six_axis.urdf")).expect("readable");
    let (text, experiment) = started(&urdf, None).unwrap_or_else(|error| panic!("{error}"));
    let joints = [1, 2, 3, 4, 5, 6].map(|number| format!("joint_{number}"));
    assert_eq!(experiment.joint_names(), joints);
    assert!(
        text.contains("[robot.urdf.joint.joint_3] # 5.25 rad/s, 627 N m"),
        "{text}"
    );
    // stiffness and Coulomb friction of that axis as the literature has them: 208800 N m/rad, 42 N m
    assert!(
        text.contains("stiffness_nm_per_rad = 209000 # guessed"),
        "{text}"
    );
    assert!(
        text.contains("coulomb_nm = 31.35 # guessed")
            || text.contains("coulomb_nm = 31.4 # guessed"),
        "{text}"
    );
}

#[test]
fn a_chain_of_joints_that_turn_is_found_and_what_is_not_stated_is_said() {
    let (text, experiment) = started(&arm(0.0), None).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(experiment.joint_names(), ["shoulder.pan", "elbow"]);
    assert_eq!(
        experiment.pose_rad(),
        [0.0, -1.535],
        "the elbow cannot be straight"
    );
    for needed in [
        "tip_link = \"hand\"",
        "[robot.urdf.joint.\"shoulder.pan\"] # 3 rad/s, 150 N m",
        "[robot.urdf.joint.elbow] # -3 to -0.07 rad, no torque, 100 N m are taken",
    ] {
        assert!(text.contains(needed), "{needed}: {text}");
    }
    let (text, _) = started(&arm(0.0), Some("hand")).unwrap_or_else(|error| panic!("{error}"));
    assert!(text.contains("tip_link = \"hand\""), "{text}");
}

#[test]
fn what_cannot_be_guessed_is_named() {
    for (urdf, tip_link, needed) in [
        (arm(0.2), None, "link finger of 0.2 kg beside the chain"),
        (arm(0.0), Some("fore"), "link hand of 1 kg beside the chain"),
        (arm(0.2), Some("finger"), "joint grip is prismatic"),
        (arm(0.2), Some("toe"), "there is no link toe"),
        (
            "<robot name='a'><link name='a'/><link name='b'/></robot>".to_owned(),
            None,
            "base_link is needed",
        ),
        (
            "<robot name='a'><link name='a'/></robot>".to_owned(),
            None,
            "found no chain of joints that turn",
        ),
        ("<html/>".to_owned(), None, "arm.urdf: not URDF"),
    ] {
        let error = started(&urdf, tip_link).expect_err(needed).to_string();
        assert!(error.contains(needed), "{error}");
    }
}
