//! `frfid.subtract_glide`.

use frfid_estimate::{EstimateError, RippleTorque};
use frfid_signals::Record as Run;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error;
use crate::frf::matrix::Frf;
use crate::signals::record::Record;
use crate::threads::detached;

/// Takes the glide, a run on the constant velocity alone, off a run of the same start and velocity
/// (SK15 section 4.4 E).
///
/// By time: sample by sample, which repeats as long as the positions do. By position: torque ripple
/// belongs to the position of the motor, so ``u`` loses besides what the ripple at the run's own
/// positions differs from that of the glide; for this a first estimate of the plant is needed, such
/// as the one after subtraction by time.
///
/// Parameters
/// ----------
/// run : Record
///     A run, or a batch of runs.
/// glide : Record
///     The glide, one run; it may be longer.
/// by : {"time", "position"}, optional
///     How.
/// plant : Frf, optional
///     First estimate from torque to velocity, square; needed by position.
///
/// Returns
/// -------
/// Record
///     ``u``, ``y`` and ``r`` without the glide; the position stays that of the run.
///
/// Raises
/// ------
/// ValueError
///     For records that do not fit each other, a glide in another direction, or positions that the
///     glide did not reach.
#[pyfunction]
#[pyo3(signature = (run, glide, *, by = "time", plant = None))]
pub(crate) fn subtract_glide(
    py: Python<'_>,
    run: &Record,
    glide: &Record,
    by: &str,
    plant: Option<&Frf>,
) -> PyResult<Record> {
    let runs = run.runs(py);
    let [glide] = <[Run; 1]>::try_from(glide.runs(py)).map_err(|runs| {
        PyValueError::new_err(format!(
            "glide is a batch of {} runs, needed one run",
            runs.len()
        ))
    })?;
    let rest: Result<Vec<Run>, EstimateError> = match (by, plant) {
        ("time", _) => detached(py, || {
            runs.iter()
                .map(|run| frfid_estimate::subtract_glide(run, &glide))
                .collect()
        })?,
        ("position", Some(plant)) => {
            let plant = &plant.result.frf;
            detached(py, || {
                let ripple = RippleTorque::of_glide(&glide, plant)?;
                runs.iter().map(|run| ripple.subtract_glide(run)).collect()
            })?
        }
        ("position", None) => {
            return Err(PyValueError::new_err(
                "plant is needed by position: a first estimate of the FRF",
            ));
        }
        _ => {
            return Err(PyValueError::new_err(format!(
                "by: unknown variant `{by}`, expected `time` or `position`"
            )));
        }
    };
    Record::of(py, rest.map_err(error::estimate)?, run.is_batch(py))
}
