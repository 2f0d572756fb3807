//! Recorder of a run: its record and the true motion, taken down sample after sample.

use std::array::from_fn;

use frfid_signals::checks::{finite, of_axes, one_per_axis, positive, require_shape};
use frfid_signals::{Event, InputKind, Record, Run, SignalError, check_finite};
use ndarray::{Array2, ArrayView2, s};

use crate::control::sensor::{AxisSample, Reader, Sensor};
use crate::motion::Motion;
use crate::motion::trajectory::{Trajectory, stuck_share};

/// Samples that are put to their signals together: runs side by side have more signals than a cache
/// takes in turn.
const BLOCK: usize = 64;

/// What is kept of an axis at a sample: torque, velocity and position as they are read, what is injected;
/// the true motor position and velocity, deflection, link velocity.
type Row = [f64; 8];

/// A record in the making, and the true motion.
pub(crate) struct Recorder {
    /// The sensors of every axis.
    pub(crate) readers: Vec<Reader>,
    /// What has happened.
    pub(crate) events: Vec<Event>,
    sample_time_s: f64,
    input_kind: InputKind,
    /// The last samples, all axes of one after the other.
    block: Vec<Row>,
    /// Samples that are in their signals.
    n_kept: usize,
    signals: [Array2<f64>; 8],
    stuck_share: Vec<f64>,
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
        let measured = |sensor: &Sensor| sensor.torque_noise_nm.is_some();
        Self {
            readers: sensors.iter().enumerate().map(reader).collect(),
            events: Vec::new(),
            sample_time_s: run.sample_time_s,
            input_kind: if sensors.iter().any(measured) {
                InputKind::Measured
            } else {
                InputKind::Commanded
            },
            block: Vec::with_capacity(BLOCK * sensors.len()),
            n_kept: 0,
            signals: from_fn(|_| Array2::zeros(run.reference.dim())),
            stuck_share: vec![0.0; sensors.len()],
        }
    }

    /// Takes down the next sample of the run.
    pub(crate) fn take(&mut self, axes: &[AxisSample], motion: &dyn Motion) {
        let (position, velocity) = (motion.motor_position_rad(), motion.motor_velocity_rad_s());
        let (deflection, link_velocity) = (motion.deflection_rad(), motion.link_velocity_rad_s());
        for (axis, read) in axes.iter().enumerate() {
            self.block.push([
                read.torque_nm,
                read.velocity_rad_s,
                read.position_rad,
                read.reference,
                position[axis],
                velocity[axis],
                deflection[axis],
                link_velocity[axis],
            ]);
        }
        if self.block.len() == BLOCK * axes.len() {
            self.keep();
        }
    }

    /// Takes down how long the motors have been stuck.
    pub(crate) fn take_stuck(&mut self, motion: &dyn Motion) {
        self.stuck_share = stuck_share(motion);
    }

    /// Puts the block to the signals.
    fn keep(&mut self) {
        let n_axes = self.readers.len();
        for (number, signal) in self.signals.iter_mut().enumerate() {
            for (axis, mut of_axis) in signal.rows_mut().into_iter().enumerate() {
                let taken = self.block.iter().skip(axis).step_by(n_axes);
                let places = of_axis.iter_mut().skip(self.n_kept);
                places
                    .zip(taken)
                    .for_each(|(place, row)| *place = row[number]);
            }
        }
        self.n_kept += self.block.len() / n_axes;
        self.block.clear();
    }

    /// The record and the true motion over the samples that were taken.
    pub(crate) fn finish(mut self) -> (Record, Trajectory) {
        self.keep();
        if self.n_kept < self.signals[0].ncols() {
            for signal in &mut self.signals {
                *signal = signal.slice(s![.., ..self.n_kept]).to_owned();
            }
        }
        let [
            u,
            y,
            position_rad,
            r,
            motor_position_rad,
            motor_velocity_rad_s,
            deflection_rad,
            link_velocity_rad_s,
        ] = self.signals;
        let record = Record {
            sample_time_s: self.sample_time_s,
            u,
            y,
            r: Some(r),
            position_rad: Some(position_rad),
            input_kind: self.input_kind,
            events: self.events,
        };
        let truth = Trajectory {
            sample_time_s: self.sample_time_s,
            motor_position_rad,
            motor_velocity_rad_s,
            deflection_rad,
            link_velocity_rad_s,
            stuck_share: self.stuck_share,
        };
        (record, truth)
    }
}
