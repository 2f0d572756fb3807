//! Playback of a run: its reference as a machine can play it, from rest to rest, position, velocity
//! and acceleration of one motion, at the player's rate and inside the limits.

mod blend;
mod oscillation;
mod series;
#[cfg(test)]
mod tests;

use ndarray::Array2;

use crate::error::SignalError;
use crate::excitation::Injection;
use crate::limit::Limit;
use crate::limits::{Excess, Limits};
use crate::number::checks::{
    LONGEST_SIGNAL, at_most, finite, not_negative, positive, require_shape,
};
use crate::number::format::significant;
use crate::peaks::{Peaks, largest_by_axis, steepest_by_axis};
use crate::plan::Plan;
use crate::plan::run::{Run, RunId};
use crate::playback::blend::Blend;
use crate::playback::oscillation::Oscillation;

/// How a machine plays.
#[derive(Debug, Clone, PartialEq)]
pub struct Player {
    /// Samples a second, which may differ from the plan's.
    pub rate_hz: f64,
    /// Rest at the pose before and after every run in s.
    pub rest_s: f64,
    /// Where the machine rests, in rad, one for each channel.
    pub pose_rad: Vec<f64>,
    /// What no sample of a playback may exceed.
    pub limits: Limits,
}

/// A run from rest to rest: a rest at the pose, a move to its start, a ramp into its motion, lead-in
/// and periods as planned, a ramp out, the move back, a rest.
///
/// With `V` the constant velocity, `r` the reference and `q` the integral of `r - V` from the run's first
/// sample, both continued before it and after its end, the motion is
///
/// ```text
/// p(t) = pose + start + V integral(w) + w(t) q(t),   v = p',  a = p'',  j = p'''
/// ```
///
/// w rises from 0 to 1 before the run and falls after it, so that `p' = r` from the run's first sample to
/// its last. `r` is the Fourier series through its samples (with rest before and after where it has
/// ramps or fades of its own), so that every derivative and the integral are exact line by line, at
/// any rate. A torque, `tau(t) = w(t) r(t)`, has ramps only.
#[derive(Debug, Clone, PartialEq)]
pub struct Playback {
    /// Which run of the plan it is.
    pub id: RunId,
    /// The player's sample time in s.
    pub sample_time_s: f64,
    /// Sample at which the run's own first sample is played.
    pub first_sample: usize,
    /// Samples of the run itself, lead-in and periods.
    pub run_samples: usize,
    /// What is played.
    pub played: Played,
}

/// What a machine is given, `(channel, sample)`.
#[derive(Debug, Clone, PartialEq)]
pub enum Played {
    /// A motion, in closed loop.
    Motion(Motion),
    /// Motor torques in N m, in open loop.
    Torque(Array2<f64>),
}

/// A motion with its derivatives, `(channel, sample)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Position in rad, as the joint counts it.
    pub position_rad: Array2<f64>,
    /// Velocity in rad/s.
    pub velocity_rad_s: Array2<f64>,
    /// Acceleration in rad/s^2.
    pub acceleration_rad_s2: Array2<f64>,
    /// Jerk in rad/s^3.
    pub jerk_rad_s3: Array2<f64>,
}

impl Player {
    /// Checks rate, rest, pose and limits, for so many channels.
    ///
    /// # Errors
    /// [`SignalError`] naming the first that does not fit.
    pub fn check(&self, n_channels: usize) -> Result<(), SignalError> {
        positive("rate_hz", self.rate_hz)?;
        not_negative("rest_s", self.rest_s)?;
        let found = self.pose_rad.len();
        let needed = format_args!("one position for each of the {n_channels} channels");
        require_shape("pose_rad", &[found], found == n_channels, needed)?;
        self.pose_rad
            .iter()
            .try_for_each(|pose| finite("pose_rad", *pose))?;
        self.limits.check(n_channels)
    }
}

impl Plan {
    /// A run of this plan as a machine plays it. The ramps are the shortest of 0.5 to 8 s that keep the
    /// limits; where none does, the longest, and [`Playback::excesses`] says what it exceeds.
    ///
    /// # Errors
    /// [`SignalError`] for a player that does not fit, a rate too low for the band (less than 2.5
    /// samples in the shortest period), a run of another length than the plan's, and a constant
    /// velocity beneath torques, which no player can hold.
    pub fn playback(&self, run: &Run, player: &Player) -> Result<Playback, SignalError> {
        player.check(self.n_inputs)?;
        self.check_rate(player.rate_hz)?;
        self.check_run(run, player)?;
        let oscillation = Oscillation::of(self, run, player.rate_hz);
        let blend = Blend::of(self, run, player, &oscillation);
        Ok(Playback {
            id: run.id,
            sample_time_s: 1.0 / player.rate_hz,
            first_sample: blend.first_sample(),
            run_samples: oscillation.n_run,
            played: match self.injection {
                Injection::Velocity => Played::Motion(blend.motion()),
                Injection::Torque => Played::Torque(blend.torque()),
            },
        })
    }

    fn check_rate(&self, rate_hz: f64) -> Result<(), SignalError> {
        let high_hz = self.excitation.waveform().band_hz()[1];
        let least_hz = 2.5 * high_hz;
        if rate_hz >= least_hz {
            return Ok(());
        }
        Err(too_slow(rate_hz, least_hz, high_hz))
    }

    fn check_run(&self, run: &Run, player: &Player) -> Result<(), SignalError> {
        let shape = [self.n_inputs, self.run_samples()?];
        let needed = format_args!("{shape:?}, as the plan's runs");
        let found = run.reference.shape();
        require_shape("reference", found, found == shape, needed)?;
        let run_s = shape[1] as f64 * self.sample_time_s;
        let samples = (run_s + 100.0 + 2.0 * player.rest_s) * player.rate_hz;
        let needed = "at most 2^26: a lower rate or shorter runs";
        at_most(
            "rate_hz",
            "samples of a playback",
            samples,
            LONGEST_SIGNAL,
            needed,
        )?;
        let glides = run.velocity_rad_s.iter().any(|velocity| *velocity != 0.0);
        if self.injection == Injection::Torque && glides {
            let what = "a constant velocity beneath torques, which a player cannot hold; needed: a \
                        velocity loop, [controller], or no constant velocity";
            return Err(SignalError::unfit("velocity_rad_s", what));
        }
        Ok(())
    }
}

fn too_slow(rate_hz: f64, least_hz: f64, high_hz: f64) -> SignalError {
    let [least, high] = [least_hz, high_hz].map(|hz| significant(hz, 4));
    let what = format!(
        "rate_hz is {rate_hz}, needed: at least {least} for a band up to {high} Hz; play faster or lower high_hz"
    );
    SignalError::unfit("rate_hz", what)
}

impl Playback {
    /// Samples from rest to rest.
    #[must_use]
    pub fn n_samples(&self) -> usize {
        match &self.played {
            Played::Motion(motion) => motion.velocity_rad_s.ncols(),
            Played::Torque(torque) => torque.ncols(),
        }
    }

    /// The largest values of every sample, about the pose.
    #[must_use]
    pub fn peaks(&self, pose_rad: &[f64]) -> Peaks {
        match &self.played {
            Played::Motion(motion) => motion.peaks(pose_rad),
            Played::Torque(torque) => {
                let rate = steepest_by_axis(torque, self.sample_time_s);
                let torque = largest_by_axis(torque);
                [(Limit::Torque, torque), (Limit::TorqueRate, rate)]
                    .into_iter()
                    .collect()
            }
        }
    }

    /// Every limit of the player that a sample exceeds.
    #[must_use]
    pub fn excesses(&self, player: &Player) -> Vec<Excess> {
        player.limits.exceeded(&self.peaks(&player.pose_rad))
    }
}

impl Motion {
    fn peaks(&self, pose_rad: &[f64]) -> Peaks {
        let rows = || self.position_rad.rows().into_iter().zip(pose_rad);
        let extreme = |of: fn(f64, f64) -> f64| -> Vec<f64> {
            rows()
                .map(|(row, pose)| row.iter().fold(*pose, |a, b| of(a, *b)))
                .collect()
        };
        let travel = |(row, pose): (ndarray::ArrayView1<f64>, &f64)| {
            row.iter()
                .fold(0.0, |way: f64, p| way.max((p - pose).abs()))
        };
        [
            (Limit::Velocity, largest_by_axis(&self.velocity_rad_s)),
            (
                Limit::Acceleration,
                largest_by_axis(&self.acceleration_rad_s2),
            ),
            (Limit::Jerk, largest_by_axis(&self.jerk_rad_s3)),
            (Limit::Travel, rows().map(travel).collect()),
            (Limit::LowestPosition, extreme(f64::min)),
            (Limit::HighestPosition, extreme(f64::max)),
        ]
        .into_iter()
        .collect()
    }
}
