//! Glide subtraction by motor position (SK15 section 4.4 E, where runs do not repeat the glide's
//! position).
//!
//! Torque ripple d depends on each motor's own position. An excitation makes the position wander
//! from that of the glide, and what [`subtract_glide`] takes off sample by sample then belongs to
//! another place. With `y = P (u - d(q))` in the run and `y_g = P (u_g - d(q_g))` in the glide (d:
//! everything that depends on position alone, so Coulomb friction too):
//!
//! ```text
//! y - y_g = P (u - u_g - [d(q) - d(q_g)]),    d(q_g(t)) = u_g - P^-1 y_g
//! ```
//!
//! So y keeps the subtraction in time, which is exact, and u loses a torque in addition. Only the
//! *difference* of d between two nearby places counts: P may be a first estimate, made after
//! subtraction in time, and its relative error enters multiplied by the wander in radians of the
//! ripple, some tenths; medians over neighbouring frequencies keep out the few on which the ripple
//! itself spoilt the first estimate. A second pass with the better P gains little more. (Looking up
//! u_g and y_g at the run's position needs no P but is wrong: P does not commute with a bent time
//! axis.)
//!
//! A straight line over position is taken off d: gravity's gradient belongs to P.

use std::f64::consts::TAU;

use frfid_signals::checks::{require, require_shape};
use frfid_signals::{Frf, Record};
use frfid_transforms::TransformPlanner;
use ndarray::{Array2, ArrayView1, Zip, s};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::glide::apparent_inertia::ApparentInertia;
use crate::glide::in_time::{glide_velocity, subtract_glide};
use crate::glide::torque_table::TorqueTable;

/// The torque ripple of every axis over its motor position, as a glide showed it; made once, taken
/// off every run.
#[derive(Debug, Clone, PartialEq)]
pub struct RippleTorque {
    glide: Record,
    /// None for an axis that stood still in the glide.
    axes: Vec<Option<TorqueTable>>,
}

impl RippleTorque {
    /// Ripple from a glide (or the mean of several) and a first estimate of the plant, torque to
    /// velocity, square; ripple above the highest frequency of the plant is left alone.
    ///
    /// # Errors
    /// [`EstimateError::NoPosition`], [`EstimateError::NotMonotone`] where a gliding axis turns
    /// back, [`EstimateError::SingularPlant`], [`frfid_signals::SignalError::Shape`] if glide and
    /// plant have other channels.
    pub fn of_glide(glide: &Record, plant: &Frf) -> Result<Self, EstimateError> {
        glide.check()?;
        let position = position_of(glide, "glide")?;
        let torque = torque_over_time(glide, plant)?;
        let table = |axis: usize| {
            let direction = glide_velocity(glide.y.row(axis));
            direction.map(|velocity| {
                TorqueTable::new(
                    axis,
                    velocity.signum(),
                    position.row(axis),
                    torque.row(axis),
                )
            })
        };
        let axes = (0..position.nrows())
            .map(|axis| table(axis).transpose())
            .collect::<Result<_, _>>()?;
        Ok(Self {
            glide: glide.clone(),
            axes,
        })
    }

    /// Variance in s^2 of the time by which the run is ahead of the glide at its positions, mean over the
    /// axes that move: by so much the noise of the glide is shifted in the run.
    ///
    /// # Errors
    /// [`EstimateError::NoPosition`], [`frfid_signals::SignalError::Shape`].
    pub fn wander_s2(&self, run: &Record) -> Result<f64, EstimateError> {
        let (run_position, glide_position) =
            (position_of(run, "run")?, position_of(&self.glide, "glide")?);
        let moving = (0..self.axes.len()).filter(|&axis| self.axes[axis].is_some());
        let wander = moving.filter_map(|axis| {
            let there = glide_position.slice(s![axis, ..run.n_samples()]);
            let ahead_rad = &run_position.row(axis) - &there;
            Some(ahead_rad.var(0.0) / self.glide.y.row(axis).mean()?.powi(2))
        });
        let wander: Vec<f64> = wander.collect();
        Ok(wander.iter().sum::<f64>() / wander.len().max(1) as f64)
    }

    /// The run without the glide and without the difference of ripple between the run's positions
    /// and the glide's; axes that stood still in the glide lose the glide alone.
    ///
    /// # Errors
    /// Those of [`subtract_glide`], [`EstimateError::NoPosition`], [`EstimateError::BeyondGlide`]
    /// if the run goes further than the glide did.
    pub fn subtract_glide(&self, run: &Record) -> Result<Record, EstimateError> {
        let mut rest = subtract_glide(run, &self.glide)?;
        let (run_position, glide_position) =
            (position_of(run, "run")?, position_of(&self.glide, "glide")?);
        for (axis, table) in self.axes.iter().enumerate() {
            let Some(table) = table else { continue };
            table.check_range(axis, run_position.row(axis))?;
            let there = glide_position.slice(s![axis, ..run.n_samples()]);
            Zip::from(rest.u.row_mut(axis))
                .and(run_position.row(axis))
                .and(there)
                .for_each(|u, &here, &there| *u -= table.at(here) - table.at(there));
        }
        Ok(rest)
    }
}

/// The position of every output, each of which must have an input of its own.
fn position_of<'a>(
    record: &'a Record,
    which: &'static str,
) -> Result<&'a Array2<f64>, EstimateError> {
    let position = record.position_rad.as_ref();
    let position = position.ok_or(EstimateError::NoPosition(which))?;
    let shape = record.u.dim();
    let fits = position.dim() == shape && record.y.dim() == shape;
    let needed = format_args!("{shape:?} as u, and y the same: every axis its own motor");
    require_shape("position_rad", position.shape(), fits, needed)?;
    Ok(position)
}

/// `d(t) = u_g - P^-1 y_g`, `(axis, sample)`, without its straight line over time and above the
/// plant's frequencies.
///
/// The line between first and last sample is taken off, then every signal is continued by its
/// reflection about both ends (x(-t) = -x(t)): no jump, no kink, and a period of 2 (n - 1) samples
/// for the FFT.
fn torque_over_time(glide: &Record, plant: &Frf) -> Result<Array2<f64>, EstimateError> {
    let inertia = ApparentInertia::of(plant, glide.u.nrows())?;
    let n = glide.n_samples();
    require("samples of the glide", n as f64, n >= 3, "3 or more")?;
    let (mut torque, y) = (reflected_spectra(&glide.u), reflected_spectra(&glide.y));
    let duration_s = (2 * (n - 1)) as f64 * glide.sample_time_s;
    for bin in 0..n {
        let hz = bin as f64 / duration_s;
        let weight = inertia.weight(hz);
        let acceleration: Vec<Complex64> = y
            .iter()
            .map(|y| y[bin] * Complex64::new(0.0, TAU * hz))
            .collect();
        let moving = (weight > 0.0).then(|| inertia.torque(hz, &acceleration));
        for (axis, torque) in torque.iter_mut().enumerate() {
            torque[bin] = moving.as_ref().map_or(Complex64::ZERO, |moving| {
                (torque[bin] - moving[axis]) * weight
            });
        }
    }
    Ok(over_time(torque, n))
}

/// Spectra of every channel, continued by reflection: as many bins as samples.
fn reflected_spectra(signal: &Array2<f64>) -> Vec<Vec<Complex64>> {
    let period = 2 * (signal.ncols() - 1);
    let forward = TransformPlanner::default().forward(period);
    let spectrum = |channel: ArrayView1<f64>| {
        let (mut samples, mut bins) = (reflected(channel), forward.make_output_vec());
        forward
            .process(&mut samples, &mut bins)
            .expect("the plan's own lengths");
        bins
    };
    signal.rows().into_iter().map(spectrum).collect()
}

/// The signals of `n` samples that have such spectra, `(channel, sample)`, reflection cut off.
fn over_time(spectra: Vec<Vec<Complex64>>, n: usize) -> Array2<f64> {
    let period = 2 * (n - 1);
    let inverse = TransformPlanner::default().inverse(period);
    let mut signals = Array2::zeros((spectra.len(), n));
    for (mut signal, mut bins) in signals.rows_mut().into_iter().zip(spectra) {
        (bins[0].im, bins[n - 1].im) = (0.0, 0.0); // real by symmetry, but for rounding
        let mut samples = inverse.make_output_vec();
        inverse
            .process(&mut bins, &mut samples)
            .expect("the plan's own lengths, ends real");
        for (value, sample) in signal.iter_mut().zip(&samples) {
            *value = sample / period as f64;
        }
    }
    signals
}

/// One period of the signal without its end-to-end line, continued by reflection.
fn reflected(signal: ArrayView1<f64>) -> Vec<f64> {
    let last = signal.len() - 1;
    let slope = (signal[last] - signal[0]) / last as f64;
    let rest = |k: usize| signal[k] - signal[0] - slope * k as f64;
    (0..=last)
        .map(rest)
        .chain((1..last).rev().map(|k| -rest(k)))
        .collect()
}
