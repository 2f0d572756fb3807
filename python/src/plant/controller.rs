//! `frfid.PiController` and `frfid.run_closed_loop`.

use std::sync::Arc;

use frfid_plant::{Actuation, Controller as _, PiController as Controller, SimulatedRobot};
use pyo3::prelude::*;

use crate::error;
use crate::pickle::{Reduced, attributes};
use crate::plant::batch::simulate;
use crate::plant::robot::Plant;
use crate::plant::robots::Robots;
use crate::signals::profile::per_channel;
use crate::signals::record::Record;

/// A sampled PI controller of the motor velocity: ``u = gain e + integral``, which grows by
/// ``integral_gain e sample_time_s`` per sample; ``e = r - y``, plus ``position_gain`` times the
/// error of the position where there is a position loop.
///
/// Parameters
/// ----------
/// gain : float or sequence of float
///     Proportional gain of each axis in N m s/rad; the longest of the sequences says how many axes
///     there are.
/// integral_gain : float or sequence of float
///     Integral gain of each axis in N m/rad.
/// sample_time_s : float
///     Sample time in s.
/// delay_samples : int, optional
///     Whole samples from reading the velocity to the torque's acting.
/// max_torque_nm : float or sequence of float, optional
///     Torque limit of each axis in N m.
/// max_torque_rate_nm_per_s : float or sequence of float, optional
///     Largest change of each axis' torque in N m/s.
/// position_gain : float or sequence of float, optional
///     Gain of the position loop of each axis in 1/s; no position loop without it.
///
/// Raises
/// ------
/// ValueError
///     For a parameter out of range.
#[pyclass(frozen, eq, module = "frfid")]
#[derive(PartialEq)]
pub(crate) struct PiController {
    pub controller: Controller,
    pub sample_time_s: f64,
}

#[pymethods]
impl PiController {
    #[new]
    #[pyo3(signature = (*, gain, integral_gain, sample_time_s, delay_samples = 0, max_torque_nm = None,
                        max_torque_rate_nm_per_s = None, position_gain = None))]
    fn new(
        gain: &Bound<'_, PyAny>,
        integral_gain: &Bound<'_, PyAny>,
        sample_time_s: f64,
        delay_samples: usize,
        max_torque_nm: Option<&Bound<'_, PyAny>>,
        max_torque_rate_nm_per_s: Option<&Bound<'_, PyAny>>,
        position_gain: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let limits = [max_torque_nm, max_torque_rate_nm_per_s, position_gain];
        let given = [gain, integral_gain].into_iter();
        let given = given.chain(limits.into_iter().flatten());
        let n_axes = given.filter_map(|value| value.len().ok()).max();
        let n_axes = n_axes.unwrap_or(1);
        let max_rate = max_torque_rate_nm_per_s;
        let per_axis = |name, value: Option<&Bound<'_, PyAny>>| {
            value.map(|v| per_channel(name, v, n_axes)).transpose()
        };
        let controller = Controller {
            gain_nms_per_rad: per_channel("gain", gain, n_axes)?,
            integral_gain_nm_per_rad: per_channel("integral_gain", integral_gain, n_axes)?,
            position_gain_per_s: per_axis("position_gain", position_gain)?,
            delay_samples,
            max_torque_nm: per_axis("max_torque_nm", max_torque_nm)?,
            max_torque_rate_nm_per_s: per_axis("max_torque_rate_nm_per_s", max_rate)?,
        };
        let checked = controller.check(n_axes, sample_time_s);
        checked.map_err(error::signal)?;
        Ok(Self {
            controller,
            sample_time_s,
        })
    }

    /// Proportional gain of each axis in N m s/rad.
    #[getter]
    fn gain(&self) -> Vec<f64> {
        self.controller.gain_nms_per_rad.clone()
    }

    /// Integral gain of each axis in N m/rad.
    #[getter]
    fn integral_gain(&self) -> Vec<f64> {
        self.controller.integral_gain_nm_per_rad.clone()
    }

    /// Sample time in s.
    #[getter]
    fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// Whole samples from reading the velocity to the torque's acting.
    #[getter]
    fn delay_samples(&self) -> usize {
        self.controller.delay_samples
    }

    /// Torque limit of each axis in N m, or None.
    #[getter]
    fn max_torque_nm(&self) -> Option<Vec<f64>> {
        self.controller.max_torque_nm.clone()
    }

    /// Largest change of each axis' torque in N m/s, or None.
    #[getter]
    fn max_torque_rate_nm_per_s(&self) -> Option<Vec<f64>> {
        self.controller.max_torque_rate_nm_per_s.clone()
    }

    /// Gain of the position loop of each axis in 1/s, or None.
    #[getter]
    fn position_gain(&self) -> Option<Vec<f64>> {
        self.controller.position_gain_per_s.clone()
    }

    fn __repr__(&self) -> String {
        let Controller {
            gain_nms_per_rad: gain,
            integral_gain_nm_per_rad: integral_gain,
            ..
        } = &self.controller;
        let sample_time_s = self.sample_time_s;
        format!(
            "<frfid.PiController: gain {gain:?}, integral_gain {integral_gain:?}, {sample_time_s} s per sample>"
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let limits = ["max_torque_nm", "max_torque_rate_nm_per_s"];
        let names = [
            &[
                "gain",
                "integral_gain",
                "position_gain",
                "sample_time_s",
                "delay_samples",
            ][..],
            &limits,
        ]
        .concat();
        attributes(slf, &names)
    }
}

/// Simulates a plant under velocity control, from its pose.
///
/// Parameters
/// ----------
/// plant : Plant or sequence of Plant
///     The robot, or one for each run.
/// controller : PiController
///     Its controller, on whose clock the run is done.
/// r : array_like, shape (channel, sample) or (batch, channel, sample)
///     Reference velocity in rad/s, the constant velocity included.
/// velocity_rad_s : float or sequence of float, optional
///     Constant velocity in rad/s with which motors and links start, held by the controller.
/// start_rad : float or sequence of float, optional
///     Where motors and links start, in rad from the pose.
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
///     ``u`` is the torque that acted, ``y`` the velocity reading in rad/s; limits that were
///     reached are among its events.
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit and samples that are not finite.
/// NumericalError
///     If the loop diverges.
#[pyfunction]
#[pyo3(signature = (plant, controller, r, *, velocity_rad_s = None, start_rad = None, integrator = "rk4", seed = 0, progress = None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
pub(crate) fn run_closed_loop(
    plant: &Bound<'_, PyAny>,
    controller: &PiController,
    r: &Bound<'_, PyAny>,
    velocity_rad_s: Option<&Bound<'_, PyAny>>,
    start_rad: Option<&Bound<'_, PyAny>>,
    integrator: &str,
    seed: u64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Record> {
    let robots = Robots::of(plant, &controller.actuation(), integrator, seed)?;
    simulate(
        "r",
        r,
        &robots,
        controller.sample_time_s,
        velocity_rad_s,
        start_rad,
        progress,
    )
}

/// The plant under the controller, with the plant's sensors.
pub(crate) fn closed_loop(plant: &Plant, controller: &PiController, seed: u64) -> SimulatedRobot {
    SimulatedRobot {
        sensors: plant.sensors.clone(),
        seed,
        actuation: controller.actuation(),
        ..SimulatedRobot::open_loop(Arc::clone(&plant.robot))
    }
}

impl PiController {
    fn actuation(&self) -> Actuation {
        Actuation::Velocity {
            controller: Arc::new(self.controller.clone()),
            sample_time_s: self.sample_time_s,
        }
    }
}
