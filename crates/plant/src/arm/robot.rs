//! Arm as a robot: its equations of motion at any position, its motion, its linear truth.

use std::array::from_fn;
use std::f64::consts::TAU;

use frfid_signals::SignalError;
use nalgebra::{DMatrix, DVector};

use crate::arm::Arm;
use crate::arm::chain::Chain;
use crate::arm::challenges::is_posed;
use crate::arm::links_at_pose::LinksAtPose;
use crate::error::PlantError;
use crate::joint::flexible_joint::FlexibleJoint;
use crate::motion::Motion;
use crate::motion::equations::Machine;
use crate::motion::mechanics::{LinkDynamics, Mechanics};
use crate::robot::Robot;
use crate::state_space::StateSpace;

impl Arm {
    /// The dynamics of the links, made ready once for any number of states.
    ///
    /// # Errors
    /// [`SignalError`] for a parameter out of range.
    pub fn link_dynamics(&self) -> Result<LinkDynamics, SignalError> {
        Ok(LinkDynamics(self.mechanics()?))
    }

    /// [`LinkDynamics::mass_matrix`] of one state.
    ///
    /// # Errors
    /// [`SignalError`] for a parameter or position out of range or another number of positions.
    pub fn mass_matrix(&self, link_position_rad: &[f64]) -> Result<DMatrix<f64>, SignalError> {
        self.link_dynamics()?.mass_matrix(link_position_rad)
    }

    /// [`LinkDynamics::gravity_torque_nm`] of one state.
    ///
    /// # Errors
    /// As [`Arm::mass_matrix`].
    pub fn gravity_torque_nm(&self, link_position_rad: &[f64]) -> Result<Vec<f64>, SignalError> {
        self.link_dynamics()?.gravity_torque_nm(link_position_rad)
    }

    /// [`LinkDynamics::bias_nm`] of one state.
    ///
    /// # Errors
    /// As [`Arm::mass_matrix`].
    pub fn bias_nm(
        &self,
        link_position_rad: &[f64],
        link_velocity_rad_s: &[f64],
    ) -> Result<Vec<f64>, SignalError> {
        let dynamics = self.link_dynamics()?;
        dynamics.bias_nm(link_position_rad, link_velocity_rad_s)
    }

    /// [`LinkDynamics::acceleration`] of one state.
    ///
    /// # Errors
    /// As [`Arm::mass_matrix`].
    pub fn link_acceleration(
        &self,
        link_position_rad: &[f64],
        link_velocity_rad_s: &[f64],
        torque_nm: &[f64],
    ) -> Result<Vec<f64>, SignalError> {
        let dynamics = self.link_dynamics()?;
        dynamics.acceleration(link_position_rad, link_velocity_rad_s, torque_nm)
    }

    /// Energy in J of links, motors and gears in motion and in the field of gravity, but for a
    /// constant: what damping and friction take and motors give.
    ///
    /// # Errors
    /// [`SignalError`] for a parameter out of range or a motion on another number of axes.
    pub fn energy_j(&self, motion: &dyn Motion) -> Result<f64, SignalError> {
        let (motor, link) = (motion.motor_velocity_rad_s(), motion.link_velocity_rad_s());
        self.check_axes("motor_velocity_rad_s", motor)?;
        let mechanics = self.mechanics()?;
        let gears = motion.deflection_rad();
        let position: Vec<f64> = motion
            .motor_position_rad()
            .iter()
            .zip(gears)
            .map(|(qm, dq)| qm - dq)
            .collect();
        let motions = motor.iter().zip(gears);
        let in_joints: f64 = mechanics
            .joints()
            .iter()
            .zip(motions)
            .map(|(joint, (velocity, deflection))| joint.energy_j(*velocity, *deflection))
            .sum();
        let velocity = DVector::from_row_slice(link);
        let links = 0.5 * velocity.dot(&(mechanics.mass_matrix(&position) * &velocity));
        Ok(in_joints + links + mechanics.potential_j(&position))
    }

    /// Frequencies in Hz, rising, of the undamped elastic modes at the pose without gravity, the
    /// gears within their knees.
    ///
    /// # Errors
    /// [`SignalError`] for a parameter out of range.
    pub fn modes_hz(&self) -> Result<Vec<f64>, SignalError> {
        self.elastic_hz(FlexibleJoint::motor_mobility)
    }

    /// The same with the motors locked: the zeros of the FRFs from torque to velocity taken
    /// together.
    ///
    /// # Errors
    /// [`SignalError`] for a parameter out of range.
    pub fn locked_motor_hz(&self) -> Result<Vec<f64>, SignalError> {
        self.elastic_hz(|_| 0.0)
    }

    /// Frequencies in Hz, rising, of the elastic modes with motors of these mobilities in 1/(kg m^2).
    fn elastic_hz(
        &self,
        motor_mobility: impl Fn(&FlexibleJoint) -> f64,
    ) -> Result<Vec<f64>, SignalError> {
        self.check()?;
        let stiffness = |joint: &FlexibleJoint| joint.spring.stiffness_nm_per_rad;
        let squares = self
            .mechanics()?
            .eigenvalues(&self.pose_rad, stiffness, motor_mobility);
        Ok(squares
            .into_iter()
            .map(|square| square.sqrt() / TAU)
            .collect())
    }

    /// The arm's equations of motion for its number of axes.
    pub(crate) fn mechanics(&self) -> Result<Box<dyn Mechanics>, SignalError> {
        self.check_parameters()?;
        match self.n_axes() {
            1 => self.compiled::<1>(),
            2 => self.compiled::<2>(),
            3 => self.compiled::<3>(),
            4 => self.compiled::<4>(),
            5 => self.compiled::<5>(),
            6 => self.compiled::<6>(),
            7 => self.compiled::<7>(),
            _ => None,
        }
        .ok_or_else(|| self.wrong_number_of_axes())
    }

    /// The equations of motion on `A` axes; `None` if it has another number.
    fn compiled<const A: usize>(&self) -> Option<Box<dyn Mechanics>> {
        let joints: Vec<FlexibleJoint> = self
            .joints()
            .map(|joint| joint.with(self.challenges))
            .collect();
        let joints: [FlexibleJoint; A] = joints.try_into().ok()?;
        let links = Chain::<A>::new(self)?;
        Some(if is_posed(self.challenges.position_dependence) {
            Box::new(Machine { joints, links })
        } else {
            let pose = from_fn(|axis| self.pose_rad[axis]);
            let links = LinksAtPose::new(&links, pose);
            Box::new(Machine { joints, links })
        })
    }
}

impl Robot for Arm {
    fn n_axes(&self) -> usize {
        self.n_axes()
    }

    fn check(&self) -> Result<(), SignalError> {
        self.check()
    }

    /// At the pose, gears beyond their knees.
    fn fastest_rad_s(&self) -> f64 {
        let Ok(mechanics) = self.mechanics() else {
            return f64::NAN;
        };
        let fastest = |number: &dyn Fn(&FlexibleJoint) -> f64| {
            mechanics
                .eigenvalues(&self.pose_rad, number, FlexibleJoint::motor_mobility)
                .into_iter()
                .fold(0.0, f64::max)
        };
        let stiffness = |joint: &FlexibleJoint| joint.spring.stiffest_nm_per_rad();
        let decay =
            |joint: &FlexibleJoint| joint.damping_nms_per_rad + joint.friction.viscous_nms_per_rad;
        fastest(&stiffness).sqrt().max(fastest(&decay))
    }

    /// 0.0445 over the fastest rate at the pose (gears beyond their knees), 0.167 ms for the
    /// Manutec r3, whose linear FRF it keeps within 1e-6 of the truth: RK4 shifts a resonance by
    /// (rate step)^4 / 120 of its frequency, which its damping magnifies. (0.25 ms leave 4e-6, 0.1
    /// ms 1e-7, 0.05 ms 6e-9.) NaN for an unsound arm.
    fn default_step_s(&self) -> f64 {
        0.0445 / self.fastest_rad_s()
    }

    /// The links start at the pose plus `start_rad`.
    fn start(
        &self,
        start_rad: &[f64],
        velocity_rad_s: &[f64],
    ) -> Result<Box<dyn Motion>, PlantError> {
        self.check()?;
        self.check_axes("start_rad", start_rad)?;
        self.check_axes("velocity_rad_s", velocity_rad_s)?;
        let position: Vec<f64> = self
            .pose_rad
            .iter()
            .zip(start_rad)
            .map(|(pose, start)| pose + start)
            .collect();
        Ok(self.mechanics()?.start(&position, velocity_rad_s))
    }

    /// A gear that carries gravity beyond its knee has the stiffness of the branch on which it
    /// rests. Filled with NaN for an unsound arm.
    fn state_space(&self) -> StateSpace {
        let n = self.n_axes();
        let nan = |rows, columns| DMatrix::from_element(rows, columns, f64::NAN);
        self.mechanics().map_or_else(
            |_| StateSpace {
                a: nan(4 * n, 4 * n),
                b: nan(4 * n, n),
                c: nan(2 * n, 4 * n),
                d: nan(2 * n, n),
            },
            |mechanics| mechanics.state_space(&self.pose_rad),
        )
    }

    fn coulomb_nm(&self) -> Vec<f64> {
        let joints = self.joints().map(|joint| joint.with(self.challenges));
        joints.map(|joint| joint.friction.coulomb_nm).collect()
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings()
    }
}
