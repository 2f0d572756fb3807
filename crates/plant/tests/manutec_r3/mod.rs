//! The base axes of the Manutec r3 with locked wrist, from the tables of METHOD section 4 (Otter,
//! Tuerk, DLR 1988; values as in the Modelica Standard Library's RobotR3). y is up.

#![allow(dead_code)] // not every test file needs every part
use frfid_plant::{
    Arm, Body, BodyJoint, Challenges, FlexibleJoint, Friction, Inertia, Payload, Ripple, Spring,
};

pub(crate) const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];

/// Motor side values times ratio^2 (inertia, stiffness, damping, viscous friction) or |ratio|
/// (Coulomb friction).
fn joint(ratio: f64, stiffness: f64, damping: f64, coulomb_nm: f64, viscous: f64) -> BodyJoint {
    let square = ratio * ratio;
    BodyJoint::Flexible(FlexibleJoint {
        motor_inertia_kg_m2: 0.0013 * square,
        damping_nms_per_rad: damping * square,
        spring: Spring {
            stiffness_nm_per_rad: stiffness * square,
            stiffness_beyond_nm_per_rad: stiffness * square,
            knee_rad: 1e-2,
        },
        friction: Friction {
            coulomb_nm,
            viscous_nms_per_rad: viscous * square,
        },
        ripple: Vec::new(),
    })
}

/// The tensor of a ball with this moment of inertia in kg m^2.
pub(crate) fn ball(moment: f64) -> Inertia {
    Inertia {
        ixx: moment,
        iyy: moment,
        izz: moment,
        ..Inertia::default()
    }
}

fn locked(degrees: f64) -> BodyJoint {
    BodyJoint::Locked {
        position_rad: degrees.to_radians(),
    }
}

/// Mass, centre of mass, I11, I22, I33, I21.
type Mass = (f64, [f64; 3], [f64; 4]);

fn body(name: &str, axis: [f64; 3], offset_m: [f64; 3], mass: Mass, joint: BodyJoint) -> Body {
    let (mass_kg, center_of_mass_m, [xx, yy, zz, xy]) = mass;
    Body {
        name: name.into(),
        offset_m,
        rotation: IDENTITY,
        axis,
        mass_kg,
        center_of_mass_m,
        inertia_kg_m2: Inertia {
            ixx: xx,
            iyy: yy,
            izz: zz,
            ixy: xy,
            ..Inertia::default()
        },
        simplified: name == "b1",
        joint,
    }
}

/// The robot at the pose of record, without ripple and stiffening.
pub(crate) fn manutec_r3() -> Arm {
    let point = [0.0; 4];
    Arm {
        bodies: vec![
            body(
                "b1",
                Y,
                [0.0, 0.351, 0.0],
                (1.0, [0.0; 3], [0.0, 1.16, 0.0, 0.0]),
                joint(-105.0, 43.0, 0.005, 42.0, 0.13 / 160.0),
            ),
            body(
                "b2",
                X,
                [0.0, 0.324, 0.3],
                (56.5, [0.172, 0.205, 0.0], [2.58, 0.64, 2.73, -0.46]),
                joint(210.0, 8.0, 0.01, 105.0, 0.1 / 130.0),
            ),
            body(
                "b3",
                X,
                [0.0, 0.65, 0.0],
                (26.4, [0.064, -0.034, 0.0], [0.279, 0.245, 0.413, -0.070]),
                joint(60.0, 58.0, 0.04, 42.0, 0.2 / 130.0),
            ),
            body(
                "b4",
                Y,
                [0.0, 0.414, -0.155],
                (28.7, [0.0; 3], [1.67, 0.081, 1.67, 0.0]),
                locked(0.0),
            ),
            body(
                "b5",
                X,
                [0.0, 0.186, 0.0],
                (5.2, [0.0; 3], [1.25, 0.81, 1.53, 0.0]),
                locked(-110.0),
            ),
            body(
                "b6",
                Y,
                [0.0, 0.125, 0.0],
                (0.5, [0.05; 3], point),
                locked(0.0),
            ),
        ],
        payload: Some(Payload {
            mass_kg: 15.0,
            center_of_mass_m: [0.1, 0.25, 0.1],
            inertia_kg_m2: Inertia::default(),
        }),
        gravity_m_s2: [0.0, -9.81, 0.0],
        pose_rad: [-60.0, 20.0, 90.0].map(f64::to_radians).to_vec(),
        challenges: Challenges::default(),
    }
}

/// Changes the flexible joints of an arm.
pub(crate) fn each_joint(arm: &mut Arm, mut change: impl FnMut(usize, &mut FlexibleJoint)) {
    let joints = arm
        .bodies
        .iter_mut()
        .filter_map(|body| match &mut body.joint {
            BodyJoint::Flexible(joint) => Some(joint),
            BodyJoint::Locked { .. } => None,
        });
    joints
        .enumerate()
        .for_each(|(axis, joint)| change(axis, joint));
}

/// The default ripple of the experiments: 3, 5, 2 N m at 12 cycles per motor turn and a third of it
/// at 6.
pub(crate) fn with_ripple(mut arm: Arm) -> Arm {
    let amplitudes = [(105.0, 3.0), (210.0, 5.0), (60.0, 2.0)];
    each_joint(&mut arm, |axis, joint| {
        let (ratio, amplitude_nm) = amplitudes[axis];
        let ripple = |cycles: f64, share: f64| Ripple {
            cycles_per_turn: cycles * ratio,
            amplitude_nm: share * amplitude_nm,
            phase_rad: 0.0,
        };
        joint.ripple = vec![ripple(12.0, 1.0), ripple(6.0, 1.0 / 3.0)];
    });
    arm
}
