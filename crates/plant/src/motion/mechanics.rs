//! Mechanics of a machine behind a runtime number of axes, and what follows from its equations of motion at a
//! position.

use std::array::from_fn;
use std::fmt::Debug;

use frfid_signals::SignalError;
use frfid_signals::checks::{finite, one_per_axis};
use nalgebra::{DMatrix, DVector};

use crate::joint::flexible_joint::FlexibleJoint;
use crate::motion::Motion;
use crate::motion::equations::Machine;
use crate::motion::integrator::Integrator;
use crate::motion::links::Links;
use crate::state_space::StateSpace;

/// Joints on links, whatever they are and on however many axes. Slices hold one value for each
/// axis; others panic.
pub(crate) trait Mechanics: Debug + Send + Sync {
    /// Motor and gear of every axis.
    fn joints(&self) -> &[FlexibleJoint];

    /// Mass matrix of the links in kg m^2.
    fn mass_matrix(&self, position_rad: &[f64]) -> DMatrix<f64>;

    /// Torques in N m that keep the links at constant velocities.
    fn bias_nm(&self, position_rad: &[f64], velocity_rad_s: &[f64]) -> Vec<f64>;

    /// Derivative of the torques against gravity with respect to the positions in N m/rad.
    fn gravity_gradient(&self, position_rad: &[f64]) -> DMatrix<f64>;

    /// Accelerations of the links in rad/s^2 under torques in N m.
    fn acceleration(
        &self,
        position_rad: &[f64],
        velocity_rad_s: &[f64],
        torque_nm: &[f64],
    ) -> Vec<f64>;

    /// Potential energy of the links in J, but for a constant.
    fn potential_j(&self, position_rad: &[f64]) -> f64;

    /// Sets the machine in motion as [`Integrator::start`] does.
    fn start(self: Box<Self>, position_rad: &[f64], velocity_rad_s: &[f64]) -> Box<dyn Motion>;
}

fn dense<const A: usize>(rows: [[f64; A]; A]) -> DMatrix<f64> {
    DMatrix::from_fn(A, A, |i, j| rows[i][j])
}

fn array<const A: usize>(values: &[f64]) -> [f64; A] {
    from_fn(|axis| values[axis])
}

impl<K: Links<A>, const A: usize> Mechanics for Machine<K, A> {
    fn joints(&self) -> &[FlexibleJoint] {
        &self.joints
    }

    fn mass_matrix(&self, position_rad: &[f64]) -> DMatrix<f64> {
        dense(self.links.mass(array(position_rad)))
    }

    fn bias_nm(&self, position_rad: &[f64], velocity_rad_s: &[f64]) -> Vec<f64> {
        self.links
            .holding(array(position_rad), array(velocity_rad_s))
            .to_vec()
    }

    fn gravity_gradient(&self, position_rad: &[f64]) -> DMatrix<f64> {
        dense(self.links.gravity_gradient(array(position_rad)))
    }

    fn acceleration(
        &self,
        position_rad: &[f64],
        velocity_rad_s: &[f64],
        torque_nm: &[f64],
    ) -> Vec<f64> {
        self.links
            .acceleration(
                &array(position_rad),
                &array(velocity_rad_s),
                &array(torque_nm),
            )
            .to_vec()
    }

    fn potential_j(&self, position_rad: &[f64]) -> f64 {
        self.links.potential_j(array(position_rad))
    }

    fn start(self: Box<Self>, position_rad: &[f64], velocity_rad_s: &[f64]) -> Box<dyn Motion> {
        Box::new(Integrator::start(
            *self,
            array(position_rad),
            array(velocity_rad_s),
        ))
    }
}

/// Dynamics of a machine's links, made ready once for any number of states.
#[derive(Debug)]
pub struct LinkDynamics(pub(crate) Box<dyn Mechanics>);

impl LinkDynamics {
    /// Mass matrix M in kg m^2 of the links at positions in rad.
    ///
    /// # Errors
    /// [`SignalError`] for another number of positions, or one that is not finite.
    pub fn mass_matrix(&self, position_rad: &[f64]) -> Result<DMatrix<f64>, SignalError> {
        self.check("link_position_rad", position_rad)?;
        Ok(self.0.mass_matrix(position_rad))
    }

    /// Torques C qo' + g in N m that keep the links at constant velocities in rad/s: Coriolis,
    /// centrifugal, gravity.
    ///
    /// # Errors
    /// As [`LinkDynamics::mass_matrix`].
    pub fn bias_nm(
        &self,
        position_rad: &[f64],
        velocity_rad_s: &[f64],
    ) -> Result<Vec<f64>, SignalError> {
        self.check("link_position_rad", position_rad)?;
        self.check("link_velocity_rad_s", velocity_rad_s)?;
        Ok(self.0.bias_nm(position_rad, velocity_rad_s))
    }

    /// Torques g in N m that hold the links against gravity.
    ///
    /// # Errors
    /// As [`LinkDynamics::mass_matrix`].
    pub fn gravity_torque_nm(&self, position_rad: &[f64]) -> Result<Vec<f64>, SignalError> {
        self.bias_nm(position_rad, &vec![0.0; position_rad.len()])
    }

    /// Accelerations in rad/s^2 of the links when the gears transmit torques in N m: M^-1 (torque -
    /// C qo' - g).
    ///
    /// # Errors
    /// As [`LinkDynamics::mass_matrix`].
    pub fn acceleration(
        &self,
        position_rad: &[f64],
        velocity_rad_s: &[f64],
        torque_nm: &[f64],
    ) -> Result<Vec<f64>, SignalError> {
        self.check("link_position_rad", position_rad)?;
        self.check("link_velocity_rad_s", velocity_rad_s)?;
        self.check("torque_nm", torque_nm)?;
        let found = self.0.acceleration(position_rad, velocity_rad_s, torque_nm);
        Ok(found)
    }

    fn check(&self, name: &'static str, values: &[f64]) -> Result<(), SignalError> {
        one_per_axis(name, Some(values), self.0.joints().len(), finite)
    }
}

impl dyn Mechanics {
    /// The linear model about rest at a position: states (qm, dq, qm', qo'), outputs (qm', qm).
    /// With F the viscous friction and G the gradient of gravity, J_m qm'' = u - F qm' - K dq - D
    /// (qm' - qo'), M qo'' = K dq + D (qm' - qo') - G (qm - dq). K has the slopes on which the
    /// gears rest under gravity.
    pub(crate) fn state_space(&self, position_rad: &[f64]) -> StateSpace {
        let n = self.joints().len();
        let one = DMatrix::identity(n, n);
        let mut b = DMatrix::zeros(4 * n, n);
        b.rows_mut(2 * n, n).copy_from(&self.motor_mobility());
        let mut c = DMatrix::zeros(2 * n, 4 * n);
        c.view_mut((0, 2 * n), (n, n)).copy_from(&one);
        c.view_mut((n, 0), (n, n)).copy_from(&one);
        StateSpace {
            a: self.state_matrix(position_rad),
            b,
            c,
            d: DMatrix::zeros(2 * n, n),
        }
    }

    /// A of the linear model, from blocks of one row and column for each axis.
    fn state_matrix(&self, position_rad: &[f64]) -> DMatrix<f64> {
        let n = self.joints().len();
        let stiffness = self.stiffness_at_rest(position_rad);
        let damping = self.diagonal(|joint| joint.damping_nms_per_rad);
        let viscous = self.diagonal(|joint| joint.friction.viscous_nms_per_rad);
        let motors = self.motor_mobility();
        let gradient = self.gravity_gradient(position_rad);
        let mass = self.mass_matrix(position_rad).lu();
        let links = |force: DMatrix<f64>| {
            mass.solve(&force)
                .unwrap_or_else(|| DMatrix::from_element(n, n, f64::NAN))
        };
        let one = DMatrix::identity(n, n);
        let blocks = [
            (0, 2, one.clone()),
            (1, 2, one.clone()),
            (1, 3, -&one),
            (2, 1, -&motors * &stiffness),
            (2, 2, -&motors * (&damping + viscous)),
            (2, 3, &motors * &damping),
            (3, 0, links(-&gradient)),
            (3, 1, links(stiffness + gradient)),
            (3, 2, links(damping.clone())),
            (3, 3, links(-damping)),
        ];
        let mut a = DMatrix::zeros(4 * n, 4 * n);
        for (row, column, block) in blocks {
            a.view_mut((row * n, column * n), (n, n)).copy_from(&block);
        }
        a
    }

    /// K: the slopes on which the gears rest under gravity.
    fn stiffness_at_rest(&self, position_rad: &[f64]) -> DMatrix<f64> {
        let n = self.joints().len();
        let gravity_nm = self.bias_nm(position_rad, &vec![0.0; n]);
        let slope = |(joint, torque): (&FlexibleJoint, &f64)| joint.spring.slope_under(*torque);
        DMatrix::from_diagonal(&DVector::from_iterator(
            n,
            self.joints().iter().zip(&gravity_nm).map(slope),
        ))
    }

    /// 1/J_m.
    fn motor_mobility(&self) -> DMatrix<f64> {
        self.diagonal(FlexibleJoint::motor_mobility)
    }

    /// A diagonal matrix of one number of each joint.
    fn diagonal(&self, number: impl Fn(&FlexibleJoint) -> f64) -> DMatrix<f64> {
        DMatrix::from_diagonal(&DVector::from_iterator(
            self.joints().len(),
            self.joints().iter().map(number),
        ))
    }

    /// Eigenvalues, rising, of C (M^-1 + J^-1) with C a diagonal matrix of one number of each
    /// joint, J^-1 the mobility of the motors (0 for locked ones).
    pub(crate) fn eigenvalues(
        &self,
        position_rad: &[f64],
        number: impl Fn(&FlexibleJoint) -> f64,
        motor_mobility: impl Fn(&FlexibleJoint) -> f64,
    ) -> Vec<f64> {
        let root = self.diagonal(|joint| number(joint).sqrt());
        let Some(links) = self.mass_matrix(position_rad).try_inverse() else {
            return vec![f64::NAN; root.nrows()];
        };
        let mut values =
            (&root * (links + self.diagonal(motor_mobility)) * &root).symmetric_eigenvalues();
        values.as_mut_slice().sort_by(f64::total_cmp);
        values.as_slice().to_vec()
    }
}
