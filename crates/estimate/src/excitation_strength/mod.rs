//! Strength of an excitation: torque per axis and band, time stuck, slowest velocity (SK15 footnote
//! 2: the rms of the motor torque must be well above the Coulomb friction F_c, or friction hides
//! resonances).

mod bands;
pub(crate) mod pooling;
pub(crate) mod stuck;
#[cfg(test)]
mod tests;
pub(crate) mod warnings;

use std::ops::Range;

use frfid_signals::power::{about_mean, rms};
use frfid_signals::{Plan, Record, SignalError, checks::require_shape};
use ndarray::{ArrayView1, s};
use serde::Serialize;

use crate::error::EstimateError;
use crate::excitation_strength::bands::{line_bands, passages, swept_bands};
use crate::excitation_strength::stuck::Readings;

/// How one axis moved and was driven while the excitation lasted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AxisStrength {
    /// Rms of the motor torque about its mean, in N m.
    pub rms_nm: f64,
    /// The same over the Coulomb friction; `None` where that is not known or 0.
    pub rms_over_coulomb: Option<f64>,
    /// Share of the samples in which the motor was stuck; `None` where the readings cannot tell.
    pub stuck_share: Option<f64>,
    /// Smallest |measured velocity| in rad/s.
    pub slowest_rad_s: f64,
    /// Whether the measured velocity ever is 0 or has the other sign than the constant velocity of
    /// the run, so that friction holds or jumps; `None` without constant velocity.
    pub crosses_zero: Option<bool>,
    /// The same by frequency; bands in which the excitation has nothing are left out.
    pub bands: Vec<BandStrength>,
}

/// How one axis was driven in a band.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BandStrength {
    /// Lower edge in Hz; a line there belongs to the band.
    pub low_hz: f64,
    /// Upper edge in Hz; a line there belongs to the next band.
    pub high_hz: f64,
    /// Rms of the torque in N m: of a chirp while it passes the band, about the mean of that time;
    /// of a multisine the power of its lines in the band, `sum 2|U|^2/N^2` (Parseval).
    pub rms_nm: f64,
    /// The same over the Coulomb friction; `None` where that is not known or 0.
    pub rms_over_coulomb: Option<f64>,
    /// Share of the samples in which the motor was stuck while a chirp passed the band; `None` for
    /// a multisine, which is in all bands at once, and where the readings cannot tell.
    pub stuck_share: Option<f64>,
}

/// [`AxisStrength`] of every axis in the record of a run of `plan`, by `bands_hz` (each low, high).
///
/// A sample counts as stuck when the position reading is that of the sample before, or the velocity
/// reading is 0. Whether an axis sticks is not known where noise keeps the readings from repeating
/// (unless the velocity is clearly away from 0 all the time), and where an encoder too coarse for the
/// motion makes them repeat. The turning points of a free motion take a sample now and then.
///
/// # Errors
/// [`frfid_signals::SignalError`] for a record or plan that does not hold together, and for a record
/// that ends before the first whole period of a multisine, or before the chirp begins.
pub fn strength(
    record: &Record,
    plan: &Plan,
    bands_hz: &[[f64; 2]],
) -> Result<Vec<AxisStrength>, EstimateError> {
    let run = Run::of(record, plan)?;
    let bands = match passages(plan, &run.window, bands_hz) {
        Some(passages) => swept_bands(record, &run.readings, &passages),
        None => line_bands(record, &run.window, plan, bands_hz)?,
    };
    let axes = bands.into_iter().enumerate();
    Ok(axes.map(|(axis, bands)| run.axis(axis, bands)).collect())
}

/// A run that is sound.
struct Run<'a> {
    record: &'a Record,
    plan: &'a Plan,
    /// Samples of the excitation.
    window: Range<usize>,
    /// Of every axis.
    readings: Vec<Readings>,
}

impl<'a> Run<'a> {
    fn of(record: &'a Record, plan: &'a Plan) -> Result<Self, EstimateError> {
        record.check()?;
        plan.check()?;
        let window = window(record, plan)?;
        check_axes(record, plan.n_inputs)?;
        let readings = (0..plan.n_inputs).map(|axis| Readings::of(record, axis));
        Ok(Self {
            record,
            plan,
            window,
            readings: readings.collect(),
        })
    }

    /// The strength of one axis, of which the bands are known.
    fn axis(&self, axis: usize, bands: Vec<BandStrength>) -> AxisStrength {
        let velocity = self.record.y.slice(s![axis, self.window.clone()]);
        AxisStrength {
            rms_nm: rms_about_mean(self.record.u.slice(s![axis, self.window.clone()])),
            rms_over_coulomb: None,
            stuck_share: self.readings[axis].stuck_share(self.window.clone()),
            slowest_rad_s: slowest(velocity),
            crosses_zero: crosses_zero(velocity, self.plan.velocity_rad_s[axis]),
            bands,
        }
    }
}

impl BandStrength {
    /// Of an axis of which the Coulomb friction is not known.
    fn new([low_hz, high_hz]: [f64; 2], rms_nm: f64, stuck_share: Option<f64>) -> Self {
        Self {
            low_hz,
            high_hz,
            rms_nm,
            rms_over_coulomb: None,
            stuck_share,
        }
    }
}

/// Refuses a record that has not a channel for each input of the plan.
fn check_axes(record: &Record, n_axes: usize) -> Result<(), SignalError> {
    for (name, signal) in [("u", &record.u), ("y", &record.y)] {
        let needed = format_args!("({n_axes}, sample), a channel for each input of the plan");
        require_shape(name, signal.shape(), signal.nrows() == n_axes, needed)?;
    }
    Ok(())
}

/// Samples of the excitation: its whole periods, or what is there of an excitation that is done once
/// without its rest.
fn window(record: &Record, plan: &Plan) -> Result<Range<usize>, EstimateError> {
    let (start, period) = (plan.lead_in_samples, plan.period_samples()?);
    let there = record.n_samples().saturating_sub(start);
    let is_periodic = plan.excitation.waveform().is_periodic();
    let (samples, least) = match is_periodic {
        true => ((there / period).min(plan.n_periods) * period, period),
        false => (there.min(excited_samples(plan)), 2),
    };
    let needed = start + least;
    let needed = format_args!("(channel, {needed} or more samples), lead-in and excitation");
    require_shape("u", record.u.shape(), samples >= least, needed)?;
    Ok(start..start + samples)
}

/// Length of an excitation that is done once, without its rest.
fn excited_samples(plan: &Plan) -> usize {
    let excited_s = plan.excitation.waveform().excited_s(plan.sample_time_s);
    (excited_s / plan.sample_time_s).floor() as usize
}

fn rms_about_mean(signal: ArrayView1<f64>) -> f64 {
    rms(&about_mean(signal))
}

/// Smallest size of a velocity.
fn slowest(velocity: ArrayView1<f64>) -> f64 {
    velocity
        .iter()
        .fold(f64::INFINITY, |slowest, y| slowest.min(y.abs()))
}

/// Whether a velocity ever is 0 or has the other sign than the constant velocity `gliding`; `None`
/// without one.
fn crosses_zero(velocity: ArrayView1<f64>, gliding: f64) -> Option<bool> {
    (gliding != 0.0).then(|| velocity.iter().any(|y| y * gliding <= 0.0))
}
