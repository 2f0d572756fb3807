//! Checks of an experiment before it is simulated: limits that leave no amplitude, and what looks
//! like a mistake.

use std::f64::consts::TAU;

use frfid_plant::{Robot, check_stability};
use frfid_signals::format::significant;
use frfid_signals::{Excess, Limit, Peaks};

use crate::description::text::ConfigError;
use crate::design::plausible::implausible;
use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::load::larger;

/// Most steps of the integrator in a run: minutes of a single joint, an hour of an arm.
const MOST_STEPS: f64 = 1e9;

impl Experiment {
    /// What is possible but looks like a mistake: joints without limits, other units than meant, inertias that no body
    /// can have, and gains under which the linear loop is not stable.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = implausible(&self.config);
        warnings.extend(self.note.clone());
        warnings.extend(self.robot.iter().flat_map(|robot| robot.warnings()));
        warnings.extend(self.instability());
        warnings
    }

    /// That the linear loop of the robot's model is not stable.
    #[must_use]
    pub fn instability(&self) -> Option<String> {
        let (robot, controller) = (self.robot.as_ref()?, self.controller.as_ref()?);
        let sample_time_s = self.config.sample_time_s;
        let checked = check_stability(&**robot, &**controller, sample_time_s, &self.sensors);
        checked.err().map(|error| error.to_string())
    }

    /// Refuses a robot so stiff that a run of it takes hours to simulate.
    ///
    /// # Errors
    /// [`ConfigError`] at the robot.
    pub(crate) fn check_work(&self) -> Result<(), ConfigError> {
        let (Some(robot), Ok(n_samples)) = (&self.robot, self.plan.run_samples()) else {
            return Ok(());
        };
        let in_sample = (self.plan.sample_time_s / robot.default_step_s()).max(1.0);
        let n_steps = in_sample * n_samples as f64;
        if n_steps > MOST_STEPS {
            let hz = robot.fastest_rad_s() / TAU;
            return Err(self
                .text
                .error(&["robot"], too_stiff(n_steps, in_sample, hz)));
        }
        Ok(())
    }

    /// Refuses a limit that friction, gravity and the constant velocity exceed without any
    /// excitation.
    ///
    /// # Errors
    /// [`ConfigError`] at the limit.
    pub(crate) fn check_feasible(&self) -> Result<(), ConfigError> {
        let Some(robot) = &self.robot else {
            return Ok(());
        };
        let resting = self
            .resting(&**robot)
            .map_err(|error| self.text.error(&["robot"], error.to_string()))?;
        match self.limits.exceeded(&resting).first() {
            Some(excess) => Err(self.no_amplitude(excess)),
            None => Ok(()),
        }
    }

    fn no_amplitude(&self, excess: &Excess) -> ConfigError {
        let &Excess {
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
            self.joint_names[axis],
            self.limit_owner(excess),
        );
        self.error_at_limit(excess, message)
    }

    fn exceeds_robots_own(&self, excess: &Excess) -> bool {
        self.limit_is_robots_own(excess.limit, excess.axis)
    }

    /// The limit, and whose it is.
    #[must_use]
    pub fn limit_owner(&self, excess: &Excess) -> String {
        let owner = if self.exceeds_robots_own(excess) {
            "the robot's"
        } else {
            "the limit"
        };
        format!("{owner} {}", excess.limit.key())
    }

    /// An error at the place of the limit in the description.
    #[must_use]
    pub fn error_at_limit(&self, excess: &Excess, message: String) -> ConfigError {
        if self.exceeds_robots_own(excess) {
            self.text.error(&["robot"], message)
        } else {
            self.text.error(&["limits", excess.limit.key()], message)
        }
    }

    /// What the runs ask of the robot without their excitation, at both ends of their way.
    fn resting(&self, robot: &dyn Robot) -> Result<Peaks, ExperimentError> {
        let start = self.plan.start_rad()?;
        let travel = sizes(&start);
        let holding_nm = self.holding_nm(robot, &start)?;
        let at_rest = |limit: &Limit| match limit {
            Limit::Torque => Some(holding_nm.clone()),
            Limit::TorqueRate => Some(vec![0.0; start.len()]),
            Limit::Velocity => Some(sizes(&self.plan.velocity_rad_s)),
            Limit::Acceleration | Limit::Jerk => None,
            Limit::Travel => Some(travel.clone()),
            Limit::LowestPosition => Some(self.beside_pose(&travel, -1.0)),
            Limit::HighestPosition => Some(self.beside_pose(&travel, 1.0)),
        };
        let known = |limit: &Limit| Some((*limit, at_rest(limit)?));
        Ok(Limit::ALL.iter().filter_map(known).collect())
    }

    /// Positions of all axes on one side of the pose.
    fn beside_pose(&self, travel_rad: &[f64], sign: f64) -> Vec<f64> {
        let ways = self.pose_rad.iter().zip(travel_rad);
        ways.map(|(pose, way)| pose + sign * way).collect()
    }

    /// Torque that friction and gravity ask for on the way from `start_rad` to its mirror image,
    /// the larger of both ends.
    fn holding_nm(
        &self,
        robot: &dyn Robot,
        start_rad: &[f64],
    ) -> Result<Vec<f64>, ExperimentError> {
        let end_rad: Vec<f64> = start_rad.iter().map(|start| -start).collect();
        let velocity = &self.plan.velocity_rad_s;
        let at_start = robot.start(start_rad, velocity)?.holding_nm();
        let at_end = robot.start(&end_rad, velocity)?.holding_nm();
        Ok(larger(&sizes(&at_start), &sizes(&at_end)))
    }
}

fn too_stiff(n_steps: f64, in_sample: f64, hz: f64) -> String {
    let [n_steps, in_sample, hz] = [n_steps, in_sample, hz].map(|number| significant(number, 3));
    let most = significant(MOST_STEPS, 3);
    format!(
        "a run takes {n_steps} steps of the integrator, {in_sample} in each sample, at most {most} are taken: the robot's \
         fastest resonance or decay is at {hz} Hz; lower its stiffness or damping, or raise its inertias"
    )
}

fn sizes(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value.abs()).collect()
}
