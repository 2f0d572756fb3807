//! Fills the record of a run, sample after sample, as the sensors see it.

use frfid_signals::{InputKind, Record, Run, SignalError, check_finite};
use ndarray::Array2;

use crate::Sensor;
use crate::sensor::Reader;
use frfid_signals::range::{finite, positive};

/// A record in the making, of a run on a machine of `A` axes.
pub(crate) struct Recorder<const A: usize> {
    readers: [Reader; A],
    /// What has been recorded so far.
    pub record: Record,
}

impl<const A: usize> Recorder<A> {
    /// Checks the run and the sensors and begins the record; returns the run's constant velocity in rad/s with it.
    ///
    /// # Errors
    /// [`SignalError`] for a parameter out of range, a number of channels other than `A`, or a reference that is not finite.
    pub fn new(sensors: &[Sensor], seed: u64, run: &Run) -> Result<(Self, [f64; A]), SignalError> {
        positive("sample_time_s", run.sample_time_s)?;
        if run.reference.nrows() != A {
            return Err(shape("reference", run.reference.shape().to_vec(), format!("({A}, sample)")));
        }
        check_finite("reference", run.reference.view())?;
        let velocity_rad_s = channels("velocity_rad_s", &run.velocity_rad_s)?;
        velocity_rad_s.iter().try_for_each(|&velocity| finite("velocity_rad_s", velocity))?;
        let sensors: [Sensor; A] = channels("sensors", sensors)?;
        sensors.iter().try_for_each(Sensor::check)?;
        let reader = |axis| Reader::new(sensors[axis], seed, run.id, axis, velocity_rad_s[axis], run.sample_time_s);
        let zeros = || Array2::zeros(run.reference.dim());
        let measured = sensors.iter().any(|sensor| sensor.torque_noise_nm.is_some());
        let record = Record {
            sample_time_s: run.sample_time_s,
            u: zeros(),
            y: zeros(),
            r: Some(run.reference.clone()),
            position_rad: Some(zeros()),
            input_kind: if measured { InputKind::Measured } else { InputKind::Commanded },
            events: Vec::new(),
        };
        Ok((Self { readers: std::array::from_fn(reader), record }, velocity_rad_s))
    }

    /// Records what the sensors say of the motion at a sample; returns the velocity readings in rad/s.
    pub fn motion(&mut self, sample: usize, position_rad: [f64; A], velocity_rad_s: [f64; A]) -> [f64; A] {
        std::array::from_fn(|axis| {
            let (position, velocity) = self.readers[axis].motion(position_rad[axis], velocity_rad_s[axis]);
            self.record.y[[axis, sample]] = velocity;
            if let Some(positions) = &mut self.record.position_rad {
                positions[[axis, sample]] = position;
            }
            velocity
        })
    }

    /// Records the torques in N m that act from a sample on.
    pub fn torque(&mut self, sample: usize, acting_nm: [f64; A]) {
        for (axis, reader) in self.readers.iter_mut().enumerate() {
            self.record.u[[axis, sample]] = reader.torque(acting_nm[axis]);
        }
    }
}

/// Exactly one value per axis.
pub(crate) fn channels<T: Copy, const A: usize>(name: &'static str, values: &[T]) -> Result<[T; A], SignalError> {
    values.try_into().map_err(|_| shape(name, vec![values.len()], format!("({A})")))
}

fn shape(name: &'static str, found: Vec<usize>, needed: String) -> SignalError {
    SignalError::Shape { name, found, needed }
}
