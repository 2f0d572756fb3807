//! A testbed written in Python: any object with `run(reference) -> frfid.Record`.

use std::sync::{Mutex, PoisonError};

use frfid_signals::{Record as Measured, Run, SignalError, Testbed, TestbedError};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::array::c_ordered;
use crate::record::Record;

/// The object, and the turn that a run waits for: a machine does one run at a time.
pub struct PythonTestbed {
    object: Py<PyAny>,
    n_inputs: usize,
    turn: Mutex<()>,
}

impl PythonTestbed {
    /// The testbed behind `object`, for references of `n_inputs` channels.
    pub fn new(object: &Bound<'_, PyAny>, n_inputs: usize) -> PyResult<Self> {
        if object.getattr("run").is_ok_and(|run| run.is_callable()) {
            return Ok(Self {
                object: object.clone().unbind(),
                n_inputs,
                turn: Mutex::new(()),
            });
        }
        let found = object.get_type().name()?;
        Err(PyTypeError::new_err(format!(
            "testbed is a {found}, needed an object with run(reference) -> frfid.Record"
        )))
    }

    fn measured(&self, py: Python<'_>, run: &Run) -> PyResult<Measured> {
        let reference = c_ordered(py, run.reference.clone());
        let answer = self.object.bind(py).call_method1("run", (reference,))?;
        let Ok(record) = answer.cast::<Record>() else {
            let found = answer.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "run() of the testbed returned a {found}, needed a frfid.Record"
            )));
        };
        let [measured] = <[Measured; 1]>::try_from(record.get().runs(py)).map_err(|runs| {
            PyValueError::new_err(format!(
                "run() of the testbed returned a batch of {} runs, needed one run",
                runs.len()
            ))
        })?;
        Ok(measured)
    }
}

impl Testbed for PythonTestbed {
    fn n_inputs(&self) -> usize {
        self.n_inputs
    }

    fn run(&self, run: &Run) -> Result<Measured, TestbedError> {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let record =
            Python::attach(|py| self.measured(py, run)).map_err(|error| TestbedError::Foreign {
                run: run.id,
                source: Box::new(error),
            })?;
        // half a sample over the run may not build up
        let drift =
            (record.sample_time_s / run.sample_time_s - 1.0).abs() * record.n_samples() as f64;
        if drift > 0.5 {
            let (name, found) = ("sample_time_s of the record", record.sample_time_s);
            return Err(SignalError::Parameter {
                key: name,
                found,
                needed: "the sample time of the plan",
            }
            .into());
        }
        Ok(record)
    }
}
