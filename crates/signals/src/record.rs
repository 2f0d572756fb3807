//! Record of a run: what a testbed measured.

use ndarray::{Array2, ArrayView2};
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::limit::Limit;
use crate::number::checks::{all_finite, positive, require_shape};

/// Whether the recorded plant input is what the controller commanded or what the drive measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InputKind {
    /// The command, after limits and quantisation.
    #[default]
    Commanded,
    /// A measurement, with the sensor's noise.
    Measured,
}

/// Something that happened during a run, at `time_s` after its first sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Time after the first sample of the run in s.
    pub time_s: f64,
    /// What happened.
    #[serde(flatten)]
    pub kind: EventKind,
}

/// What can happen during a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum EventKind {
    /// A measured period begins (0 is the first after the lead-in).
    PeriodStart {
        /// Number of the period.
        period: usize,
    },
    /// A quantity reached its limit.
    Limit {
        /// Channel, from 0.
        channel: usize,
        /// Which limit; files name the quantity it bounds.
        #[serde(rename = "quantity", with = "quantity_key")]
        limit: Limit,
        /// The value reached.
        value: f64,
        /// What is allowed.
        #[serde(rename = "limit")]
        allowed: f64,
    },
    /// The run was stopped before its end.
    Stopped {
        /// Why.
        reason: String,
        /// Time in s after the first sample from which on it was no longer the run that was asked
        /// for, but on its way to rest; `None` if it broke off at once.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        since_s: Option<f64>,
    },
}

/// A limit by the key of the quantity it bounds.
mod quantity_key {
    use serde::de::{Deserialize, Deserializer, Error};
    use serde::ser::Serializer;

    use crate::limit::Limit;

    pub(super) fn serialize<S: Serializer>(
        limit: &Limit,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(limit.quantity_key())
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(text: D) -> Result<Limit, D::Error> {
        let key = String::deserialize(text)?;
        Limit::named(&key, Limit::quantity_key).map_err(D::Error::custom)
    }
}

/// What one run measured: `(channel, sample)` arrays on a common clock.
///
/// Sampling convention: `y[k]` is what the sensor says at `t_k = k sample_time_s`, just before
/// `u[k]` acts; `u[k]` is applied on `[t_k, t_k + sample_time_s)`. A shift by one sample is a phase
/// error of `360 f sample_time_s` degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Plant input (motor torque in N m on the joint side), `(input, sample)`.
    pub u: Array2<f64>,
    /// Plant output (motor velocity in rad/s on the joint side), `(output, sample)`.
    pub y: Array2<f64>,
    /// Reference that was injected, `(input, sample)`, where there is one besides `u`.
    pub r: Option<Array2<f64>>,
    /// Motor position in rad on the joint side, `(output, sample)`, where it was measured.
    pub position_rad: Option<Array2<f64>>,
    /// Whether `u` was commanded or measured.
    pub input_kind: InputKind,
    /// What happened during the run, in order of time.
    pub events: Vec<Event>,
}

impl Record {
    /// Checks shapes, the sample time and that every sample is finite.
    ///
    /// # Errors
    /// [`SignalError::Parameter`], [`SignalError::Shape`] or [`SignalError::NotFinite`], naming the
    /// signal.
    pub fn check(&self) -> Result<(), SignalError> {
        positive("sample_time_s", self.sample_time_s)?;
        let samples = self.u.ncols();
        let signals = [
            ("u", Some(&self.u)),
            ("y", Some(&self.y)),
            ("r", self.r.as_ref()),
            ("position_rad", self.position_rad.as_ref()),
        ];
        for (name, signal) in signals {
            let Some(signal) = signal else { continue };
            let fits = signal.nrows() > 0 && signal.ncols() == samples;
            let needed = format_args!(
                "(channel, {samples}) with at least one channel, as many samples as u"
            );
            require_shape(name, signal.shape(), fits, needed)?;
            check_finite(name, signal.view())?;
        }
        Ok(())
    }

    /// Number of samples.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        self.u.ncols()
    }

    /// When the run was stopped before its end, in s after the first sample; `None` if it was not.
    #[must_use]
    pub fn stopped_at_s(&self) -> Option<f64> {
        let stopped = |event: &&Event| matches!(event.kind, EventKind::Stopped { .. });
        self.events.iter().find(stopped).map(|event| event.time_s)
    }

    /// How many samples, from the first on, belong to the run that was asked for: all of them, or
    /// in a stopped run those before the instant that led to the stop. A period that reaches beyond
    /// them is not steady.
    #[must_use]
    pub fn n_steady_samples(&self) -> usize {
        let from_s = |event: &Event| match event.kind {
            EventKind::Stopped { since_s, .. } => Some(since_s.unwrap_or(event.time_s)),
            _ => None,
        };
        let samples_until = |time_s: f64| (time_s / self.sample_time_s).round().max(0.0) as usize;
        self.events
            .iter()
            .find_map(from_s)
            .map_or(self.n_samples(), |time_s| {
                samples_until(time_s).min(self.n_samples())
            })
    }
}

/// Refuses NaN and infinite samples with their count and first place.
///
/// # Errors
/// [`SignalError::NotFinite`].
pub fn check_finite(name: &'static str, signal: ArrayView2<f64>) -> Result<(), SignalError> {
    if signal.sum().is_finite() {
        return Ok(()); // one bad sample is enough to spoil the sum
    }
    let bad = |(place, value): (_, &f64)| (!value.is_finite()).then_some(place);
    all_finite(name, signal.indexed_iter().filter_map(bad))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    fn record() -> Record {
        Record {
            sample_time_s: 1e-3,
            u: array![[1.0, 2.0, 3.0]],
            y: array![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
            r: None,
            position_rad: None,
            input_kind: InputKind::Commanded,
            events: Vec::new(),
        }
    }

    #[test]
    fn a_sound_record_passes_and_flaws_are_named() {
        assert_eq!(record().check(), Ok(()));
        let short = Record {
            y: array![[1.0, 2.0]],
            ..record()
        };
        assert!(matches!(
            short.check(),
            Err(SignalError::Shape { name: "y", .. })
        ));
        let mut holed = record();
        holed.y[[1, 2]] = f64::NAN;
        holed.y[[1, 1]] = f64::INFINITY;
        assert_eq!(
            holed.check(),
            Err(SignalError::NotFinite {
                name: "y",
                count: 2,
                channel: 1,
                sample: 1
            })
        );
    }

    #[test]
    fn a_stopped_run_is_steady_until_the_instant_that_led_to_the_stop() {
        let limit = EventKind::Limit {
            channel: 0,
            limit: Limit::Torque,
            value: 2.0,
            allowed: 1.0,
        };
        let stopped = |since_s| {
            let stop = EventKind::Stopped {
                reason: "axis 1 ...".into(),
                since_s,
            };
            let events = [(1e-3, limit.clone()), (3e-3, stop)];
            Record {
                events: events.map(|(time_s, kind)| Event { time_s, kind }).to_vec(),
                ..record()
            }
        };
        assert_eq!(
            (record().stopped_at_s(), record().n_steady_samples()),
            (None, 3)
        );
        assert_eq!(
            (
                stopped(Some(1e-3)).stopped_at_s(),
                stopped(Some(1e-3)).n_steady_samples()
            ),
            (Some(3e-3), 1)
        );
        assert_eq!(stopped(None).n_steady_samples(), 3);
        assert_eq!(stopped(Some(f64::NAN)).n_steady_samples(), 0); // from a file: no sample is known to be steady
    }
}
