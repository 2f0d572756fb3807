//! A run is watched while it runs: the first excess brings it to rest, and its record ends there.

use std::f64::consts::PI;

use frfid_signals::checks::{one_per_axis, positive};
use frfid_signals::{Event, EventKind, Record, Run, SignalError};
use serde::{Deserialize, Serialize};

/// Beyond this multiple of a limit no ramp helps: the run is cut off at once, as by an emergency
/// stop.
const CUT_OFF: f64 = 2.0;
/// A limit that is only touched, but for rounding, is kept.
const ROUNDING: f64 = 1e-9;

/// What the readings of a run must not exceed, one value for each axis; whatever is `None` is not
/// watched.
///
/// At the first excess of any axis the excitation of all axes is brought smoothly to zero within
/// `ramp_s`, by the factor (1 + cos(pi t / ramp_s)) / 2: in closed loop the whole reference, the
/// constant velocity included, in open loop the torque besides what holds the robot. There the
/// record ends, or at once where a reading is beyond twice its limit (an unstable loop does not
/// care for its reference).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Watch {
    /// Largest magnitude of the torque reading in N m.
    pub max_effort_nm: Option<Vec<f64>>,
    /// Largest magnitude of the velocity reading in rad/s.
    pub max_velocity_rad_s: Option<Vec<f64>>,
    /// Farthest from the pose in rad, either way: by how much the position reading has changed
    /// since the start of the run, and where from the pose that was.
    pub max_travel_rad: Option<Vec<f64>>,
    /// Time in s from the excess to rest.
    pub ramp_s: f64,
}

impl Watch {
    /// Checks every limit for a robot of `n_axes`.
    ///
    /// # Errors
    /// [`SignalError::Shape`] for another number of axes, [`SignalError::Parameter`] for a value
    /// that is not finite and above 0.
    pub fn check(&self, n_axes: usize) -> Result<(), SignalError> {
        positive("ramp_s", self.ramp_s)?;
        one_per_axis(
            "max_effort_nm",
            self.max_effort_nm.as_deref(),
            n_axes,
            positive,
        )?;
        one_per_axis(
            "max_velocity_rad_s",
            self.max_velocity_rad_s.as_deref(),
            n_axes,
            positive,
        )?;
        one_per_axis(
            "max_travel_rad",
            self.max_travel_rad.as_deref(),
            n_axes,
            positive,
        )
    }

    /// The worst excess among the readings of a sample by comparison with its limit, and on which
    /// axis it is.
    fn excess(
        &self,
        start_rad: &[f64],
        record: &Record,
        sample: usize,
    ) -> Option<(usize, Reached)> {
        let position = record.position_rad.as_ref();
        let travel =
            |axis| position.map_or(0.0, |q| q[[axis, sample]] - q[[axis, 0]] + start_rad[axis]);
        let of_axis = |axis: usize| {
            let quantities = [
                ("effort_nm", record.u[[axis, sample]], &self.max_effort_nm),
                (
                    "velocity_rad_s",
                    record.y[[axis, sample]],
                    &self.max_velocity_rad_s,
                ),
                ("travel_rad", travel(axis), &self.max_travel_rad),
            ];
            quantities.map(|(quantity, value, limits)| {
                limits.as_ref().map(|limits| {
                    (
                        axis,
                        Reached {
                            quantity,
                            value,
                            limit: limits[axis],
                        },
                    )
                })
            })
        };
        let watched = (0..start_rad.len()).flat_map(of_axis).flatten();
        let beyond = watched.filter(|(_, reached)| reached.share() > 1.0 + ROUNDING);
        beyond.max_by(|(_, a), (_, b)| a.share().total_cmp(&b.share()))
    }
}

/// A limit that was reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reached {
    /// Which quantity, with unit.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// What is allowed.
    pub limit: f64,
}

impl Reached {
    /// The event of it on a channel.
    pub fn event(self, channel: usize, time_s: f64) -> Event {
        let Self {
            quantity,
            value,
            limit,
        } = self;
        Event {
            time_s,
            kind: EventKind::Limit {
                channel,
                quantity: quantity.into(),
                value,
                limit,
            },
        }
    }

    /// The value's magnitude over the limit.
    fn share(self) -> f64 {
        self.value.abs() / self.limit
    }
}

/// The first excess of a run.
struct Excess {
    sample: usize,
    axis: usize,
    reached: Reached,
    /// At which sample a reading was beyond all ramps.
    cut_off: Option<usize>,
}

/// The watch over one run.
pub(crate) struct Guard<'a> {
    watch: Option<&'a Watch>,
    run: &'a Run,
    /// Samples of the ramp.
    n_ramp: usize,
    excess: Option<Excess>,
}

impl<'a> Guard<'a> {
    /// Begins to watch a run.
    pub fn new(watch: Option<&'a Watch>, run: &'a Run) -> Self {
        let n_ramp = watch.map_or(1.0, |watch| {
            (watch.ramp_s / run.sample_time_s).ceil().max(1.0)
        }) as usize;
        Self {
            watch,
            run,
            n_ramp,
            excess: None,
        }
    }

    /// Share of the reference that is to be injected at a sample.
    pub fn share(&self, sample: usize) -> f64 {
        let Some(Excess { sample: first, .. }) = self.excess else {
            return 1.0;
        };
        let x = sample.saturating_sub(first) as f64 / self.n_ramp as f64;
        if x < 1.0 {
            0.5 * (1.0 + (PI * x).cos())
        } else {
            0.0
        }
    }

    /// Looks at the readings of a sample and logs the first excess.
    pub fn look(&mut self, record: &mut Record, sample: usize) {
        let Some((axis, reached)) = self
            .watch
            .and_then(|watch| watch.excess(&self.run.start_rad, record, sample))
        else {
            return;
        };
        let excess = self.excess.get_or_insert_with(|| {
            record
                .events
                .push(reached.event(axis, sample as f64 * self.run.sample_time_s));
            Excess {
                sample,
                axis,
                reached,
                cut_off: None,
            }
        });
        if reached.share() > CUT_OFF {
            excess.cut_off.get_or_insert(sample);
        }
    }

    /// Whether a sample is the last of the run.
    pub fn ends(&self, sample: usize) -> bool {
        self.excess.as_ref().is_some_and(|excess| {
            excess
                .cut_off
                .unwrap_or(excess.sample.saturating_add(self.n_ramp))
                <= sample
        })
    }

    /// The event that ends a run stopped with this sample, under controllers of these gains in N m
    /// s/rad (none in open loop).
    pub fn stopped(&self, last_sample: usize, gains: &[f64]) -> Option<Event> {
        let Excess {
            sample,
            axis,
            reached:
                Reached {
                    quantity,
                    value,
                    limit,
                },
            cut_off,
        } = self.excess.as_ref()?;
        let (word, unit) = match *quantity {
            "effort_nm" => ("effort", "N m"),
            "velocity_rad_s" => ("velocity", "rad/s"),
            _ => ("travel", "rad"),
        };
        let since_s = *sample as f64 * self.run.sample_time_s;
        let gain = gains
            .get(*axis)
            .map_or(String::new(), |gain| format!(", gain {gain} N m s/rad"));
        let end = match cut_off {
            None => "brought to rest",
            Some(_) => "cut off beyond twice a limit: lower the gains or the amplitude",
        };
        let (axis, limit) = (axis + 1, (1e4 * limit).round() / 1e4); // no digits that nobody asked for
        let reason = format!(
            "axis {axis}: {word} {value:.4} {unit}, limit {limit} {unit}, at {since_s:.4} s{gain}; {end}"
        );
        let time_s = last_sample as f64 * self.run.sample_time_s;
        Some(Event {
            time_s,
            kind: EventKind::Stopped {
                reason,
                since_s: Some(since_s),
            },
        })
    }
}
