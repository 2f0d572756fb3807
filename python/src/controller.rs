//! `frfid.PiController` and `frfid.run_closed_loop`.

use std::sync::Arc;

use frfid_plant::{ClosedLoop, PiController as Controller};
use pyo3::prelude::*;

use crate::batch::simulate;
use crate::error;
use crate::pickle::{NewArguments, attributes};
use crate::plant::Plant;
use crate::profile::per_channel;
use crate::record::Record;

/// A sampled PI controller of the motor velocity: ``u = gain (r - y) + integral``, which grows by
/// ``integral_gain (r - y) sample_time_s`` per sample.
///
/// Parameters
/// ----------
/// gain : float or sequence of float
///     Proportional gain of each axis in N m s/rad.
/// integral_gain : float or sequence of float
///     Integral gain of each axis in N m/rad.
/// sample_time_s : float
///     Sample time in s.
/// delay_samples : int, optional
///     Whole samples from reading the velocity to the torque's acting.
/// max_torque_nm : float or sequence of float, optional
///     Torque limit of each axis in N m.
///
/// Raises
/// ------
/// ValueError
///     For a parameter out of range.
#[pyclass(frozen, eq, module = "frfid")]
#[derive(PartialEq)]
pub struct PiController {
    pub controller: Controller,
}

#[pymethods]
impl PiController {
    #[new]
    #[pyo3(signature = (*, gain, integral_gain, sample_time_s, delay_samples = 0, max_torque_nm = None))]
    fn new(
        gain: &Bound<'_, PyAny>,
        integral_gain: &Bound<'_, PyAny>,
        sample_time_s: f64,
        delay_samples: usize,
        max_torque_nm: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let controller = Controller {
            gain: per_channel("gain", gain, 1)?,
            integral_gain: per_channel("integral_gain", integral_gain, 1)?,
            position_gain: None,
            sample_time_s,
            delay_samples,
            max_torque_nm: max_torque_nm.map(|limit| per_channel("max_torque_nm", limit, 1)).transpose()?,
            max_torque_rate_nm_per_s: None,
        };
        controller.check(1).map_err(error::signal)?;
        Ok(Self { controller })
    }

    /// Proportional gain of each axis in N m s/rad.
    #[getter]
    fn gain(&self) -> Vec<f64> {
        self.controller.gain.clone()
    }

    /// Integral gain of each axis in N m/rad.
    #[getter]
    fn integral_gain(&self) -> Vec<f64> {
        self.controller.integral_gain.clone()
    }

    /// Sample time in s.
    #[getter]
    fn sample_time_s(&self) -> f64 {
        self.controller.sample_time_s
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

    fn __repr__(&self) -> String {
        let Controller { gain, integral_gain, sample_time_s, .. } = &self.controller;
        format!("<frfid.PiController: gain {gain:?}, integral_gain {integral_gain:?}, {sample_time_s} s per sample>")
    }

    fn __getnewargs_ex__<'py>(slf: &Bound<'py, Self>) -> PyResult<NewArguments<'py>> {
        attributes(slf, &["gain", "integral_gain", "sample_time_s", "delay_samples", "max_torque_nm"])
    }
}

/// Simulates a plant under velocity control, from position 0.
///
/// Parameters
/// ----------
/// plant : Plant
///     The robot.
/// controller : PiController
///     Its controller, on whose clock the run is done.
/// r : array_like, shape (channel, sample) or (batch, channel, sample)
///     Reference velocity in rad/s, the constant velocity included.
/// velocity_rad_s : float or sequence of float, optional
///     Constant velocity in rad/s with which motor and link start, held by the controller.
/// seed : int, optional
///     Seed of the sensors' noise.
/// progress : callable, optional
///     Called with (done, total), from (0, total) on; an exception from it stops the simulation.
///
/// Returns
/// -------
/// Record
///     ``u`` is the torque that acted, ``y`` the velocity reading in rad/s; limits that were reached are among its events.
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit and samples that are not finite.
/// NumericalError
///     If the loop diverges.
#[pyfunction]
#[pyo3(signature = (plant, controller, r, *, velocity_rad_s = None, seed = 0, progress = None))]
pub fn run_closed_loop(
    plant: &Plant,
    controller: &PiController,
    r: &Bound<'_, PyAny>,
    velocity_rad_s: Option<&Bound<'_, PyAny>>,
    seed: u64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Record> {
    let (joint, controller) = (plant.joint.clone(), controller.controller.clone());
    let sample_time_s = controller.sample_time_s;
    let testbed = ClosedLoop { sensors: vec![plant.sensor], seed, ..ClosedLoop::new(Arc::new(joint), controller) };
    simulate("r", r, &testbed, sample_time_s, velocity_rad_s, progress)
}
