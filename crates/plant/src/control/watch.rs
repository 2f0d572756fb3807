//! Watch over a run while it runs: the first excess brings it to rest, and its record ends there.

use std::f64::consts::PI;

use frfid_signals::checks::positive;
use frfid_signals::{Event, EventKind, Limit, Limits, Run, SignalError};

use crate::control::changes::Changes;
use crate::control::sensor::AxisSample;

/// Beyond this multiple of a limit no ramp helps: the run is cut off at once, as by an emergency
/// stop.
const CUT_OFF: f64 = 2.0;

/// What the readings of a run must not exceed, one value for each axis; whatever is `None` is not
/// watched.
///
/// At the first excess of any axis the excitation of all axes is brought smoothly to zero within
/// `ramp_s`, by the factor (1 + cos(pi t / ramp_s)) / 2: in closed loop the whole reference, the
/// constant velocity included, in open loop the torque besides what holds the robot. There the
/// record ends, or at once where a reading is beyond twice its limit (an unstable loop does not
/// care for its reference).
#[derive(Debug, Clone, PartialEq)]
pub struct Watch {
    /// What is held against them: the readings of torque, velocity and travel, the way from the pose
    /// by which the position reading has changed since the start of the run; and, because noise is
    /// all that the slopes of readings show, the rate of the torque that acts and acceleration and
    /// jerk of the true motion, from the steady motion before the run to the one after it. Limits of
    /// positions may be given and are not watched.
    pub limits: Limits,
    /// Time in s from the excess to rest.
    pub ramp_s: f64,
}

impl Watch {
    /// Checks every limit for a robot of `n_axes`.
    ///
    /// # Errors
    /// [`SignalError`] for limits that do not fit, or a ramp that is not finite and above 0.
    pub fn check(&self, n_axes: usize) -> Result<(), SignalError> {
        positive("ramp_s", self.ramp_s)?;
        self.limits.check(n_axes)
    }

    /// The worst excess among the readings of a sample by comparison with its limit, and on which
    /// axis it is, of a run whose first position readings in rad are given.
    fn excess(&self, run: &Run, first_rad: &[f64], moment: Moment) -> Option<(usize, Reached)> {
        let beyond = |axis: usize, limit: Limit, allowed: f64| {
            let way_rad = moment.axes[axis].position_rad - first_rad[axis] + run.start_rad[axis];
            let value = moment.of(limit, axis, way_rad)?;
            let reached = Reached {
                limit,
                value,
                allowed,
            };
            let exceeded = limit.is_exceeded(value.abs(), allowed);
            exceeded.then_some((axis, reached))
        };
        let of_axis = |axis: usize| {
            let limits = self.limits.iter();
            limits.filter_map(move |(limit, allowed)| beyond(axis, limit, allowed[axis]))
        };
        let excesses = (0..run.start_rad.len()).flat_map(of_axis);
        excesses.max_by(|(_, a), (_, b)| a.share().total_cmp(&b.share()))
    }
}

/// What is known at a sample.
#[derive(Clone, Copy)]
pub(crate) struct Moment<'a> {
    pub(crate) sample: usize,
    pub(crate) axes: &'a [AxisSample],
    pub(crate) changes: &'a Changes,
}

impl Moment<'_> {
    /// The value of an axis `way_rad` from the pose that is held against a limit; `None` where there
    /// is none.
    fn of(self, limit: Limit, axis: usize, way_rad: f64) -> Option<f64> {
        match limit {
            Limit::Torque => Some(self.axes[axis].torque_nm),
            Limit::Velocity => Some(self.axes[axis].velocity_rad_s),
            Limit::Travel => Some(way_rad),
            Limit::TorqueRate | Limit::Acceleration | Limit::Jerk => self.changes.now(limit, axis),
            Limit::LowestPosition | Limit::HighestPosition => None,
        }
    }
}

/// A limit that was reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// Which limit.
    pub limit: Limit,
    /// The value.
    pub value: f64,
    /// What is allowed.
    pub allowed: f64,
}

impl Reached {
    /// The event of it on a channel.
    pub(crate) fn event(self, channel: usize, time_s: f64) -> Event {
        let Self {
            limit,
            value,
            allowed,
        } = self;
        let kind = EventKind::Limit {
            channel,
            limit,
            value,
            allowed,
        };
        Event { time_s, kind }
    }

    /// The value's magnitude over the limit.
    fn share(self) -> f64 {
        self.value.abs() / self.allowed
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

impl Excess {
    /// Why the run was stopped, for an excess at a time in s under a controller of a gain in N m
    /// s/rad.
    fn reason(&self, since_s: f64, gain: Option<&f64>) -> String {
        let Reached {
            limit,
            value,
            allowed,
        } = self.reached;
        let (axis, quantity, unit) = (self.axis + 1, limit.quantity(), limit.unit());
        let gain = gain.map_or(String::new(), |gain| format!(", gain {gain} N m s/rad"));
        let end = match self.cut_off {
            None => "brought to rest",
            Some(_) => "cut off beyond twice a limit: lower the gains or the amplitude",
        };
        let allowed = (1e4 * allowed).round() / 1e4; // as it was given, without the digits of rounding
        format!(
            "axis {axis}: {quantity} {value:.4} {unit}, limit {allowed} {unit}, at {since_s:.4} s{gain}; {end}"
        )
    }
}

/// The watch over one run.
pub(crate) struct Guard<'a> {
    watch: Option<&'a Watch>,
    run: &'a Run,
    /// Samples of the ramp.
    n_ramp: usize,
    /// Position readings in rad at the first sample.
    first_rad: Vec<f64>,
    excess: Option<Excess>,
}

impl<'a> Guard<'a> {
    /// Begins to watch a run.
    pub(crate) fn new(watch: Option<&'a Watch>, run: &'a Run) -> Self {
        let n_ramp = watch.map_or(1.0, |watch| {
            (watch.ramp_s / run.sample_time_s).ceil().max(1.0)
        }) as usize;
        Self {
            watch,
            run,
            n_ramp,
            first_rad: Vec::new(),
            excess: None,
        }
    }

    /// Share of the reference that is to be injected at a sample.
    pub(crate) fn share(&self, sample: usize) -> f64 {
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

    /// Looks at a sample; returns the event of the first excess.
    pub(crate) fn look(&mut self, moment: Moment) -> Option<Event> {
        let watch = self.watch?;
        if self.first_rad.is_empty() {
            let first = moment.axes.iter().map(|axis| axis.position_rad);
            self.first_rad.extend(first);
        }
        let (axis, reached) = watch.excess(self.run, &self.first_rad, moment)?;
        let sample = moment.sample;
        let first = self.excess.is_none();
        let excess = self.excess.get_or_insert(Excess {
            sample,
            axis,
            reached,
            cut_off: None,
        });
        if reached.share() > CUT_OFF {
            excess.cut_off.get_or_insert(sample);
        }
        first.then(|| reached.event(axis, sample as f64 * self.run.sample_time_s))
    }

    /// Whether a sample is the last of the run.
    pub(crate) fn ends(&self, sample: usize) -> bool {
        self.excess.as_ref().is_some_and(|excess| {
            excess
                .cut_off
                .unwrap_or(excess.sample.saturating_add(self.n_ramp))
                <= sample
        })
    }

    /// The event that ends a run stopped with this sample, under controllers of these gains in N m
    /// s/rad (none in open loop).
    pub(crate) fn stopped(&self, last_sample: usize, gains: &[f64]) -> Option<Event> {
        let excess = self.excess.as_ref()?;
        let since_s = excess.sample as f64 * self.run.sample_time_s;
        let reason = excess.reason(since_s, gains.get(excess.axis));
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
