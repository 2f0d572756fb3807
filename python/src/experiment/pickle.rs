//! Copies and pickles of a `Plan`.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::experiment::description::Experiment;
use crate::experiment::plan::Plan;

#[pymethods]
impl Plan {
    /// The plan itself, which nothing changes.
    fn __copy__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __deepcopy__<'py>(slf: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        slf
    }

    /// A plan that was designed is designed again; the references of one that was read are in its file.
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, Experiment>,))> {
        if let Some(path) = slf.get().planned.path() {
            return Err(PyTypeError::new_err(format!(
                "the references of this plan are in {}: send the path in its place, for frfid.Plan.load",
                path.display()
            )));
        }
        let experiment = Experiment {
            description: slf.get().description().clone(),
        };
        let design = slf.py().get_type::<Experiment>().getattr("design")?;
        Ok((design, (Bound::new(slf.py(), experiment)?,)))
    }
}
