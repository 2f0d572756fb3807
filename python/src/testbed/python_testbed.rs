//! A testbed written in Python: any object with `run(run: frfid.Run) -> frfid.Record`.

use std::sync::{Mutex, PoisonError};

use frfid_signals::{Record as Measured, Run as Planned, SignalError};
use frfid_signals::{Testbed, TestbedError};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::array::c_ordered;
use crate::signals::record::Record;
use crate::signals::run::{LimitsByKey, Run};

/// The object, and the turn that a run waits for: a machine does one run at a time.
pub(crate) struct PythonTestbed {
    object: Py<PyAny>,
    takes_bare_reference: bool,
    n_inputs: usize,
    limits: LimitsByKey,
    reference_unit: String,
    turn: Mutex<()>,
}

impl PythonTestbed {
    /// The testbed behind `object`, for references of `n_inputs` channels; every run is given the
    /// limits.
    pub(crate) fn new(
        object: &Bound<'_, PyAny>,
        n_inputs: usize,
        limits: LimitsByKey,
        reference_unit: &str,
    ) -> PyResult<Self> {
        let run = object.getattr("run").ok().filter(PyAnyMethods::is_callable);
        let Some(run) = run else {
            let found = object.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "testbed is a {found}, needed an object with run(run: frfid.Run) -> frfid.Record"
            )));
        };
        Ok(Self {
            object: object.clone().unbind(),
            takes_bare_reference: takes_bare_reference(&run),
            n_inputs,
            limits,
            reference_unit: reference_unit.to_owned(),
            turn: Mutex::new(()),
        })
    }

    fn measured(&self, py: Python<'_>, run: &Planned) -> PyResult<Measured> {
        let object = self.object.bind(py);
        let answer = if self.takes_bare_reference {
            check_from_rest(run)?;
            object.call_method1("run", (c_ordered(py, run.reference.clone()),))?
        } else {
            let run = Run::of(py, run.clone(), self.limits.clone(), &self.reference_unit);
            object.call_method1("run", (run,))?
        };
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

/// Whether `run` is written as `run(reference)`, for the bare array and nothing else of the run.
fn takes_bare_reference(run: &Bound<'_, PyAny>) -> bool {
    let first_name = || -> PyResult<String> {
        let inspect = run.py().import("inspect")?;
        let signature = inspect.call_method1("signature", (run,))?;
        let first = signature.getattr("parameters")?.try_iter()?.next();
        first
            .transpose()?
            .map_or(Ok(String::new()), |name| name.extract())
    };
    // a callable without a signature, written in C, gets the whole run
    first_name().is_ok_and(|name| name == "reference")
}

/// Refuses a run that starts elsewhere or in motion for an object that would not hear of it.
fn check_from_rest(run: &Planned) -> PyResult<()> {
    let is_zero = |values: &[f64]| values.iter().all(|value| *value == 0.0);
    if is_zero(&run.velocity_rad_s) && is_zero(&run.start_rad) {
        return Ok(());
    }
    Err(PyTypeError::new_err(format!(
        "run {} starts {:?} rad from the pose at {:?} rad/s, which a testbed with run(reference) does not \
         learn; needed run(run: frfid.Run): go to run.start_rad, up to run.velocity_rad_s, and play run.reference",
        run.id, run.start_rad, run.velocity_rad_s
    )))
}

impl Testbed for PythonTestbed {
    fn n_inputs(&self) -> usize {
        self.n_inputs
    }

    fn run(&self, run: &Planned) -> Result<Measured, TestbedError> {
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
