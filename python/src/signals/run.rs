//! `frfid.Run`: one run of a plan, as a testbed gets it.

use std::collections::BTreeMap;

use frfid_signals::{Limits, Run as Planned};
use ndarray::Ix2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::array::{c_ordered, real};
use crate::choice::{from_python, to_python};
use crate::pickle::Reduced;
use crate::size::{List, copied};

/// One run of a plan: what is injected, where it starts, and what it must not exceed; given to the
/// ``run(run)`` of a testbed, and by ``plan[index]``.
///
/// A testbed brings the machine to ``start_rad``, up to ``velocity_rad_s``, and plays ``reference``;
/// it stops where one of ``limits`` is reached.
#[pyclass(frozen, module = "frfid")]
pub(crate) struct Run {
    planned: Planned,
    limits: LimitsByKey,
    reference: Py<PyArray2<f64>>,
    reference_unit: String,
}

/// Limits by their keys in ``[limits]``, a value for each axis.
pub(crate) type LimitsByKey = BTreeMap<String, Vec<f64>>;

/// The limits of a robot by their keys.
pub(crate) fn by_key(limits: &Limits) -> LimitsByKey {
    let limits = limits.iter();
    limits
        .map(|(limit, values)| (limit.key().to_owned(), values.to_vec()))
        .collect()
}

impl Run {
    /// A run of an open (N m) or closed loop (rad/s), or of channels in their own unit.
    pub(crate) fn of(
        py: Python<'_>,
        planned: Planned,
        limits: LimitsByKey,
        reference_unit: &str,
    ) -> Self {
        Self {
            reference: c_ordered(py, planned.reference.clone()).unbind(),
            limits,
            planned,
            reference_unit: reference_unit.to_owned(),
        }
    }
}

#[pymethods]
impl Run {
    /// Its name: ``"p000-m0-q0"`` is realization 0, experiment 0, repetition 0.
    #[getter]
    fn name(&self) -> String {
        self.planned.id.to_string()
    }

    /// Sample time in s.
    #[getter]
    fn sample_time_s(&self) -> f64 {
        self.planned.sample_time_s
    }

    /// What is injected, shape (channel, sample): motor torques in N m in open loop, reference
    /// velocities in rad/s in closed loop, the constant velocity then included; for ``[channels]``
    /// in their unit.
    #[getter]
    fn reference(&self, py: Python<'_>) -> Py<PyArray2<f64>> {
        self.reference.clone_ref(py)
    }

    /// Unit of the reference: ``"N m"`` in open loop, ``"rad/s"`` in closed loop, ``input_unit`` of
    /// ``[channels]``; where those have several, all of them: ``"A, %"``.
    #[getter]
    fn reference_unit(&self) -> &str {
        &self.reference_unit
    }

    /// Velocity in rad/s at which the run starts, and on which it stays but for the excitation, for
    /// each axis; zeros where there is none.
    #[getter]
    fn velocity_rad_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.planned.velocity_rad_s)
    }

    /// Where the run starts, in rad from the pose, for each axis.
    #[getter]
    fn start_rad<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.planned.start_rad)
    }

    /// Limits that the run must not exceed, by their keys in ``[limits]``, a value for each axis;
    /// without those that are not given.
    #[getter]
    fn limits(&self) -> LimitsByKey {
        self.limits.clone()
    }

    /// The run of these parts, out of a pickle.
    #[staticmethod]
    fn _of(
        id: &Bound<'_, PyAny>,
        sample_time_s: f64,
        reference: &Bound<'_, PyAny>,
        velocity_rad_s: List<f64>,
        start_rad: List<f64>,
        limits: LimitsByKey,
        reference_unit: &str,
    ) -> PyResult<Self> {
        let array = real::<Ix2>("reference", reference, &[&["channel", "sample"]])?;
        let planned = Planned {
            id: from_python("id", id)?,
            sample_time_s,
            reference: copied(&array.as_array())?,
            velocity_rad_s: velocity_rad_s.0,
            start_rad: start_rad.0,
        };
        Ok(Self::of(id.py(), planned, limits, reference_unit))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, run) = (slf.py(), slf.get());
        let Planned {
            id,
            sample_time_s,
            velocity_rad_s,
            start_rad,
            ..
        } = &run.planned;
        let parts = (
            to_python(py, id)?,
            sample_time_s,
            &run.reference,
            velocity_rad_s,
            start_rad,
            &run.limits,
            &run.reference_unit,
        );
        Ok((slf.get_type().getattr("_of")?, parts.into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        let (channels, samples) = self.planned.reference.dim();
        format!(
            "<frfid.Run {}: {channels} x {samples} samples of {} s in {}, from {:?} rad at {:?} rad/s>",
            self.name(),
            self.planned.sample_time_s,
            self.reference_unit,
            self.planned.start_rad,
            self.planned.velocity_rad_s
        )
    }
}
