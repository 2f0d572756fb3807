//! Sensors and torque resolution of an axis (SK15 section 2, challenge F).

use std::f64::consts::TAU;

use frfid_signals::checks::positive;
use frfid_signals::{RunId, SignalError, random};
use num_complex::Complex64;
use rand::rngs::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Sensors and torque resolution of one axis; the default is ideal. Whatever is `None` is switched
/// off. Everything on the joint side of the gear.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sensor {
    /// The velocity is the difference of the last two positions over the sample time,
    /// `y[k] = (q[k] - q[k-1]) / sample_time_s`, not the true velocity at the sample instant. That
    /// adds the factor (1 - e^{-s T}) / (s T) to the continuous transfer function, 10.8 deg at 60 Hz
    /// for T = 1 ms.
    pub velocity_by_differencing: bool,
    /// Position increment in rad on the joint side: one encoder count.
    pub position_increment_rad: Option<f64>,
    /// Rms of the white noise in rad on the position, before it is rounded to increments.
    pub position_noise_rad: Option<f64>,
    /// Rms of the white noise in rad/s on the velocity, before it is filtered.
    pub velocity_noise_rad_s: Option<f64>,
    /// Corner in Hz of a low-pass of first order on the velocity reading,
    /// `y[k] = p y[k-1] + (1 - p) v[k]` with p = e^{-2 pi f_c T}: the pole of 2 pi f_c / (s + 2 pi
    /// f_c), mapped exactly, H(z) = (1 - p) / (1 - p z^-1).
    pub velocity_filter_hz: Option<f64>,
    /// Resolution of the motor torque in N m: the torque that acts is a multiple of it.
    pub torque_quantum_nm: Option<f64>,
    /// Rms of the white noise in N m on the torque reading; with it the recorded input is a
    /// measurement, without it the torque that acted.
    pub torque_noise_nm: Option<f64>,
}

impl Sensor {
    /// Checks every parameter that is switched on.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] naming the first one that is not finite and above 0.
    pub fn check(&self) -> Result<(), SignalError> {
        let parameters = [
            ("position_increment_rad", self.position_increment_rad),
            ("position_noise_rad", self.position_noise_rad),
            ("velocity_noise_rad_s", self.velocity_noise_rad_s),
            ("velocity_filter_hz", self.velocity_filter_hz),
            ("torque_quantum_nm", self.torque_quantum_nm),
            ("torque_noise_nm", self.torque_noise_nm),
        ];
        parameters
            .into_iter()
            .try_for_each(|(name, value)| value.map_or(Ok(()), |value| positive(name, value)))
    }

    /// What the reading does to a sampled signal at a frequency in Hz: (1 - z^-1) / T from the
    /// position where velocities are differences, 1 from the true velocity, times the filter (1 -
    /// p) / (1 - p z^-1); z = e^{j 2 pi f T}.
    #[must_use]
    pub fn response(&self, hz: f64, sample_time_s: f64) -> Complex64 {
        let before = Complex64::cis(-TAU * hz * sample_time_s);
        let reading = if self.velocity_by_differencing {
            (1.0 - before) / sample_time_s
        } else {
            Complex64::from(1.0)
        };
        let pole = self.filter_pole(sample_time_s);
        reading * (1.0 - pole) / (1.0 - pole * before)
    }

    /// Pole p of the velocity filter; 0 without one.
    pub(crate) fn filter_pole(&self, sample_time_s: f64) -> f64 {
        self.velocity_filter_hz
            .map_or(0.0, |hz| (-TAU * hz * sample_time_s).exp())
    }

    /// The torque in N m that acts when this one is commanded.
    #[must_use]
    pub fn acting_torque(&self, command_nm: f64) -> f64 {
        rounded(command_nm, self.torque_quantum_nm)
    }
}

/// The nearest multiple of a step, if there is one.
fn rounded(value: f64, step: Option<f64>) -> f64 {
    step.map_or(value, |step| step * (value / step).round())
}

/// One axis at a sample: what is injected, and what its sensors say.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct AxisSample {
    pub(crate) reference: f64,
    pub(crate) position_rad: f64,
    pub(crate) velocity_rad_s: f64,
    pub(crate) torque_nm: f64,
}

/// White noise from a stream of its own.
struct Noise {
    rms: f64,
    rng: ChaCha8Rng,
}

impl Noise {
    /// Noise of a name and an rms on a channel of a run.
    fn new(rms: f64, seed: u64, name: &str, run: RunId, channel: usize) -> Self {
        let indices = [
            run.kind as usize,
            run.realization,
            run.experiment,
            run.repetition,
            channel,
        ];
        let rng = random::stream(seed, name, &indices.map(|i| i as u64));
        Self { rms, rng }
    }
}

/// Reads one axis' sensors, sample after sample, with the noise of one run.
pub(crate) struct Reader {
    sensor: Sensor,
    sample_time_s: f64,
    position_noise: Option<Noise>,
    velocity_noise: Option<Noise>,
    torque_noise: Option<Noise>,
    /// Position reading of the sample before, in rad.
    last_position_rad: f64,
    /// Velocity reading of the sample before, in rad/s.
    last_velocity_rad_s: f64,
    filter_pole: f64,
}

impl Reader {
    /// Begins to read a run that starts at a position in rad, reached at a constant velocity in
    /// rad/s, at which the filter has settled.
    pub(crate) fn new(
        sensor: Sensor,
        seed: u64,
        run: RunId,
        channel: usize,
        [position_rad, velocity_rad_s]: [f64; 2],
        sample_time_s: f64,
    ) -> Self {
        let noise =
            |name, rms: Option<f64>| rms.map(|rms| Noise::new(rms, seed, name, run, channel));
        let mut reader = Self {
            sensor,
            sample_time_s,
            position_noise: noise("position-noise", sensor.position_noise_rad),
            velocity_noise: noise("velocity-noise", sensor.velocity_noise_rad_s),
            torque_noise: noise("torque-noise", sensor.torque_noise_nm),
            last_position_rad: 0.0,
            last_velocity_rad_s: velocity_rad_s,
            filter_pole: sensor.filter_pole(sample_time_s),
        };
        reader.last_position_rad = reader.position(position_rad - velocity_rad_s * sample_time_s);
        reader
    }

    /// Position and velocity readings of the next sample.
    pub(crate) fn motion(&mut self, position_rad: f64, velocity_rad_s: f64) -> (f64, f64) {
        let position = self.position(position_rad);
        let velocity = if self.sensor.velocity_by_differencing {
            (position - self.last_position_rad) / self.sample_time_s
        } else {
            velocity_rad_s
        };
        self.last_position_rad = position;
        let velocity = noisy(velocity, &mut self.velocity_noise);
        self.last_velocity_rad_s =
            self.filter_pole * self.last_velocity_rad_s + (1.0 - self.filter_pole) * velocity;
        (position, self.last_velocity_rad_s)
    }

    /// Reading of the torque that acts from the next sample on.
    pub(crate) fn torque(&mut self, acting_nm: f64) -> f64 {
        noisy(acting_nm, &mut self.torque_noise)
    }

    fn position(&mut self, position_rad: f64) -> f64 {
        rounded(
            noisy(position_rad, &mut self.position_noise),
            self.sensor.position_increment_rad,
        )
    }
}

fn noisy(value: f64, noise: &mut Option<Noise>) -> f64 {
    value
        + noise
            .as_mut()
            .map_or(0.0, |noise| noise.rms * random::normal(&mut noise.rng))
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::RunKind;

    const RUN: RunId = RunId {
        kind: RunKind::Excitation,
        realization: 2,
        experiment: 0,
        repetition: 1,
    };

    fn reader(sensor: Sensor, run: RunId, channel: usize) -> Reader {
        Reader::new(sensor, 5, run, channel, [0.0, 0.25], 1e-3)
    }

    #[test]
    fn positions_come_in_increments_and_velocities_in_increments_per_sample() {
        let increment = 1e-4;
        let sensor = Sensor {
            velocity_by_differencing: true,
            position_increment_rad: Some(increment),
            ..Sensor::default()
        };
        let mut reader = reader(sensor, RUN, 0);
        for k in 0..100 {
            let (position, velocity) = reader.motion(0.25e-3 * f64::from(k), 0.25);
            let counts = [position / increment, velocity * 1e-3 / increment];
            assert!(
                counts
                    .iter()
                    .all(|count| (count - count.round()).abs() < 1e-6),
                "{counts:?}"
            );
            assert!((position - 0.25e-3 * f64::from(k)).abs() <= 0.5 * increment + 1e-12);
        }
        assert_eq!(
            Sensor {
                torque_quantum_nm: Some(0.5),
                ..sensor
            }
            .acting_torque(1.3),
            1.5
        );
    }

    #[test]
    fn a_differenced_velocity_knows_the_motion_before_the_first_sample() {
        let sensor = Sensor {
            velocity_by_differencing: true,
            ..Sensor::default()
        };
        assert!((reader(sensor, RUN, 0).motion(0.0, 0.25).1 - 0.25).abs() < 1e-15);
    }

    #[test]
    fn a_filter_starts_settled_and_answers_a_step_as_its_time_constant_says() {
        let sensor = Sensor {
            velocity_filter_hz: Some(20.0),
            ..Sensor::default()
        };
        let mut reader = reader(sensor, RUN, 0);
        assert_eq!(reader.motion(0.0, 0.25).1, 0.25);
        let step = (1..=100).map(|k| (k, reader.motion(0.0, 1.25).1));
        for (k, velocity) in step {
            // the continuous filter's step response, (1 - e^{-2 pi f_c t}), at the sample instants
            let expected = 1.25 - (-TAU * 20.0 * 1e-3 * f64::from(k)).exp();
            assert!(
                (velocity - expected).abs() < 1e-12,
                "{velocity} at sample {k}"
            );
        }
        assert!((sensor.response(1e-9, 1e-3) - 1.0).norm() < 1e-9);
    }

    #[test]
    fn every_run_channel_and_quantity_has_its_own_noise_and_the_same_each_time() {
        let rms = Some(1.0);
        let sensor = Sensor {
            position_noise_rad: rms,
            velocity_noise_rad_s: rms,
            torque_noise_nm: rms,
            ..Sensor::default()
        };
        let draws = |run, channel| {
            let mut reader = reader(sensor, run, channel);
            let (position, velocity) = reader.motion(0.0, 0.0);
            [position, velocity, reader.torque(0.0)]
        };
        assert_eq!(draws(RUN, 0), draws(RUN, 0));
        let mut all: Vec<f64> = draws(RUN, 0).to_vec();
        all.extend(draws(RUN, 1));
        all.extend(draws(
            RunId {
                repetition: 2,
                ..RUN
            },
            0,
        ));
        all.extend(draws(
            RunId {
                kind: RunKind::Glide,
                ..RUN
            },
            0,
        ));
        all.sort_by(f64::total_cmp);
        assert!(all.windows(2).all(|pair| pair[0] != pair[1]), "{all:?}");
    }

    #[test]
    fn noise_has_the_stated_rms() {
        let mut reader = reader(
            Sensor {
                torque_noise_nm: Some(0.5),
                ..Sensor::default()
            },
            RUN,
            0,
        );
        let power = (0..40_000)
            .map(|_| (reader.torque(3.0) - 3.0).powi(2))
            .sum::<f64>()
            / 40_000.0;
        assert!((power.sqrt() / 0.5 - 1.0).abs() < 0.015, "{power}"); // four standard errors
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        for bad in [0.0, -1.0, f64::NAN] {
            let sensor = Sensor {
                torque_quantum_nm: Some(bad),
                ..Sensor::default()
            };
            assert!(matches!(
                sensor.check(),
                Err(SignalError::Parameter {
                    key: "torque_quantum_nm",
                    ..
                })
            ));
        }
    }
}
