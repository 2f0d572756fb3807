//! Dynamics of an arm's links: `Plant.mass_matrix`, `gravity_torque`, `link_acceleration`,
//! `modes_hz`.

use frfid_plant::{Arm, LinkDynamics};
use numpy::PyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error;
use crate::plant::robot::Plant;
use crate::plant::states::per_state;

#[pymethods]
impl Plant {
    /// Mass matrix of an arm's links.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, shape (axis,) or (batch, axis)
    ///     Link positions in rad.
    ///
    /// Returns
    /// -------
    /// ndarray, float64, shape (axis, axis) or (batch, axis, axis)
    ///     In kg m^2.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a single joint, another number of axes, or numbers that are not finite.
    /// MemoryError
    ///     For more numbers than can be held.
    fn mass_matrix<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (links, n) = (self.links()?, self.robot.n_axes());
        let matrix =
            |state: &[&[f64]]| Ok(links.mass_matrix(state[0])?.transpose().as_slice().to_vec());
        per_state(q.py(), n, &[("q", q)], &[n, n], matrix)
    }

    /// Torques that hold an arm's links against gravity.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, shape (axis,) or (batch, axis)
    ///     Link positions in rad.
    ///
    /// Returns
    /// -------
    /// ndarray, float64, shape of q
    ///     In N m.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a single joint, another number of axes, or numbers that are not finite.
    /// MemoryError
    ///     For more numbers than can be held.
    fn gravity_torque<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let links = self.links()?;
        per_state(
            q.py(),
            self.robot.n_axes(),
            &[("q", q)],
            &[self.robot.n_axes()],
            |state| links.gravity_torque_nm(state[0]),
        )
    }

    /// Accelerations of an arm's links: M^-1 (torque - C qd - g).
    ///
    /// Parameters
    /// ----------
    /// q, qd, torque : array_like, shape (axis,) or (batch, axis)
    ///     Link positions in rad, velocities in rad/s, and the torques in N m that the gears
    ///     transmit.
    ///
    /// Returns
    /// -------
    /// ndarray, float64, shape of q
    ///     In rad/s^2.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a single joint, shapes that do not fit, or numbers that are not finite.
    /// MemoryError
    ///     For more numbers than can be held.
    fn link_acceleration<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        qd: &Bound<'py, PyAny>,
        torque: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let links = self.links()?;
        let arguments = [("q", q), ("qd", qd), ("torque", torque)];
        per_state(
            q.py(),
            self.robot.n_axes(),
            &arguments,
            &[self.robot.n_axes()],
            |state| links.acceleration(state[0], state[1], state[2]),
        )
    }

    /// Frequencies of an arm's undamped elastic modes at the pose, without gravity.
    ///
    /// Parameters
    /// ----------
    /// motors_locked : bool, optional
    ///     The modes of the links with the motors held: the zeros of the FRFs taken together.
    ///
    /// Returns
    /// -------
    /// list of float
    ///     In Hz, rising.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a single joint.
    #[pyo3(signature = (*, motors_locked = false))]
    fn modes_hz(&self, motors_locked: bool) -> PyResult<Vec<f64>> {
        let arm = self.arm()?;
        if motors_locked {
            arm.locked_motor_hz()
        } else {
            arm.modes_hz()
        }
        .map_err(error::signal)
    }
}

impl Plant {
    fn links(&self) -> PyResult<LinkDynamics> {
        self.arm()?.link_dynamics().map_err(error::signal)
    }

    pub(super) fn arm(&self) -> PyResult<Arm> {
        self.table.arm().ok_or_else(|| {
            PyValueError::new_err("a single joint is no arm: it has one link and one mode")
        })
    }
}
