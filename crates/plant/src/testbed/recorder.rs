//! Recorder of a run: its record, taken down sample after sample.

use frfid_signals::checks::{finite, of_axes, one_per_axis, positive, require_shape};
use frfid_signals::{InputKind, Record, Run, SignalError, check_finite};
use ndarray::{Array2, ArrayView2};

use crate::control::sensor::{AxisSample, Reader, Sensor};
use crate::motion::Motion;

/// A record in the making.
pub(crate) struct Recorder {
    /// The sensors of every axis.
    pub(crate) readers: Vec<Reader>,
    /// What has been recorded so far.
    pub(crate) record: Record,
}

/// Checks that a signal has a channel for each of the axes, and finite samples alone.
pub(crate) fn check_channels(
    name: &'static str,
    signal: ArrayView2<f64>,
    n_axes: usize,
) -> Result<(), SignalError> {
    let needed = format_args!("({n_axes}, sample)");
    require_shape(name, signal.shape(), signal.nrows() == n_axes, needed)?;
    check_finite(name, signal)
}

/// Checks that run and sensors fit a robot of `n_axes`.
///
/// # Errors
/// [`SignalError`] for a parameter out of range, another number of channels, or a reference that is
/// not finite.
pub(crate) fn check_run(n_axes: usize, sensors: &[Sensor], run: &Run) -> Result<(), SignalError> {
    positive("sample_time_s", run.sample_time_s)?;
    check_channels("reference", run.reference.view(), n_axes)?;
    for (name, values) in [
        ("velocity_rad_s", &run.velocity_rad_s),
        ("start_rad", &run.start_rad),
    ] {
        one_per_axis(name, Some(values), n_axes, finite)?;
    }
    of_axes("sensors", sensors, n_axes)?
        .iter()
        .try_for_each(Sensor::check)
}

/// A record of a run, all zeros.
fn empty_record(sensors: &[Sensor], run: &Run) -> Record {
    let zeros = || Array2::zeros(run.reference.dim());
    let measured = sensors
        .iter()
        .any(|sensor| sensor.torque_noise_nm.is_some());
    Record {
        sample_time_s: run.sample_time_s,
        u: zeros(),
        y: zeros(),
        r: Some(zeros()),
        position_rad: Some(zeros()),
        input_kind: if measured {
            InputKind::Measured
        } else {
            InputKind::Commanded
        },
        events: Vec::new(),
    }
}

impl Recorder {
    /// Begins the record of a run of a robot that stands at the start of it.
    pub(crate) fn new(sensors: &[Sensor], seed: u64, run: &Run, motion: &dyn Motion) -> Self {
        let (position, velocity) = (motion.motor_position_rad(), motion.motor_velocity_rad_s());
        let reader = |(axis, sensor): (usize, &Sensor)| {
            Reader::new(
                *sensor,
                seed,
                run.id,
                axis,
                [position[axis], velocity[axis]],
                run.sample_time_s,
            )
        };
        Self {
            readers: sensors.iter().enumerate().map(reader).collect(),
            record: empty_record(sensors, run),
        }
    }

    /// Takes down a sample of the run.
    pub(crate) fn take(&mut self, sample: usize, axes: &[AxisSample]) {
        let Record {
            u,
            y,
            r,
            position_rad,
            ..
        } = &mut self.record;
        for (axis, at) in axes.iter().enumerate() {
            let place = [axis, sample];
            u[place] = at.torque_nm;
            y[place] = at.velocity_rad_s;
            for (signal, value) in [
                (&mut *r, at.reference),
                (&mut *position_rad, at.position_rad),
            ] {
                if let Some(signal) = signal {
                    signal[place] = value;
                }
            }
        }
    }
}
