//! Validation of an arm: what is refused, and what is warned of.

use frfid_signals::SignalError;
use frfid_signals::checks::{finite, not_negative, one_per_axis};
use nalgebra::{Matrix3, Vector3};

use crate::arm::inertia::Inertia;
use crate::arm::rigid::matrix;
use crate::arm::{Arm, Body, BodyJoint, Payload};

/// How far a rotation matrix given in decimals may be from a rotation, and a principal moment of
/// inertia below 0 beside the largest entry.
const ROUNDING: f64 = 1e-6;

impl Arm {
    /// Checks every parameter, and that the mass matrix is positive definite at the pose.
    ///
    /// # Errors
    /// [`SignalError::In`] naming the body, or [`SignalError::Parameter`], [`SignalError::Shape`]
    /// of the arm itself.
    pub fn check(&self) -> Result<(), SignalError> {
        let mut moments = self
            .mechanics()?
            .mass_matrix(&self.pose_rad)
            .symmetric_eigenvalues();
        moments.as_mut_slice().sort_by(f64::total_cmp);
        let (smallest, largest) = (moments[0], moments[moments.len() - 1]);
        if smallest > f64::EPSILON * largest {
            return Ok(());
        }
        Err(SignalError::derived(
            "body",
            "the smallest eigenvalue in kg m^2 of the mass matrix at the pose",
            smallest,
            "above 0: every joint must move some inertia that cannot be moved without it",
        ))
    }

    /// What is possible but looks like a mistake: principal moments of inertia of which one exceeds
    /// the sum of the other two, as no mass distribution can have them. Bodies marked as simplified
    /// may.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let bodies = self.bodies.iter().filter(|body| !body.simplified);
        let tensors = bodies.map(|body| (body.part(), body.inertia_kg_m2, " or set simplified"));
        let payload = self
            .payload
            .iter()
            .map(|payload| (PAYLOAD.into(), payload.inertia_kg_m2, ""));
        let warning = |(part, tensor, or): (String, Inertia, _)| {
            let [a, b, c] = tensor.principal_moments();
            (c > (a + b) * (1.0 + ROUNDING)).then(|| {
                format!(
                    "{part}: no body has the principal moments of inertia {a:.4}, {b:.4}, {c:.4} kg m^2: the largest \
                     exceeds the sum of the others; correct inertia_kg_m2{or}"
                )
            })
        };
        tensors.chain(payload).filter_map(warning).collect()
    }

    /// Checks what can be checked part by part.
    pub(crate) fn check_parameters(&self) -> Result<(), SignalError> {
        if self.n_axes() == 0 {
            return Err(self.wrong_number_of_axes());
        }
        self.gravity_m_s2
            .iter()
            .try_for_each(|&value| finite("gravity_m_s2", value))?;
        for (index, body) in self.bodies.iter().enumerate() {
            let path = || vec!["body".to_owned(), index.to_string()];
            let joint_path = || [path(), vec!["joint".to_owned()]].concat();
            body.check()
                .map_err(|error| error.within(body.part(), path()))?;
            body.check_joint()
                .map_err(|error| error.within(body.part(), joint_path()))?;
        }
        if let Some(payload) = &self.payload {
            payload
                .check()
                .map_err(|error| error.within(PAYLOAD, vec![PAYLOAD.to_owned()]))?;
        }
        self.check_axes("pose_rad", &self.pose_rad)
    }

    /// Checks that there is a finite number for each axis.
    pub(crate) fn check_axes(&self, name: &'static str, values: &[f64]) -> Result<(), SignalError> {
        one_per_axis(name, Some(values), self.n_axes(), finite)
    }

    pub(crate) fn wrong_number_of_axes(&self) -> SignalError {
        SignalError::derived(
            "body",
            "the number of moving joints",
            self.n_axes() as f64,
            "1 to 7; lock the others",
        )
    }
}

const PAYLOAD: &str = "payload";

impl Body {
    fn part(&self) -> String {
        format!("body {}", self.name)
    }

    fn check(&self) -> Result<(), SignalError> {
        check_vector("offset_m", &self.offset_m)?;
        self.check_rotation()?;
        self.check_axis()?;
        check_mass(self.mass_kg, &self.center_of_mass_m, self.inertia_kg_m2)
    }

    fn check_rotation(&self) -> Result<(), SignalError> {
        self.rotation
            .iter()
            .try_for_each(|row| check_vector("rotation", row))?;
        let rotation = matrix(&self.rotation);
        let error = (rotation * rotation.transpose() - Matrix3::identity()).amax();
        if error > ROUNDING {
            let quantity = "rotation times its transpose, less the identity,";
            let needed = "0, as of any rotation matrix";
            return Err(SignalError::derived("rotation", quantity, error, needed));
        }
        if rotation.determinant() < 0.0 {
            let (quantity, needed) = ("rotation's determinant", "1: no mirror");
            return Err(SignalError::derived("rotation", quantity, -1.0, needed));
        }
        Ok(())
    }

    fn check_axis(&self) -> Result<(), SignalError> {
        check_vector("axis", &self.axis)?;
        let length = Vector3::from(self.axis).norm();
        if length.is_normal() {
            return Ok(());
        }
        let quantity = "axis' length";
        Err(SignalError::derived("axis", quantity, length, "above 0"))
    }

    fn check_joint(&self) -> Result<(), SignalError> {
        match &self.joint {
            BodyJoint::Locked { position_rad } => finite("position_rad", *position_rad),
            BodyJoint::Flexible(joint) => joint.check(),
        }
    }
}

impl Payload {
    fn check(&self) -> Result<(), SignalError> {
        check_mass(self.mass_kg, &self.center_of_mass_m, self.inertia_kg_m2)
    }
}

fn check_vector(name: &'static str, vector: &[f64; 3]) -> Result<(), SignalError> {
    vector.iter().try_for_each(|&value| finite(name, value))
}

fn check_mass(mass: f64, center_of_mass: &[f64; 3], inertia: Inertia) -> Result<(), SignalError> {
    not_negative("mass_kg", mass)?;
    check_vector("center_of_mass_m", center_of_mass)?;
    let mut entries = inertia.entries().into_iter();
    entries.try_for_each(|entry| finite("inertia_kg_m2", entry))?;
    let smallest = inertia.principal_moments()[0];
    if smallest < -ROUNDING * inertia.matrix().amax() {
        return Err(SignalError::derived(
            "inertia_kg_m2",
            "inertia_kg_m2's smallest principal moment",
            smallest,
            "0 or above",
        ));
    }
    Ok(())
}
