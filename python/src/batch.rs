//! Simulating one run or a batch of runs, several at once.

use frfid_signals::{Record as Run, Run as Order, RunId, RunKind, Testbed, TestbedError, check_finite};
use ndarray::{Axis, Ix2, IxDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::array::{Axes, real};
use crate::error;
use crate::interrupt::interruptible;
use crate::profile::per_channel;
use crate::record::Record;

const SHAPES: [Axes; 2] = [&["channel", "sample"], &["batch", "channel", "sample"]];

/// The runs that an array of references asks for.
pub struct Batch {
    runs: Vec<Order>,
    /// Whether the array had an axis for the batch.
    stacked: bool,
}

impl Batch {
    /// One run for each reference in `value`, the argument called `name`, riding on a constant velocity.
    pub fn new(
        name: &'static str,
        value: &Bound<'_, PyAny>,
        sample_time_s: f64,
        velocity_rad_s: Option<&Bound<'_, PyAny>>,
        testbed: &dyn Testbed,
    ) -> PyResult<Self> {
        let array = real::<IxDyn>(name, value, &SHAPES)?;
        let (array, stacked) = (array.as_array(), array.as_array().ndim() == 3);
        let array = if stacked { array } else { array.insert_axis(Axis(0)) };
        let n_inputs = testbed.n_inputs();
        if array.len_of(Axis(1)) != n_inputs || array.is_empty() {
            let needed = format!("needed {n_inputs} channels and at least one sample");
            return Err(PyValueError::new_err(format!("{name} has shape {:?}, {needed}", array.shape())));
        }
        let velocity_rad_s = velocity_rad_s
            .map_or_else(|| Ok(vec![0.0; n_inputs]), |velocity| per_channel("velocity_rad_s", velocity, n_inputs))?;
        let mut runs = Vec::new();
        for (repetition, reference) in array.axis_iter(Axis(0)).enumerate() {
            let reference = reference.into_dimensionality::<Ix2>().expect("one axis of three was taken");
            check_finite(name, reference).map_err(error::signal)?;
            let id = RunId { kind: RunKind::Excitation, realization: 0, experiment: 0, repetition };
            let (reference, velocity_rad_s) = (reference.to_owned(), velocity_rad_s.clone());
            runs.push(Order { id, sample_time_s, reference, velocity_rad_s });
        }
        Ok(Self { runs, stacked })
    }
}

/// Does every run, detached from the interpreter.
pub fn run_batch(
    py: Python<'_>,
    testbed: &dyn Testbed,
    batch: &Batch,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Record> {
    let total = batch.runs.len();
    let records = interruptible(py, progress, |progress| {
        let one = |run: &Order| {
            let record = progress.wanted().then(|| testbed.run(run));
            progress.step(total);
            record
        };
        batch.runs.par_iter().map(one).while_some().collect::<Result<Vec<Run>, TestbedError>>()
    })?;
    Record::of(py, records.map_err(error::testbed)?, batch.stacked)
}
