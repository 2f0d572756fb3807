//! Simulated robot that a description asks for, watched as a real one would be, and its
//! linear truth.

use std::iter::zip;
use std::sync::Arc;

use frfid_plant::{Hold, SimulatedRobot, Watch};
use frfid_signals::{Frf, Limit, SignalError, Testbed};

use crate::experiment::Experiment;

/// Time in s in which a run that exceeds a limit is brought to rest.
const RAMP_S: f64 = 0.2;

impl Experiment {
    /// The simulated robot, in open loop or under its controller if one is described. Runs that
    /// exceed a limit of torque, velocity or travel are brought to rest, and end there.
    #[must_use]
    pub fn testbed(&self) -> Box<dyn Testbed> {
        Box::new(self.simulator(Some(self.watch())))
    }

    /// The simulated robot, watched or not.
    pub(crate) fn simulator(&self, watch: Option<Watch>) -> SimulatedRobot {
        let robot = Arc::clone(&self.robot);
        let simulated = match &self.controller {
            None => SimulatedRobot::open_loop(robot),
            Some(controller) => SimulatedRobot::closed_loop(
                robot,
                Arc::clone(controller),
                self.config.sample_time_s,
            ),
        };
        SimulatedRobot {
            sensors: self.sensors.clone(),
            seed: self.config.seed,
            watch,
            ..simulated
        }
    }

    /// Exact FRF from motor torque to velocity at the pose of the robot without its nonlinearities;
    /// with `sensor` as the robot's sensors see it, by differencing and through a filter
    /// ([`frfid_plant::Robot::frf_through_sensors`]).
    ///
    /// # Errors
    /// [`SignalError`] for frequencies out of range.
    pub fn truth(&self, hz: &[f64], hold: Hold, sensor: bool) -> Result<Frf, SignalError> {
        let sample_time_s = self.config.sample_time_s;
        if sensor {
            self.robot
                .frf_through_sensors(hz, hold, sample_time_s, &self.sensors)
        } else {
            self.robot.frf(hz, hold, sample_time_s)
        }
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
