//! Runs of a `frfid.Record`, as the crates know them.

use std::path::PathBuf;

use frfid_signals::Record as Run;
use frfid_signals::room::room;
use ndarray::{Array2, Axis, Ix2};
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::c_ordered;
use crate::error;
use crate::signals::record::Record;
use crate::sources::Sources;

impl Record {
    /// What the crates measured: one run, or a batch of runs `stacked` on an axis of their own.
    pub(crate) fn of(py: Python<'_>, runs: Vec<Run>, stacked: bool) -> PyResult<Self> {
        let [first, ..] = runs.as_slice() else {
            return Err(PyValueError::new_err("no run was done"));
        };
        let (sample_time_s, input_kind) = (first.sample_time_s, first.input_kind);
        let events = runs.iter().map(|run| run.events.clone()).collect();
        let stack =
            |of: &dyn Fn(&Run) -> Option<&Array2<f64>>| -> PyResult<Option<Py<PyArrayDyn<f64>>>> {
                let Some(signals) = runs.iter().map(of).collect::<Option<Vec<_>>>() else {
                    return Ok(None);
                };
                let array = if stacked {
                    room::<f64>(signals.iter().map(|signal| signal.len()).sum())
                        .map_err(error::signal)?;
                    let views: Vec<_> = signals.iter().map(|signal| signal.view()).collect();
                    ndarray::stack(Axis(0), &views)
                        .map_err(|error| PyValueError::new_err(error.to_string()))?
                        .into_dyn()
                } else {
                    signals[0].clone().into_dyn()
                };
                Ok(Some(c_ordered(py, array).unbind()))
            };
        let always = "every record has u and y";
        Ok(Self {
            sample_time_s,
            u: stack(&|run| Some(&run.u))?.expect(always),
            y: stack(&|run| Some(&run.y))?.expect(always),
            r: stack(&|run| run.r.as_ref())?,
            position_rad: stack(&|run| run.position_rad.as_ref())?,
            input_kind,
            events,
            sources: Sources::default(),
        })
    }

    /// The run of a file.
    pub(crate) fn read_from(py: Python<'_>, run: Run, path: PathBuf) -> PyResult<Self> {
        Ok(Self {
            sources: Sources::of([path]),
            ..Self::of(py, vec![run], false)?
        })
    }

    /// Every run as the crates know it.
    pub(crate) fn runs(&self, py: Python<'_>) -> Vec<Run> {
        let of = |signal: &Py<PyArrayDyn<f64>>| -> Vec<Array2<f64>> {
            let array = signal.bind(py).to_owned_array();
            let stacked = if array.ndim() == 2 {
                array.insert_axis(Axis(0))
            } else {
                array
            };
            let two_axes = |run: ndarray::ArrayViewD<'_, f64>| {
                run.into_dimensionality::<Ix2>().map(|run| run.to_owned())
            };
            stacked
                .axis_iter(Axis(0))
                .map(two_axes)
                .collect::<Result<_, _>>()
                .expect("`signal` let 2 or 3 axes pass")
        };
        let (u, y, r, position) = (
            of(&self.u),
            of(&self.y),
            self.r.as_ref().map(of),
            self.position_rad.as_ref().map(of),
        );
        let run = |k: usize| Run {
            sample_time_s: self.sample_time_s,
            u: u[k].clone(),
            y: y[k].clone(),
            r: r.as_ref().map(|r| r[k].clone()),
            position_rad: position.as_ref().map(|position| position[k].clone()),
            input_kind: self.input_kind,
            events: self.events[k].clone(),
        };
        (0..u.len()).map(run).collect()
    }

    /// Whether the runs have an axis of their own.
    pub(crate) fn is_batch(&self, py: Python<'_>) -> bool {
        self.u.bind(py).ndim() == 3
    }
}
