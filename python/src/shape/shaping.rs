//! `frfid.shape`.

use frfid_estimate::{
    Driver, Iteration, ShapeError, ShapeOptions, Shaped as Shaping, Shaper, Step, Target,
    shape as shape_on,
};
use frfid_experiment::Guarded;
use frfid_signals::checks::positive;
use frfid_signals::{Injection, Limit, Limits, Record, Testbed};
use ndarray::{Array3, Ix3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;

use crate::array::{Axes, real};
use crate::error;
use crate::interrupt::interruptible;
use crate::plant::controller::{PiController, closed_loop};
use crate::plant::robot::Plant;
use crate::shape::kept::kept;
use crate::shape::shaped::Shaped;
use crate::signals::profile::per_channel;
use crate::signals::run::by_key;
use crate::size::copied;
use crate::testbed::python_testbed::PythonTestbed;

const SIGNALS: [Axes; 1] = [&["experiment", "channel", "sample"]];

/// Shapes the reference of a controlled machine until its torque is the desired one, SK15 section
/// 5.3.
///
/// In closed loop the torque cannot be commanded. From a reference that is small enough to be safe
/// the response from reference to torque is estimated in every iteration, and the next reference is
/// what should lead to the desired torque; its peaks are predicted and kept inside the limits
/// before it is applied.
///
/// Parameters
/// ----------
/// testbed : object or (Plant, PiController)
///     Anything with ``run(run: Run) -> Record``, called on this thread for one run after the
///     other, whose reference is in rad/s; or a plant and its controller,
///     simulated with all experiments side by side.
/// desired : array_like, shape (experiment, channel, sample)
///     What the target is to be, tail included; as many experiments as channels.
/// start : array_like, same shape
///     Reference of the first iteration in rad/s.
/// sample_time_s : float
///     Sample time in s.
/// low_hz, high_hz : float, optional
///     Band that is shaped, in Hz.
/// target : {"torque", "velocity"}, optional
///     Which measured signal is to follow ``desired``.
/// step : {"damped", "paper"}, optional
///     Correct a share of what is missing, or the paper's fixed point, which friction pushes apart.
/// damping : float, optional
///     That share; halved where the error rises.
/// smoothing_bins : int, optional
///     Lines over which the damped step smooths the response.
/// n_iterations : int, optional
///     Most iterations.
/// good_enough : float, optional
///     Relative error, rms over the band, at which to stop.
/// largest_change : float, optional
///     Largest growth of a reference's peak from one iteration to the next.
/// max_torque_nm, max_velocity_rad_s, max_travel_rad : float or sequence of float, optional
///     Limits of each axis that no reference may exceed.
/// max_stuck_share : float, optional
///     Largest share of the time that an axis may be stuck.
/// still_rad_s : float, optional
///     Velocity reading up to which an axis counts as stuck.
/// coulomb_nm : float or sequence of float, optional
///     Coulomb friction of each axis in N m, to be named beside an axis that sticks.
/// seed : int, optional
///     Seed of the sensors' noise of a simulated plant.
/// folder : str or path-like, optional
///     Where every record is written as soon as it is measured, as ``iteration_NN/RUN.mcap``; a run whose very
///     reference is there is read, not done again, so that the next call goes on where this one ended.
/// overwrite : bool, optional
///     Whether runs of another shaping in ``folder`` are replaced.
/// progress : callable, optional
///     Called with (done, total) iterations, from (0, total) on; an exception from it stops the
///     work.
///
/// Returns
/// -------
/// Shaped
///
/// Raises
/// ------
/// ValueError
///     For shapes and numbers that do not fit, a first reference that is too large, a target that
///     does not respond.
/// NumericalError
///     If a simulation diverges or a response cannot be inverted.
// longer than 40 lines: a line for each keyword
#[pyfunction]
#[pyo3(signature = (testbed, *, desired, start, sample_time_s, low_hz = 2.0, high_hz = 60.0, target = "torque",
                    step = "damped", damping = 0.9, smoothing_bins = 30, n_iterations = 6, good_enough = 0.05,
                    largest_change = 3.0, max_torque_nm = None, max_velocity_rad_s = None, max_travel_rad = None,
                    max_stuck_share = 0.15, still_rad_s = 0.0, coulomb_nm = None, seed = 0, folder = None, overwrite = false,
                    progress = None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
pub(crate) fn shape(
    testbed: &Bound<'_, PyAny>,
    desired: &Bound<'_, PyAny>,
    start: &Bound<'_, PyAny>,
    sample_time_s: f64,
    low_hz: f64,
    high_hz: f64,
    target: &str,
    step: &str,
    damping: f64,
    smoothing_bins: usize,
    n_iterations: usize,
    good_enough: f64,
    largest_change: f64,
    max_torque_nm: Option<&Bound<'_, PyAny>>,
    max_velocity_rad_s: Option<&Bound<'_, PyAny>>,
    max_travel_rad: Option<&Bound<'_, PyAny>>,
    max_stuck_share: f64,
    still_rad_s: f64,
    coulomb_nm: Option<&Bound<'_, PyAny>>,
    seed: u64,
    folder: Option<PathBuf>,
    overwrite: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Shaped> {
    let desired = copied(&real::<Ix3>("desired", desired, &SIGNALS)?.as_array())?;
    let start = copied(&real::<Ix3>("start", start, &SIGNALS)?.as_array())?;
    let n_axes = start.dim().1;
    let per_axis = |name, value: Option<&Bound<'_, PyAny>>| {
        value.map(|v| per_channel(name, v, n_axes)).transpose()
    };
    let mut limits = Limits::default();
    for (limit, name, values) in [
        (Limit::Torque, "max_torque_nm", max_torque_nm),
        (Limit::Velocity, "max_velocity_rad_s", max_velocity_rad_s),
        (Limit::Travel, "max_travel_rad", max_travel_rad),
    ] {
        if let Some(values) = per_axis(name, values)? {
            for &value in &values {
                positive(name, value).map_err(error::signal)?;
            }
            limits.set(limit, values);
        }
    }
    let options = ShapeOptions {
        target: one_of(
            "target",
            target,
            [("torque", Target::Torque), ("velocity", Target::Velocity)],
        )?,
        step: one_of(
            "step",
            step,
            [
                (
                    "damped",
                    Step::Damped {
                        damping,
                        smoothing_bins,
                        adaptive: true,
                    },
                ),
                ("paper", Step::Paper),
            ],
        )?,
        low_hz,
        high_hz,
        sample_time_s,
        n_iterations,
        good_enough,
        largest_change,
        limits,
        margin: ShapeOptions::default().margin,
        max_stuck_share,
        still_rad_s,
        coulomb_nm: per_axis("coulomb_nm", coulomb_nm)?,
    };
    let py = testbed.py();
    let shaped = match testbed.extract::<(Bound<'_, Plant>, Bound<'_, PiController>)>() {
        Ok((plant, controller)) => {
            let testbed = closed_loop(plant.get(), controller.get(), seed);
            let kept = kept(&testbed, folder.as_deref(), overwrite)?;
            let testbed = kept.as_ref().map_or(&testbed as &dyn Testbed, |kept| kept);
            simulated(py, testbed, desired, start, options, progress)?
        }
        Err(_) => {
            let machine = PythonTestbed::new(testbed, n_axes, by_key(&options.limits), "rad/s")?;
            let kept = kept(&machine, folder.as_deref(), overwrite)?;
            let testbed = kept.as_ref().map_or(&machine as &dyn Testbed, |kept| kept);
            let guarded = Guarded::new(
                testbed,
                &options.limits,
                &vec![0.0; n_axes],
                Injection::Velocity,
            );
            measured(py, &guarded, desired, start, options, progress)?
        }
    };
    Shaped::of(py, shaped)
}

/// Shaping on a simulated machine while the interpreter goes on.
fn simulated(
    py: Python<'_>,
    testbed: &dyn Testbed,
    desired: Array3<f64>,
    start: Array3<f64>,
    options: ShapeOptions,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Shaping> {
    let total = options.n_iterations;
    interruptible(py, progress, |progress| {
        progress.report(0, total);
        shape_on(testbed, desired, start, options, &mut |iteration| {
            Ok(progress.report(iteration.number, total))
        })
    })?
    .map_err(error::shape)
}

/// Shaping on a machine behind Python code, run by run on the calling thread, which hears Ctrl-C in
/// the middle of a run.
fn measured(
    py: Python<'_>,
    testbed: &dyn Testbed,
    desired: Array3<f64>,
    start: Array3<f64>,
    options: ShapeOptions,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Shaping> {
    let total = options.n_iterations;
    let mut turns = Turns {
        py,
        testbed,
        progress,
        total,
    };
    turns.tell(0)?;
    let shaper = Shaper::new(desired, start, options).map_err(error::shape)?;
    shaper.drive(&mut turns).map_err(|Failed(error)| error)
}

/// Runs done one after the other on the calling thread.
struct Turns<'a, 'py> {
    py: Python<'py>,
    testbed: &'a dyn Testbed,
    progress: Option<&'a Bound<'py, PyAny>>,
    total: usize,
}

/// Why a shaping on a machine of Python's failed.
struct Failed(PyErr);

impl From<ShapeError> for Failed {
    fn from(error: ShapeError) -> Self {
        Self(error::shape(error))
    }
}

impl Turns<'_, '_> {
    fn tell(&self, done: usize) -> PyResult<()> {
        let call = |callable: &Bound<'_, PyAny>| callable.call1((done, self.total)).map(drop);
        self.progress.map_or(Ok(()), call)
    }
}

impl Driver for Turns<'_, '_> {
    type Error = Failed;

    fn records(&mut self, shaper: &Shaper) -> Result<Vec<Record>, Failed> {
        let testbed = self.testbed;
        let runs = shaper.runs();
        let records = self.py.detach(|| {
            let records = runs.iter().map(|run| testbed.run(run));
            records.collect::<Result<Vec<Record>, _>>()
        });
        Ok(records.map_err(ShapeError::from)?)
    }

    fn iterated(&mut self, iteration: &Iteration) -> Result<bool, Failed> {
        self.tell(iteration.number).map_err(Failed)?;
        Ok(true)
    }
}

/// The choice of this name.
fn one_of<T>(argument: &str, name: &str, choices: [(&str, T); 2]) -> PyResult<T> {
    let needed = choices
        .each_ref()
        .map(|(name, _)| format!("`{name}`"))
        .join(" or ");
    let found = choices.into_iter().find(|(choice, _)| *choice == name);
    found.map(|(_, value)| value).ok_or_else(|| {
        PyValueError::new_err(format!(
            "{argument}: unknown variant `{name}`, expected {needed}"
        ))
    })
}
