//! Simulating one run or a batch of runs.

use frfid_signals::{GoOn, Run, RunId, Testbed as _, check_finite};
use ndarray::{Array2, ArrayView3, ArrayViewD, Axis, Ix3, IxDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::{Axes, real};
use crate::error;
use crate::plant::robots::Robots;
use crate::signals::profile::per_channel;
use crate::signals::record::Record;
use crate::testbed::runs::records_of;

const SHAPES: [Axes; 2] = [&["channel", "sample"], &["batch", "channel", "sample"]];

/// What the sensors of the robots measured for each reference in `value`, the argument called `name`,
/// from a start, on a constant velocity.
pub(crate) fn simulate(
    name: &'static str,
    value: &Bound<'_, PyAny>,
    robots: &Robots,
    sample_time_s: f64,
    velocity_rad_s: Option<&Bound<'_, PyAny>>,
    start_rad: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Record> {
    let array = real::<IxDyn>(name, value, &SHAPES)?;
    let (array, stacked) = batch(array.as_array());
    let n_inputs = robots.n_inputs();
    check(name, &array, n_inputs)?;
    let n_runs = n_runs(name, array.len_of(Axis(0)), stacked, robots)?;
    let or_zeros = |name, value: Option<&Bound<'_, PyAny>>| {
        let zeros = || Ok(vec![0.0; n_inputs]);
        value.map_or_else(zeros, |value| per_channel(name, value, n_inputs))
    };
    let velocity_rad_s = or_zeros("velocity_rad_s", velocity_rad_s)?;
    let start_rad = or_zeros("start_rad", start_rad)?;
    let ids: Vec<RunId> = (0..n_runs)
        .map(|run| RunId::excitation(0, 0, run))
        .collect();
    let run = |id: RunId, _: GoOn| {
        let place = if stacked { id.repetition } else { 0 };
        let reference: Array2<f64> = array.index_axis(Axis(0), place).to_owned();
        Ok(Run {
            id,
            sample_time_s,
            reference,
            velocity_rad_s: velocity_rad_s.clone(),
            start_rad: start_rad.clone(),
        })
    };
    let records = records_of(value.py(), &ids, &run, robots, 0, progress)?;
    Record::of(value.py(), records, stacked || robots.n_each().is_some())
}

/// References as a batch, and whether they were one.
fn batch(array: ArrayViewD<'_, f64>) -> (ArrayView3<'_, f64>, bool) {
    let stacked = array.ndim() == 3;
    let array = if stacked {
        array.into_dimensionality::<Ix3>()
    } else {
        array.insert_axis(Axis(0)).into_dimensionality()
    };
    (array.expect("`real` let 2 or 3 axes pass"), stacked)
}

/// Number of runs: of the references, of the robots where one reference is for all of them.
fn n_runs(name: &str, n_references: usize, stacked: bool, robots: &Robots) -> PyResult<usize> {
    match robots.n_each() {
        None => Ok(n_references),
        Some(n_robots) if !stacked || n_references == n_robots => Ok(n_robots),
        Some(n_robots) => Err(PyValueError::new_err(format!(
            "{name} has a batch of {n_references}, needed one for each of {n_robots} plants"
        ))),
    }
}

fn check(name: &'static str, array: &ArrayView3<'_, f64>, n_inputs: usize) -> PyResult<()> {
    if array.len_of(Axis(1)) != n_inputs || array.is_empty() {
        let needed = format!(
            "needed ({n_inputs}, sample) or (batch, {n_inputs}, sample), at least one sample"
        );
        return Err(PyValueError::new_err(format!(
            "{name} has shape {:?}, {needed}",
            array.shape()
        )));
    }
    array
        .outer_iter()
        .try_for_each(|reference| check_finite(name, reference))
        .map_err(error::signal)
}
