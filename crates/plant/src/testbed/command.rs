//! Command of the motor torques during a run: from references and readings, axis by axis.

use crate::control::controller::{Controller, ControllerAxis, ControllerOutput};
use crate::motion::Motion;
use crate::state_space::Hold;
use crate::testbed::simulated_robot::Actuation;

/// What commands the torques of all axes.
pub(crate) enum Command {
    /// The reference is a torque, on top of what holds the robot.
    Torque { holding_nm: Vec<f64>, hold: Hold },
    /// The reference is a velocity.
    Velocity(Vec<VelocityLoop>),
}

/// The loop around one axis.
pub(crate) struct VelocityLoop {
    controller: Box<dyn ControllerAxis>,
    position_gain_per_s: f64,
    /// q_ref in rad.
    position_rad: f64,
    sample_time_s: f64,
}

impl Command {
    /// Commands that hold a robot as it moves.
    pub(crate) fn holding(actuation: &Actuation, motion: &dyn Motion) -> Self {
        let holding_nm = motion.holding_nm();
        match actuation {
            Actuation::Torque { hold } => Self::Torque {
                holding_nm,
                hold: *hold,
            },
            Actuation::Velocity {
                controller,
                sample_time_s,
            } => {
                let on_axis = |(axis, (&torque_nm, &position_rad))| {
                    let held = [torque_nm, position_rad];
                    VelocityLoop::holding(&**controller, axis, *sample_time_s, held)
                };
                let held = holding_nm.iter().zip(motion.motor_position_rad());
                Self::Velocity(held.enumerate().map(on_axis).collect())
            }
        }
    }

    /// The motor torque that acts on an axis from this sample on, given the reference and the
    /// readings of position in rad and velocity in rad/s.
    pub(crate) fn torque(
        &mut self,
        axis: usize,
        reference: f64,
        reading: (f64, f64),
    ) -> ControllerOutput {
        match self {
            Self::Torque { holding_nm, .. } => {
                let torque_nm = holding_nm[axis] + reference;
                ControllerOutput {
                    torque_nm,
                    reached: None,
                }
            }
            Self::Velocity(loops) => loops[axis].torque(reference, reading),
        }
    }

    /// The reference of an axis that goes on as before the run, at a constant velocity in rad/s.
    pub(crate) fn rest(&self, velocity_rad_s: f64) -> f64 {
        match self {
            Self::Torque { .. } => 0.0,
            Self::Velocity(_) => velocity_rad_s,
        }
    }

    /// Motor torque in N m at the next sample, towards which it runs in a straight line; `None` if
    /// it is held until then.
    pub(crate) fn ahead(&self, axis: usize, next_reference: f64) -> Option<f64> {
        match self {
            Self::Torque {
                holding_nm,
                hold: Hold::Linear,
            } => Some(holding_nm[axis] + next_reference),
            Self::Torque { .. } | Self::Velocity(_) => None,
        }
    }
}

impl VelocityLoop {
    /// The loop of an axis that holds a torque in N m at a position in rad.
    fn holding(
        controller: &dyn Controller,
        axis: usize,
        sample_time_s: f64,
        [torque_nm, position_rad]: [f64; 2],
    ) -> Self {
        Self {
            controller: controller.axis(axis, sample_time_s, torque_nm),
            position_gain_per_s: controller.position_gain_per_s(axis),
            position_rad,
            sample_time_s,
        }
    }

    /// The torque that acts next, given the reference and the readings of position in rad and
    /// velocity in rad/s.
    fn torque(
        &mut self,
        reference_rad_s: f64,
        (position, velocity): (f64, f64),
    ) -> ControllerOutput {
        let behind_rad = self.position_rad - position;
        let error_rad_s = reference_rad_s + self.position_gain_per_s * behind_rad - velocity;
        self.position_rad += reference_rad_s * self.sample_time_s;
        self.controller.step(error_rad_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::pi::PiController;

    #[test]
    fn the_position_loop_asks_for_the_way_that_the_reference_has_gone() {
        let controller = PiController {
            gain_nms_per_rad: vec![2.0],
            integral_gain_nm_per_rad: vec![0.0],
            delay_samples: 0,
            max_torque_nm: Some(vec![10.0]),
            max_torque_rate_nm_per_s: None,
            position_gain_per_s: Some(vec![100.0]),
        };
        let mut axis = VelocityLoop::holding(&controller, 0, 1e-3, [0.0, 7.0]);
        // at rest at 7 rad: after two samples of 2 rad/s the motor should be 4 mrad ahead, worth
        // 0.4 rad/s
        let torques = [2.0, 2.0, 0.0].map(|reference| axis.torque(reference, (7.0, 0.0)).torque_nm);
        assert!(
            torques
                .iter()
                .zip([4.0, 4.4, 0.8])
                .all(|(found, asked)| (found - asked).abs() < 1e-12),
            "{torques:?}"
        );
    }
}
