//! Chain of moving links: an arm compiled to the numbers its motion depends on.
//!
//! Locked bodies and the payload become part of the moving body before them. Every link gets a
//! frame whose z axis is its joint's axis and whose x axis is normal to the next one, so that two
//! plane rotations lead from link to link: by a constant twist about x, by the joint's position
//! about z. Mass on a joint's axis moves as if it sat on the body before it, and is put there; of
//! each link seven numbers remain (the base parameters of Gautier and Khalil, IEEE Trans. Robot.
//! Autom. 6 (1990) 368).

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use crate::arm::challenges::is_posed;
use crate::arm::rigid::{Rigid, matrix};
use crate::arm::{Arm, BodyJoint};

/// A link in its own frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Link<L = f64> {
    /// What is added to the joint's position in rad to give the angle between the x axes.
    pub zero_rad: L,
    /// Cosine and sine of the angle about the parent's x axis from its z axis to this one.
    pub twist: [L; 2],
    /// Origin in m in the parent's frame.
    pub offset: [L; 3],
    /// First moments (x, y) in kg m.
    pub first: [L; 2],
    /// Second moments (xx, yy, xy, xz, yz) in kg m^2.
    pub second: [L; 5],
}

/// A chain of `A` moving links, in the numbers of one arm or of several side by side.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chain<const A: usize, L = f64> {
    /// The links from the base to the tip.
    pub(crate) links: [Link<L>; A],
    /// Acceleration in m/s^2 of the base, in its frame, that feels like gravity: upwards.
    pub(crate) lift: [L; 3],
    /// Whether there are gravity, Coriolis and centrifugal torques (challenge G).
    pub(crate) biased: bool,
}

/// A moving joint and the rigid whole that it moves, before its frame is chosen.
struct Carried {
    /// Orientation in the parent's frame at position 0, the joint's axis along z.
    rotation: Matrix3<f64>,
    offset: Vector3<f64>,
    rigid: Rigid,
    zero_rad: f64,
}

impl<const A: usize> Chain<A> {
    /// Compiles an arm; `None` if it has not `A` moving joints.
    pub(crate) fn new(arm: &Arm) -> Option<Self> {
        let mut carried = merged(arm);
        let lift = align_x_axes(&mut carried, -Vector3::from(arm.gravity_m_s2));
        Some(Self {
            links: base_parameters(carried).try_into().ok()?,
            lift: lift.into(),
            biased: is_posed(arm.challenges.gravity),
        })
    }
}

/// Turns every frame about its z axis until its x axis is normal to the next z axis; returns the
/// lift in the turned frame of the base.
fn align_x_axes(carried: &mut [Carried], mut lift: Vector3<f64>) -> Vector3<f64> {
    for i in 0..carried.len() {
        let (before, twist, after) = z_x_z(&carried[i].rotation);
        carried[i].zero_rad += after;
        let back = *Rotation3::from_axis_angle(&Vector3::z_axis(), -before).matrix();
        carried[i].offset = back * carried[i].offset;
        carried[i].rotation = *Rotation3::from_axis_angle(&Vector3::x_axis(), twist).matrix();
        if i == 0 {
            lift = back * lift;
        } else {
            let parent = &mut carried[i - 1];
            parent.zero_rad += before;
            parent.rigid = parent.rigid.seen(&back, &Vector3::zeros());
        }
    }
    lift
}

/// The links, mass on a joint's axis put on the body before it.
fn base_parameters(mut carried: Vec<Carried>) -> Vec<Link> {
    let mut links = Vec::with_capacity(carried.len());
    while let Some(mut link) = carried.pop() {
        let on_axis = link.rigid.on_axis();
        link.rigid -= on_axis;
        if let Some(parent) = carried.last_mut() {
            parent.rigid += on_axis.seen(&link.rotation, &link.offset);
        }
        links.push(link.compiled());
    }
    links.reverse();
    links
}

impl Carried {
    fn compiled(&self) -> Link {
        let (first, second) = (&self.rigid.first, &self.rigid.second);
        Link {
            zero_rad: self.zero_rad,
            twist: [self.rotation[(1, 1)], self.rotation[(2, 1)]],
            offset: self.offset.into(),
            first: [first.x, first.y],
            second: [
                second[(0, 0)],
                second[(1, 1)],
                second[(0, 1)],
                second[(0, 2)],
                second[(1, 2)],
            ],
        }
    }
}

/// The moving joints with everything that is rigidly connected to each; what hangs rigidly on the
/// base is left out.
fn merged(arm: &Arm) -> Vec<Carried> {
    let mut carried: Vec<Carried> = Vec::new();
    // where the present body is in the frame of the last moving link
    let (mut rotation, mut origin) = (Matrix3::identity(), Vector3::zeros());
    for body in &arm.bodies {
        origin += rotation * Vector3::from(body.offset_m);
        rotation *= matrix(&body.rotation);
        let axis = Unit::new_normalize(Vector3::from(body.axis));
        match body.joint {
            BodyJoint::Locked { position_rad } => {
                rotation *= Rotation3::from_axis_angle(&axis, position_rad);
            }
            BodyJoint::Flexible(_) => {
                let upright = upright(&axis);
                carried.push(Carried {
                    rotation: rotation * upright,
                    offset: origin,
                    rigid: Rigid::zero(),
                    zero_rad: 0.0,
                });
                (rotation, origin) = (upright.transpose(), Vector3::zeros());
            }
        }
        if let Some(link) = carried.last_mut() {
            let own = Rigid::new(body.mass_kg, &body.center_of_mass_m, body.inertia_kg_m2);
            link.rigid += own.seen(&rotation, &origin);
        }
    }
    if let (Some(link), Some(load)) = (carried.last_mut(), &arm.payload) {
        let own = Rigid::new(load.mass_kg, &load.center_of_mass_m, load.inertia_kg_m2);
        link.rigid += own.seen(&rotation, &origin);
    }
    carried
}

/// A rotation that takes the z axis to an axis: by half a turn about the line halfway between them.
fn upright(axis: &Unit<Vector3<f64>>) -> Matrix3<f64> {
    let halfway = Vector3::z() * if axis.z < 0.0 { -1.0 } else { 1.0 } + axis.into_inner();
    let turn = 2.0 * halfway * halfway.transpose() / halfway.norm_squared() - Matrix3::identity();
    if axis.z < 0.0 {
        turn * Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0))
    } else {
        turn
    }
}

/// Angles (a, b, c) of a rotation Rz(a) Rx(b) Rz(c), b from 0 to pi.
fn z_x_z(rotation: &Matrix3<f64>) -> (f64, f64, f64) {
    let [x, y, z] = [rotation[(0, 2)], rotation[(1, 2)], rotation[(2, 2)]];
    let a = x.atan2(0.0 - y); // 0 when there is no twist
    let row = rotation.row(0) * a.cos() + rotation.row(1) * a.sin();
    (a, x.hypot(y).atan2(z), (-row[1]).atan2(row[0]))
}
