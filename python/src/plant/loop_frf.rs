//! `frfid.loop_frf`.

use frfid_plant::LoopFrf;
use ndarray::Ix1;
use pyo3::prelude::*;

use crate::array::real;
use crate::error;
use crate::frf::matrix::Frf;
use crate::plant::controller::PiController;
use crate::plant::robot::Plant;

/// FRFs of the linear closed loop at the plant's pose, between samples: what an ideal experiment
/// would find.
///
/// Delay, differencing and filters are in them; limits, quantisation, noise, Coulomb friction and
/// ripple are not.
///
/// Parameters
/// ----------
/// plant : Plant
///     The robot, with its sensors.
/// controller : PiController
///     Its controller.
/// hz : array_like, shape (frequency,)
///     Frequencies in Hz, below half the controller's rate.
///
/// Returns
/// -------
/// dict of Frf
///     ``sensitivity`` S = (I + L K)^-1; ``r_to_u`` from reference velocity to motor torque;
///     ``r_to_y`` from reference velocity to velocity reading; ``u_to_y``, the plant as its sensors
///     see it.
///
/// Raises
/// ------
/// ValueError
///     For frequencies out of range, a controller of another number of axes, or a frequency at
///     which the loop has a pole.
#[pyfunction]
pub(crate) fn loop_frf(
    plant: &Plant,
    controller: &PiController,
    hz: &Bound<'_, PyAny>,
) -> PyResult<Loop> {
    let hz = real::<Ix1>("hz", hz, &[&["frequency"]])?
        .as_array()
        .to_vec();
    let frfs = LoopFrf::new(
        &*plant.robot,
        &controller.controller,
        controller.sample_time_s,
        &plant.sensors,
        &hz,
    )
    .map_err(error::signal)?;
    Ok(Loop {
        sensitivity: frfs.sensitivity.into(),
        r_to_u: frfs.reference_to_torque.into(),
        r_to_y: frfs.reference_to_velocity.into(),
        u_to_y: frfs.plant.into(),
    })
}

/// The FRFs of a loop, as a dict.
#[derive(IntoPyObject)]
pub(crate) struct Loop {
    sensitivity: Frf,
    r_to_u: Frf,
    r_to_y: Frf,
    u_to_y: Frf,
}
