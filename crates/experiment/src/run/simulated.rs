//! Simulated robot that a description asks for, watched as a real one would be, and its
//! linear truth.

use std::iter::zip;
use std::sync::Arc;

use frfid_plant::{Hold, SimulatedRobot, Watch};
use frfid_signals::{Frf, Limit, Record, Run, Testbed, TestbedError};

use crate::error::ExperimentError;
use crate::experiment::Experiment;

/// In the place of a simulated robot where none is described.
struct NoModel {
    n_inputs: usize,
}

impl Testbed for NoModel {
    fn n_inputs(&self) -> usize {
        self.n_inputs
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        Err(TestbedError::Foreign {
            run: run.id,
            source: Box::new(ExperimentError::NoModel),
        })
    }
}

/// Time in s in which a run that exceeds a limit is brought to rest.
const RAMP_S: f64 = 0.2;

impl Experiment {
    /// The simulated robot, in open loop or under its controller if one is described. Runs that
    /// exceed a limit of torque, velocity or travel are brought to rest, and end there.
    /// Without a model every run fails, as [`Experiment::model`] says.
    #[must_use]
    pub fn testbed(&self) -> Box<dyn Testbed> {
        match self.simulator(Some(self.watch())) {
            Ok(simulator) => Box::new(simulator),
            Err(_) => Box::new(NoModel {
                n_inputs: self.plan.n_inputs,
            }),
        }
    }

    /// The simulated robot, watched or not.
    pub(crate) fn simulator(
        &self,
        watch: Option<Watch>,
    ) -> Result<SimulatedRobot, ExperimentError> {
        let robot = Arc::clone(self.model()?);
        let simulated = match &self.controller {
            None => SimulatedRobot::open_loop(robot),
            Some(controller) => SimulatedRobot::closed_loop(
                robot,
                Arc::clone(controller),
                self.config.sample_time_s,
            ),
        };
        Ok(SimulatedRobot {
            sensors: self.sensors.clone(),
            seed: self.config.seed,
            integration: self.config.integrator,
            watch,
            ..simulated
        })
    }

    /// Exact FRF from motor torque to velocity at the pose of the robot without its nonlinearities;
    /// with `sensor` as the robot's sensors see it, by differencing and through a filter
    /// ([`frfid_plant::Robot::frf_through_sensors`]).
    ///
    /// # Errors
    /// [`ExperimentError`] for frequencies out of range, and without a model.
    pub fn truth(&self, hz: &[f64], hold: Hold, sensor: bool) -> Result<Frf, ExperimentError> {
        let (robot, sample_time_s) = (self.model()?, self.config.sample_time_s);
        let truth = if sensor {
            robot.frf_through_sensors(hz, hold, sample_time_s, &self.sensors)
        } else {
            robot.frf(hz, hold, sample_time_s)
        };
        Ok(truth?)
    }

    /// What stops a run: the limits, of which the watch knows those that it can read. A position
    /// limit nearer to the pose than the largest travel takes its place, on either side.
    #[must_use]
    pub fn watch(&self) -> Watch {
        let mut limits = self.limits.clone();
        for side in [Limit::LowestPosition, Limit::HighestPosition] {
            let travel = self.room_rad(side).map(|room| (Limit::Travel, room));
            limits = limits.tighter(&travel.into_iter().collect());
        }
        Watch {
            limits,
            ramp_s: RAMP_S,
        }
    }

    /// Distance in rad from the pose to a position limit, one for each axis; `None` without one.
    fn room_rad(&self, side: Limit) -> Option<Vec<f64>> {
        let positions = zip(self.limits.get(side)?, &self.pose_rad);
        Some(
            positions
                .map(|(limit, pose)| (limit - pose).abs())
                .collect(),
        )
    }
}

#[cfg(test)]
mod tests {
    use frfid_signals::Limit;

    use crate::description::templates::Template;
    use crate::description::text::TomlText;
    use crate::experiment::Experiment;

    #[test]
    fn a_position_limit_near_the_pose_is_watched() {
        let template = Template::named("r3-chirp").expect("built in");
        let limits = "max_position = [-1.04, 0.36, 3.0]\nmin_position = [-3.0, -3.0, 1.55]";
        let text = template
            .text()
            .replace("[limits]", &format!("[limits]\n{limits}"));
        let experiment = Experiment::new(
            TomlText {
                name: "r3".into(),
                text,
            },
            "".as_ref(),
        )
        .expect("sound");
        let watch = experiment.watch();
        let travel = watch.limits.get(Limit::Travel).expect("limited");
        for (found, expected) in travel.iter().zip([0.0072, 0.0109, 0.0208]) {
            assert!((found - expected).abs() < 1e-4, "{travel:?}");
        }
    }
}
