//! Was the excitation strong enough? Torque per axis and band, time stuck, slowest velocity (SK15
//! footnote 2: the rms of the motor torque must be well above the Coulomb friction F_c, or friction
//! hides resonances).

#[cfg(test)]
mod tests;
pub(crate) mod warnings;

use std::iter::zip;
use std::ops::Range;

use frfid_signals::power::{mean_power, rms};
use frfid_signals::{Plan, Record, SignalError};
use ndarray::{Array2, ArrayView1, s};
use serde::Serialize;

use crate::error::EstimateError;
use crate::spectra::Evaluation;

/// How one axis moved and was driven while the excitation lasted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AxisStrength {
    /// Rms of the motor torque about its mean, in N m.
    pub rms_nm: f64,
    /// The same over the Coulomb friction; `None` where that is not known or 0.
    pub rms_over_coulomb: Option<f64>,
    /// Share of the samples in which the motor was stuck.
    pub stuck_share: f64,
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
    /// a multisine, which is in all bands at once.
    pub stuck_share: Option<f64>,
}

/// [`AxisStrength`] of every axis in the record of a run of `plan`, by `bands_hz` (each low, high).
///
/// A sample counts as stuck when the position reading is that of the sample before, or the velocity
/// reading is 0. Limits of that: an encoder too coarse for the motion reads as stuck what moves by
/// less than an increment per sample, noise on position and velocity hides what is stuck, and the
/// turning points of a free motion take a sample now and then.
///
/// # Errors
/// [`SignalError`] for a record or plan that does not hold together; [`SignalError::Shape`] for a
/// record that ends before the first whole period of a multisine, or before the chirp begins.
pub fn strength(
    record: &Record,
    plan: &Plan,
    bands_hz: &[[f64; 2]],
) -> Result<Vec<AxisStrength>, EstimateError> {
    record.check()?;
    plan.check()?;
    let window = window(record, plan)?;
    let (stuck, n_axes) = (stuck_samples(record, 0.0), plan.n_inputs);
    for (name, signal) in [("u", &record.u), ("y", &record.y)] {
        if signal.nrows() != n_axes {
            let needed = format!("({n_axes}, sample), a channel for each input of the plan");
            return Err(SignalError::Shape {
                name,
                found: signal.shape().to_vec(),
                needed,
            }
            .into());
        }
    }
    let bands = match passages(plan, &window, bands_hz) {
        Some(passages) => swept_bands(record, &stuck, &passages),
        None => line_bands(record, &window, plan, bands_hz)?,
    };
    let axis = |(axis, bands): (usize, Vec<BandStrength>)| {
        let (velocity, gliding) = (
            record.y.slice(s![axis, window.clone()]),
            plan.velocity_rad_s[axis],
        );
        AxisStrength {
            rms_nm: rms_about_mean(record.u.slice(s![axis, window.clone()])),
            rms_over_coulomb: None,
            stuck_share: share(stuck.slice(s![axis, window.clone()])),
            slowest_rad_s: velocity
                .iter()
                .fold(f64::INFINITY, |slowest, y| slowest.min(y.abs())),
            crosses_zero: (gliding != 0.0).then(|| velocity.iter().any(|y| y * gliding <= 0.0)),
            bands,
        }
    };
    Ok(bands.into_iter().enumerate().map(axis).collect())
}

/// Samples of the excitation: its whole periods, or what is there of an excitation that is done once
/// without its rest.
fn window(record: &Record, plan: &Plan) -> Result<Range<usize>, EstimateError> {
    let (start, period) = (plan.lead_in_samples, plan.period_samples()?);
    let there = record.n_samples().saturating_sub(start);
    let waveform = plan.excitation.waveform();
    let (samples, least) = if waveform.is_periodic() {
        ((there / period).min(plan.n_periods) * period, period)
    } else {
        let excited_s = waveform.excited_s(plan.sample_time_s);
        (
            there.min((excited_s / plan.sample_time_s).floor() as usize),
            2,
        )
    };
    if samples < least {
        let needed = format!(
            "(channel, {} or more samples), lead-in and excitation",
            start + least
        );
        return Err(SignalError::Shape {
            name: "u",
            found: record.u.shape().to_vec(),
            needed,
        }
        .into());
    }
    Ok(start..start + samples)
}

/// Samples in which the position reading does not change, or the velocity reading is at most
/// `still_rad_s`, `(axis, sample)`.
pub(crate) fn stuck_samples(record: &Record, still_rad_s: f64) -> Array2<bool> {
    let mut stuck = record.y.mapv(|y| y.abs() <= still_rad_s);
    for (mut stuck, position) in zip(
        stuck.rows_mut(),
        record
            .position_rad
            .iter()
            .flat_map(|position| position.rows()),
    ) {
        for k in 1..position.len() {
            stuck[k] |= position[k] == position[k - 1];
        }
    }
    stuck
}

fn share(stuck: ArrayView1<bool>) -> f64 {
    stuck.iter().filter(|&&stuck| stuck).count() as f64 / stuck.len().max(1) as f64
}

fn rms_about_mean(signal: ArrayView1<f64>) -> f64 {
    let mean = signal.sum() / signal.len().max(1) as f64;
    rms(&signal.mapv(|value| value - mean).to_vec())
}

/// A band in Hz and the samples in which the excitation passes it.
type Passage = ([f64; 2], Range<usize>);

/// When the excitation passes the bands; `None` where it is in all of them all the time.
fn passages(plan: &Plan, window: &Range<usize>, bands_hz: &[[f64; 2]]) -> Option<Vec<Passage>> {
    let passage = |&band_hz: &[f64; 2]| {
        let waveform = plan.excitation.waveform();
        let [from, to] = waveform
            .seconds_in(band_hz, plan.sample_time_s)?
            .map(|time_s| {
                let sample = (time_s / plan.sample_time_s).round() as usize;
                (plan.lead_in_samples + sample).min(window.end)
            });
        Some((band_hz, from..to))
    };
    bands_hz.iter().map(passage).collect()
}

/// Bands of every axis from the time in which the excitation passes them.
fn swept_bands(
    record: &Record,
    stuck: &Array2<bool>,
    passages: &[Passage],
) -> Vec<Vec<BandStrength>> {
    let band = |axis: usize, &([low_hz, high_hz], ref time): &Passage| BandStrength {
        low_hz,
        high_hz,
        rms_nm: rms_about_mean(record.u.slice(s![axis, time.clone()])),
        rms_over_coulomb: None,
        stuck_share: Some(share(stuck.slice(s![axis, time.clone()]))),
    };
    let passed = || passages.iter().filter(|(_, time)| time.len() > 1);
    (0..record.u.nrows())
        .map(|axis| passed().map(|time| band(axis, time)).collect())
        .collect()
}

/// Bands of every axis from the excited lines, averaged over the periods.
fn line_bands(
    record: &Record,
    window: &Range<usize>,
    plan: &Plan,
    bands_hz: &[[f64; 2]],
) -> Result<Vec<Vec<BandStrength>>, EstimateError> {
    let period = plan.period_samples()?;
    let Evaluation {
        frequency_hz: hz,
        transform,
        ..
    } = Evaluation::of(plan, 2)?;
    let n_periods = window.len() / period;
    let mut power = Array2::<f64>::zeros((record.u.nrows(), hz.len()));
    for start in window.clone().step_by(period) {
        let spectra = transform.transform("u", record.u.slice(s![.., start..start + period]))?;
        power += &spectra
            .mapv(|value| 2.0 * value.norm_sqr() / (period as f64).powi(2) / n_periods as f64);
    }
    let band = |power: ArrayView1<f64>, &[low_hz, high_hz]: &[f64; 2]| {
        let inside = || zip(&hz, power).filter(|&(&hz, _)| (low_hz..high_hz).contains(&hz));
        let square: f64 = inside().map(|(_, power)| power).sum();
        inside().next().map(|_| BandStrength {
            low_hz,
            high_hz,
            rms_nm: square.sqrt(),
            rms_over_coulomb: None,
            stuck_share: None,
        })
    };
    Ok(power
        .rows()
        .into_iter()
        .map(|power| {
            bands_hz
                .iter()
                .filter_map(|edges| band(power, edges))
                .collect()
        })
        .collect())
}

/// The strength of several runs as one: mean power, mean stuck share, slowest of all, crossing if
/// any; `None` of none. The runs must be of one plan, with the same bands. Torques are put beside the
/// Coulomb friction in N m of every axis, where it is known.
#[must_use]
pub fn pooled_strength(
    runs: &[Vec<AxisStrength>],
    coulomb_nm: Option<&[f64]>,
) -> Option<Vec<AxisStrength>> {
    let mut pooled = runs.first()?.clone();
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / runs.len() as f64;
    let quadratic =
        |values: &mut dyn Iterator<Item = f64>| mean_power(&values.collect::<Vec<_>>()).sqrt();
    for (axis, pooled) in pooled.iter_mut().enumerate() {
        let all = || runs.iter().filter_map(|run| run.get(axis));
        pooled.rms_nm = quadratic(&mut all().map(|one| one.rms_nm));
        pooled.stuck_share = mean(&mut all().map(|one| one.stuck_share));
        pooled.slowest_rad_s =
            all().fold(f64::INFINITY, |slowest, one| slowest.min(one.slowest_rad_s));
        pooled.crosses_zero = pooled
            .crosses_zero
            .map(|_| all().any(|one| one.crosses_zero == Some(true)));
        for (place, band) in pooled.bands.iter_mut().enumerate() {
            let bands = || all().filter_map(|one| one.bands.get(place));
            band.rms_nm = quadratic(&mut bands().map(|band| band.rms_nm));
            band.stuck_share = band
                .stuck_share
                .map(|_| mean(&mut bands().filter_map(|band| band.stuck_share)));
        }
        let coulomb_nm = coulomb_nm
            .and_then(|all| all.get(axis))
            .filter(|nm| **nm > 0.0);
        pooled.rms_over_coulomb = coulomb_nm.map(|nm| pooled.rms_nm / nm);
        for band in &mut pooled.bands {
            band.rms_over_coulomb = coulomb_nm.map(|nm| band.rms_nm / nm);
        }
    }
    Some(pooled)
}
