//! Simulation in open loop: `Plant.simulate`.

use frfid_plant::{Actuation, SimulatedRobot};
use pyo3::prelude::*;

use crate::choice::choice;
use crate::plant::robot::Plant;
use crate::signals::record::Record;
use crate::testbed::batch::simulate;

#[pymethods]
impl Plant {
    /// Simulates in open loop, from the pose.
    ///
    /// Parameters
    /// ----------
    /// u : array_like, shape (input, sample) or (batch, input, sample)
    ///     Motor torque in N m.
    /// sample_time_s : float
    ///     Sample time in s.
    /// hold : {"zoh", "linear"}, optional
    ///     What the torque does between samples.
    /// velocity_rad_s : float or sequence of float, optional
    ///     Constant velocity in rad/s with which motors and links start; the torques that hold it
    ///     against friction, and the links against gravity, are added.
    /// seed : int, optional
    ///     Seed of the sensors' noise.
    /// progress : callable, optional
    ///     Called with (done, total), from (0, total) on; an exception from it stops the
    ///     simulation.
    ///
    /// Returns
    /// -------
    /// Record
    ///     ``u`` is the torque that acted, ``y`` the velocity reading in rad/s, ``r`` the torque
    ///     that was asked for.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For shapes that do not fit and samples that are not finite.
    /// NumericalError
    ///     If the simulation diverges.
    #[pyo3(signature = (u, *, sample_time_s, hold = "zoh", velocity_rad_s = None, seed = 0, progress = None))]
    fn simulate(
        &self,
        u: &Bound<'_, PyAny>,
        sample_time_s: f64,
        hold: &str,
        velocity_rad_s: Option<&Bound<'_, PyAny>>,
        seed: u64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Record> {
        let (robot, sensors) = (self.robot.clone(), self.sensors.clone());
        let testbed = SimulatedRobot {
            sensors,
            seed,
            actuation: Actuation::Torque {
                hold: choice("hold", hold)?,
            },
            ..SimulatedRobot::open_loop(robot)
        };
        simulate(
            "u",
            u,
            &testbed,
            sample_time_s,
            velocity_rad_s,
            None,
            progress,
        )
    }
}
