//! Recorder of a run: its record, filled sample after sample as the sensors see it.

use frfid_signals::checks::{finite, of_axes, one_per_axis, positive, require_shape};
use frfid_signals::{InputKind, Record, Run, SignalError, check_finite};
use ndarray::{Array2, ArrayView2};

use crate::control::sensor::{Reader, Sensor};
use crate::control::watch::Reached;
use crate::motion::Motion;

/// A record in the making.
pub(crate) struct Recorder {
    readers: Vec<Reader>,
    /// What has been recorded so far.
    pub record: Record,
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

/// A record of a run and `after` more samples, all zeros.
fn empty_record(sensors: &[Sensor], run: &Run, after: usize) -> Record {
    let (n_axes, n_samples) = run.reference.dim();
    let zeros = || Array2::zeros((n_axes, n_samples + after));
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
    /// Begins the record of a run of a robot that stands at the start of it, with room for `after`
    /// more samples.
    pub(crate) fn new(
        sensors: &[Sensor],
        seed: u64,
        run: &Run,
        motion: &dyn Motion,
        after: usize,
    ) -> Self {
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
            record: empty_record(sensors, run, after),
        }
    }

    /// Records what an axis' sensors say of position and velocity at a sample; returns the
    /// readings.
    pub(crate) fn motion(
        &mut self,
        axis: usize,
        sample: usize,
        position_rad: f64,
        velocity_rad_s: f64,
    ) -> (f64, f64) {
        let (position, velocity) = self.readers[axis].motion(position_rad, velocity_rad_s);
        self.record.y[[axis, sample]] = velocity;
        if let Some(positions) = &mut self.record.position_rad {
            positions[[axis, sample]] = position;
        }
        (position, velocity)
    }

    /// Records what is injected on an axis at a sample.
    pub(crate) fn reference(&mut self, axis: usize, sample: usize, injected: f64) {
        if let Some(references) = &mut self.record.r {
            references[[axis, sample]] = injected;
        }
    }

    /// Records the torque in N m that acts on an axis from a sample on, and the limit that it has
    /// just reached.
    pub(crate) fn torque(
        &mut self,
        axis: usize,
        sample: usize,
        acting_nm: f64,
        reached: Option<Reached>,
    ) {
        self.record.u[[axis, sample]] = self.readers[axis].torque(acting_nm);
        let time_s = sample as f64 * self.record.sample_time_s;
        self.record
            .events
            .extend(reached.map(|reached| reached.event(axis, time_s)));
    }
}
