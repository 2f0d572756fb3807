//! Integration: how a robot is moved on from sample to sample, by RK4 or by exact steps.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::PlantError;
use crate::motion::Motion;
use crate::motion::exact;
use crate::robot::Robot;

/// The integrator of a simulation. Both locate the instants at which a joint sticks, slips or passes
/// the knee of its spring to rounding level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Integration {
    /// Runge-Kutta steps of fourth order, for every robot.
    #[default]
    Rk4,
    /// Exact steps: within its modes of friction and spring a single joint without torque ripple is
    /// linear, and a matrix exponential takes it from sample to sample under a torque that is held
    /// or a straight line.
    Exact,
}

impl Integration {
    /// Checks that it can move a robot.
    ///
    /// # Errors
    /// [`PlantError::NotExact`] for exact steps of a robot that is not piecewise linear,
    /// [`PlantError::Signal`] for a parameter out of range.
    pub fn check(self, robot: &dyn Robot) -> Result<(), PlantError> {
        if self == Self::Rk4 {
            return Ok(robot.check()?);
        }
        let rest = vec![0.0; robot.n_axes()];
        let step_s = self.longest_step_s(robot, None);
        self.start(robot, step_s, [&rest, &rest]).map(drop)
    }

    /// The longest step in s, if it is not to be longer than `max_step_s`.
    pub(crate) fn longest_step_s(self, robot: &dyn Robot, max_step_s: Option<f64>) -> f64 {
        match self {
            Self::Rk4 => max_step_s.unwrap_or_else(|| robot.default_step_s()),
            Self::Exact => {
                let longest_s = exact::longest_step_s(robot.fastest_rad_s());
                // what is not a number stays so, to be refused
                let is_longer = |max_step_s: &f64| *max_step_s > longest_s;
                max_step_s
                    .filter(|step| !is_longer(step))
                    .unwrap_or(longest_s)
            }
        }
    }

    /// Sets a robot in motion, to be moved by steps of `step_s`, from positions in rad at velocities
    /// in rad/s.
    pub(crate) fn start(
        self,
        robot: &dyn Robot,
        step_s: f64,
        [start_rad, velocity_rad_s]: [&[f64]; 2],
    ) -> Result<Box<dyn Motion>, PlantError> {
        match self {
            Self::Rk4 => robot.start(start_rad, velocity_rad_s),
            Self::Exact => robot.start_exact(start_rad, velocity_rad_s, step_s),
        }
    }
}
