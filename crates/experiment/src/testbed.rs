//! The simulated robot that a configuration describes, and its linear truth.

use std::sync::Arc;

use frfid_plant::{ClosedLoop, Hold, OpenLoop, Robot, SingleJoint, Velocity};
use frfid_signals::{Frf, Testbed};

use crate::{Experiment, ExperimentError};

impl Experiment {
    /// The simulated robot: in open loop, or under its controller if one is described.
    ///
    /// # Errors
    /// [`ExperimentError::Config`] where no robot is described.
    pub fn testbed(&self) -> Result<Box<dyn Testbed>, ExperimentError> {
        let (joint, seed, sensors) = (self.joint()?, self.config.seed, vec![self.config.robot.sensor()]);
        Ok(match &self.config.controller {
            None => Box::new(OpenLoop { sensors, seed, ..OpenLoop::new(Arc::new(joint)) }),
            Some(table) => {
                let controller = table.controller(self.config.sample_time_s);
                Box::new(ClosedLoop { sensors, seed, ..ClosedLoop::new(Arc::new(joint), controller) })
            }
        })
    }

    /// Exact FRF from motor torque to velocity reading of the robot without its nonlinearities; see [`SingleJoint::frf`].
    ///
    /// # Errors
    /// [`ExperimentError`] where no robot is described, or for frequencies out of range.
    pub fn truth(&self, hz: &[f64], hold: Hold, velocity: Velocity) -> Result<Frf, ExperimentError> {
        Ok(self.joint()?.frf(hz, hold, self.config.sample_time_s, velocity)?)
    }

    fn joint(&self) -> Result<SingleJoint, ExperimentError> {
        let missing = || self.source.error(&["robot"], "no robot to simulate: a table [robot.single_joint] is needed");
        Ok(self.config.robot.joint().ok_or_else(missing)?)
    }
}
