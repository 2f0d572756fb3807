//! Options of a shaping: target, step, band, limits and when it is good enough.

use frfid_signals::checks::{self, require};
use frfid_signals::{Limits, Record, SignalError};
use ndarray::Array2;

use crate::excitation_strength::warnings::MOST_STUCK;

/// The measured signal that is to follow the desired one; any with an invertible path from r.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Target {
    /// The plant input u, motor torque in N m.
    #[default]
    Torque,
    /// The plant output y, motor velocity in rad/s.
    Velocity,
}

impl Target {
    /// Its name among the signals of a record.
    pub(super) fn channel(self) -> &'static str {
        match self {
            Self::Torque => "u",
            Self::Velocity => "y",
        }
    }

    /// Its signal in a record.
    pub(super) fn signal(self, record: &Record) -> &Array2<f64> {
        match self {
            Self::Torque => &record.u,
            Self::Velocity => &record.y,
        }
    }
}

/// How the next reference follows from the last one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// The paper's fixed point (18), `R_{i+1} = G_i^-1 U_des` with `G_i = U_i R_i^-1` line by line.
    Paper,
    /// `R_{i+1} = R_i + damping G_i^-1 (U_des - U_i)`, `G_i = S_ur S_rr^-1` with the products of
    /// `smoothing_bins` neighbouring lines summed.
    Damped {
        /// Share of the missing signal that is made up for in one step. With the adaptive damping
        /// 0.9 is fast and safe, without it 0.5 to 0.7 is as much as friction allows.
        damping: f64,
        /// Lines over which G is smoothed; a few tens.
        smoothing_bins: usize,
        /// Whether the damping is halved at lines and channels where an iteration made the error
        /// larger, and the iteration taken back if it made the whole error larger.
        adaptive: bool,
    },
}

impl Default for Step {
    fn default() -> Self {
        Self::Damped {
            damping: 0.9,
            smoothing_bins: 30,
            adaptive: true,
        }
    }
}

/// What to shape towards and how carefully.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeOptions {
    /// Which signal is to follow the desired one.
    pub target: Target,
    /// How the next reference is made.
    pub step: Step,
    /// Lowest frequency of the band that is shaped, in Hz.
    pub low_hz: f64,
    /// Highest frequency of the band that is shaped, in Hz.
    pub high_hz: f64,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Most iterations, the first with the initial reference included.
    pub n_iterations: usize,
    /// Relative error, rms over the band, at which it is good enough, on every channel.
    pub good_enough: f64,
    /// Largest growth of a reference's peak from one iteration to the next, as a factor.
    pub largest_change: f64,
    /// What must never be exceeded: limits of torque, velocity and travel.
    pub limits: Limits,
    /// Factor above 1 by which a quantity may change more than predicted without exceeding its
    /// limit, as long as nothing is known of how good the predictions are; later it follows what is
    /// observed. Friction makes a machine move less than in proportion at first and more later.
    pub margin: f64,
    /// Largest share of the sweep that an axis may be stuck.
    pub max_stuck_share: f64,
    /// Velocity reading in rad/s up to which an axis counts as stuck, besides a position reading
    /// that does not change; 0 for sensors without noise.
    pub still_rad_s: f64,
    /// Coulomb friction per axis in N m, where it is known: named beside the torque of an axis that
    /// sticks.
    pub coulomb_nm: Option<Vec<f64>>,
}

impl Default for ShapeOptions {
    fn default() -> Self {
        Self {
            target: Target::default(),
            step: Step::default(),
            low_hz: 2.0,
            high_hz: 60.0,
            sample_time_s: 1e-3,
            n_iterations: 6,
            good_enough: 0.05,
            largest_change: 3.0,
            limits: Limits::default(),
            margin: 2.0,
            max_stuck_share: MOST_STUCK,
            still_rad_s: 0.0,
            coulomb_nm: None,
        }
    }
}

impl ShapeOptions {
    /// Checks every value for `n_axes` axes.
    ///
    /// # Errors
    /// [`SignalError`] naming the first value out of range.
    pub fn check(&self, n_axes: usize) -> Result<(), SignalError> {
        for (key, value) in [
            ("low_hz", self.low_hz),
            ("sample_time_s", self.sample_time_s),
            ("n_iterations", self.n_iterations as f64),
            ("good_enough", self.good_enough),
            ("max_stuck_share", self.max_stuck_share),
        ] {
            checks::positive(key, value)?;
        }
        checks::not_negative("still_rad_s", self.still_rad_s)?;
        self.check_band()?;
        self.check_factors()?;
        self.step.check()?;
        let coulomb_nm = self.coulomb_nm.as_deref();
        checks::one_per_axis("coulomb_nm", coulomb_nm, n_axes, checks::not_negative)?;
        self.limits.check(n_axes)
    }

    fn check_band(&self) -> Result<(), SignalError> {
        checks::below_nyquist(self.high_hz, self.sample_time_s)?;
        let is_band = self.high_hz > self.low_hz;
        require("high_hz", self.high_hz, is_band, "a frequency above low_hz")
    }

    fn check_factors(&self) -> Result<(), SignalError> {
        let (change, margin) = (self.largest_change, self.margin);
        let needed = "a finite factor above 1";
        require("largest_change", change, change > 1.0, needed)?;
        let needed = "a finite factor, 1 or above";
        require("margin", margin, margin >= 1.0, needed)
    }
}

impl Step {
    /// Lines over which the response is smoothed.
    pub(super) fn smoothing_bins(&self) -> usize {
        match *self {
            Self::Paper => 1,
            Self::Damped { smoothing_bins, .. } => smoothing_bins,
        }
    }

    /// Share of the missing signal that the first step makes up for.
    pub(super) fn damping(&self) -> f64 {
        match *self {
            Self::Paper => 1.0,
            Self::Damped { damping, .. } => damping,
        }
    }

    fn check(&self) -> Result<(), SignalError> {
        let Self::Damped {
            damping,
            smoothing_bins,
            ..
        } = *self
        else {
            return Ok(());
        };
        let is_share = damping > 0.0 && damping <= 1.0;
        require("damping", damping, is_share, "above 0 and at most 1")?;
        let bins = smoothing_bins as f64;
        require("smoothing_bins", bins, smoothing_bins > 0, "at least 1")
    }
}
