//! What can be told of an experiment before it is simulated: limits that leave no amplitude, and
//! what looks like a mistake.

use frfid_plant::check_stability;

use crate::description::limits::LimitsTable;
use crate::description::text::ConfigError;
use crate::design::predict::{Excess, Peaks};
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
        let Some(excess) = resting.excesses(&self.limits()).into_iter().next() else {
            return Ok(());
        };
        let Excess {
            axis,
            limit,
            allowed,
            found,
        } = excess;
        let unit = LimitsTable::unit(limit);
        let message = format!(
            "no amplitude is left: without any excitation axis {} ({}) is at {found:.5} {unit}, {} is {allowed:.5} {unit}; \
             lower the constant velocity, shorten the runs, choose another pose, or raise the limit",
            axis + 1,
            self.config.robot.joint_names()[axis],
            self.whose(&excess),
        );
        Err(self.source.error(&self.place_of(&excess), message))
    }

    /// The limit, and whose it is.
    #[must_use]
    pub fn whose(&self, excess: &Excess) -> String {
        let whose = if self.is_robots(excess.limit, excess.axis) {
            "the robot's"
        } else {
            "the limit"
        };
        format!("{whose} {}", excess.limit)
    }

    /// Where the limit stands in the description.
    #[must_use]
    pub fn place_of(&self, excess: &Excess) -> Vec<&'static str> {
        if self.is_robots(excess.limit, excess.axis) {
            vec!["robot"]
        } else {
            vec!["limits", excess.limit]
        }
    }

    /// What the runs ask of the robot without their excitation, at both ends of their way.
    fn resting(&self) -> Result<Peaks, ExperimentError> {
        let (robot, velocity) = (self.robot()?, &self.plan.velocity_rad_s);
        let start = self.plan.start_rad()?;
        let end: Vec<f64> = start.iter().map(|start| -start).collect();
        let holding = [&start, &end].map(|place| Ok(robot.start(place, velocity)?.holding_nm()));
        let [at_start, at_end]: [Result<Vec<f64>, ExperimentError>; 2] = holding;
        let effort_nm = at_start?
            .iter()
            .zip(at_end?)
            .map(|(a, b)| a.abs().max(b.abs()))
            .collect();
        let way: Vec<f64> = start.iter().map(|start| start.abs()).collect();
        let from_pose = |sign: f64| {
            self.config
                .robot
                .pose()
                .iter()
                .zip(&way)
                .map(|(q, way)| q + sign * way)
                .collect()
        };
        Ok(Peaks {
            effort_nm,
            effort_rate_nm_per_s: vec![0.0; way.len()],
            velocity_rad_s: velocity.iter().map(|velocity| velocity.abs()).collect(),
            acceleration_rad_s2: None,
            jerk_rad_s3: None,
            lowest_rad: Some(from_pose(-1.0)),
            highest_rad: Some(from_pose(1.0)),
            travel_rad: Some(way),
            effort_rms_nm: vec![0.0; velocity.len()],
        })
    }
}
