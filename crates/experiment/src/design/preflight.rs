//! What can be told of an experiment before it is simulated: limits that leave no amplitude, and
//! what looks like a mistake.

use frfid_plant::check_stability;
use frfid_signals::{Excess, Limit, Peaks};

use crate::description::text::ConfigError;
use crate::error::ExperimentError;
use crate::experiment::Experiment;

impl Experiment {
    /// What is possible but looks like a mistake: inertias that no body can have, and gains under
    /// which the linear loop is not stable.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self
            .config
            .robot
            .arm()
            .map_or_else(Vec::new, |arm| arm.warnings());
        if let (Some(table), Ok(robot)) = (&self.config.controller, self.robot()) {
            let (controller, sensors) = (
                table.controller(self.config.sample_time_s),
                self.config.robot.sensors(),
            );
            warnings.extend(
                check_stability(&*robot, &controller, &sensors)
                    .err()
                    .map(|error| error.to_string()),
            );
        }
        warnings
    }

    /// Refuses a limit that friction, gravity and the constant velocity exceed without any
    /// excitation.
    ///
    /// # Errors
    /// [`ConfigError`] at the limit.
    pub(crate) fn check_feasible(&self) -> Result<(), ConfigError> {
        let resting = self
            .resting()
            .map_err(|error| self.source.error(&["robot"], error.to_string()))?;
        let Some(excess) = self.limits().exceeded(&resting).into_iter().next() else {
            return Ok(());
        };
        let Excess {
            axis,
            limit,
            allowed,
            found,
        } = excess;
        let unit = limit.unit();
        let message = format!(
            "no amplitude is left: without any excitation axis {} ({}) is at {found:.5} {unit}, {} is {allowed:.5} {unit}; \
             lower the constant velocity, shorten the runs, choose another pose, or raise the limit",
            axis + 1,
            self.config.robot.joint_names()[axis],
            self.limit_owner(&excess),
        );
        Err(self.source.error(&self.limit_key(&excess), message))
    }

    /// The limit, and whose it is.
    #[must_use]
    pub fn limit_owner(&self, excess: &Excess) -> String {
        let own = self.limit_is_robots_own(excess.limit, excess.axis);
        let whose = if own { "the robot's" } else { "the limit" };
        format!("{whose} {}", excess.limit.key())
    }

    /// Where the limit stands in the description.
    #[must_use]
    pub fn limit_key(&self, excess: &Excess) -> Vec<&'static str> {
        if self.limit_is_robots_own(excess.limit, excess.axis) {
            vec!["robot"]
        } else {
            vec!["limits", excess.limit.key()]
        }
    }

    /// What the runs ask of the robot without their excitation, at both ends of their way.
    fn resting(&self) -> Result<Peaks, ExperimentError> {
        let (robot, velocity) = (self.robot()?, &self.plan.velocity_rad_s);
        let start = self.plan.start_rad()?;
        let end: Vec<f64> = start.iter().map(|start| -start).collect();
        let at_start = robot.start(&start, velocity)?.holding_nm();
        let at_end = robot.start(&end, velocity)?.holding_nm();
        let torques = at_start.iter().zip(&at_end);
        let pose = self.config.robot.pose();
        let from_pose = |sign: f64| {
            let ways = pose.iter().zip(&start);
            ways.map(|(pose, start)| pose + sign * start.abs())
                .collect()
        };
        Ok([
            (
                Limit::Torque,
                torques.map(|(a, b)| a.abs().max(b.abs())).collect(),
            ),
            (Limit::TorqueRate, vec![0.0; start.len()]),
            (
                Limit::Velocity,
                velocity.iter().map(|velocity| velocity.abs()).collect(),
            ),
            (
                Limit::Travel,
                start.iter().map(|start| start.abs()).collect(),
            ),
            (Limit::LowestPosition, from_pose(-1.0)),
            (Limit::HighestPosition, from_pose(1.0)),
        ]
        .into_iter()
        .collect())
    }
}
