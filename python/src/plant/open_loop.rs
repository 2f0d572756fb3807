//! Simulation in open loop: `Plant.simulate` of one plant, `frfid.simulate` of several.

use frfid_plant::Actuation;
use pyo3::prelude::*;

use crate::choice::choice;
use crate::plant::batch;
use crate::plant::robot::Plant;
use crate::plant::robots::Robots;
use crate::signals::record::Record;

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
    /// integrator : {"rk4", "exact"}, optional
    ///     How the robot is moved on: by Runge-Kutta steps, or by exact ones, in less time, which need a
    ///     single joint without torque ripple. Both locate friction's events to rounding.
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
    #[pyo3(signature = (u, *, sample_time_s, hold = "zoh", velocity_rad_s = None, integrator = "rk4", seed = 0, progress = None))]
    #[pyo3(name = "simulate")]
    #[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
    fn simulate_alone(
        slf: &Bound<'_, Self>,
        u: &Bound<'_, PyAny>,
        sample_time_s: f64,
        hold: &str,
        velocity_rad_s: Option<&Bound<'_, PyAny>>,
        integrator: &str,
        seed: u64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Record> {
        simulate(
            slf.as_any(),
            u,
            sample_time_s,
            hold,
            velocity_rad_s,
            integrator,
            seed,
            progress,
        )
    }
}

/// Simulates plants in open loop, one for each run, each from its pose: frictions, stiffnesses, payloads
/// or poses side by side.
///
/// Parameters
/// ----------
/// plants : sequence of Plant
///     One for each run, all with as many axes.
/// u : array_like, shape (input, sample) or (batch, input, sample)
///     Motor torque in N m, the same for all plants or one for each.
/// sample_time_s : float
///     Sample time in s.
/// hold : {"zoh", "linear"}, optional
///     What the torque does between samples.
/// velocity_rad_s : float or sequence of float, optional
///     As in ``Plant.simulate``.
/// integrator : {"rk4", "exact"}, optional
///     As in ``Plant.simulate``.
/// seed : int, optional
///     Seed of the sensors' noise.
/// progress : callable, optional
///     Called with (done, total), from (0, total) on; an exception from it stops the simulation.
///
/// Returns
/// -------
/// Record
///     A batch: what ``Plant.simulate`` of each plant gives, to the last digit but for the noise, which
///     differs from run to run.
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit and samples that are not finite.
/// NumericalError
///     If the simulation diverges.
#[pyfunction]
#[pyo3(signature = (plants, u, *, sample_time_s, hold = "zoh", velocity_rad_s = None, integrator = "rk4", seed = 0, progress = None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
pub(crate) fn simulate(
    plants: &Bound<'_, PyAny>,
    u: &Bound<'_, PyAny>,
    sample_time_s: f64,
    hold: &str,
    velocity_rad_s: Option<&Bound<'_, PyAny>>,
    integrator: &str,
    seed: u64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Record> {
    let hold = choice("hold", hold)?;
    let robots = Robots::of(plants, &Actuation::Torque { hold }, integrator, seed)?;
    batch::simulate(
        "u",
        u,
        &robots,
        sample_time_s,
        velocity_rad_s,
        None,
        progress,
    )
}
