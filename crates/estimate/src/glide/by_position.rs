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
//! `P^-1 = 2 pi i f M(f)`: the apparent inertia M is interpolated between the frequencies of P and
//! held beyond them, where it tends to that of the rigid machine. A straight line over position is
//! taken off d: gravity's gradient belongs to P.

use std::f64::consts::{PI, TAU};

use frfid_signals::{Frf, Record, SignalError, checks::positive};
use nalgebra::DMatrix;
use ndarray::{Array2, ArrayView1, Zip, s};
use num_complex::Complex64;
use realfft::RealFftPlanner;

use crate::error::EstimateError;
use crate::frf::right_division::right_divide;
use crate::glide::in_time::{glide_velocity, subtract_glide};
use crate::glide::torque_table::TorqueTable;
use crate::spectra::line_dft::check_rising;

/// Frequencies on either side over which the median of the apparent inertia is taken.
const NEIGHBOURS: usize = 4;

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
    /// back, [`EstimateError::SingularPlant`], [`SignalError::Shape`] if glide and plant have other
    /// channels.
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
    let position = record
        .position_rad
        .as_ref()
        .ok_or(EstimateError::NoPosition(which))?;
    if position.dim() == record.u.dim() && position.dim() == record.y.dim() {
        return Ok(position);
    }
    let (name, needed) = (
        "position_rad",
        format!(
            "{:?} as u, and y the same: every axis its own motor",
            record.u.dim()
        ),
    );
    Err(SignalError::Shape {
        name,
        found: position.shape().to_vec(),
        needed,
    }
    .into())
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
    if n < 3 {
        let (key, found) = ("samples of the glide", n as f64);
        return Err(SignalError::Parameter {
            key,
            found,
            needed: "3 or more",
        }
        .into());
    }
    let period = 2 * (n - 1);
    let mut planner = RealFftPlanner::new();
    let (forward, inverse) = (
        planner.plan_fft_forward(period),
        planner.plan_fft_inverse(period),
    );
    let spectrum = |signal: ArrayView1<f64>| {
        let (mut samples, mut bins) = (reflected(signal), forward.make_output_vec());
        forward
            .process(&mut samples, &mut bins)
            .expect("the plan's own lengths");
        bins
    };
    let [u, y] = [&glide.u, &glide.y]
        .map(|signal| signal.rows().into_iter().map(spectrum).collect::<Vec<_>>());
    let mut torque = u; // in place: bins above the plant's frequencies become 0
    for bin in 0..n {
        let hz = bin as f64 / (period as f64 * glide.sample_time_s);
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
    let mut over_time = Array2::zeros(glide.u.dim());
    for (mut row, mut bins) in over_time.rows_mut().into_iter().zip(torque) {
        (bins[0].im, bins[n - 1].im) = (0.0, 0.0); // real by symmetry, but for rounding
        let mut samples = inverse.make_output_vec();
        inverse
            .process(&mut bins, &mut samples)
            .expect("the plan's own lengths, ends real");
        row.iter_mut()
            .zip(&samples)
            .for_each(|(value, sample)| *value = sample / period as f64);
    }
    Ok(over_time)
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

/// `M(f) = P^-1 / (2 pi i f)` on the frequencies of an FRF.
struct ApparentInertia<'a> {
    frequency_hz: &'a [f64],
    inertia: Vec<DMatrix<Complex64>>,
}

impl<'a> ApparentInertia<'a> {
    fn of(plant: &'a Frf, n_axes: usize) -> Result<Self, EstimateError> {
        plant.check()?;
        check_rising(
            "frequencies of the plant",
            plant.frequency_hz.iter().copied(),
        )?;
        if (plant.n_outputs(), plant.n_inputs()) != (n_axes, n_axes) {
            let needed =
                format!("(frequency, {n_axes}, {n_axes}), torque to velocity of the glide's axes");
            let (name, found) = ("response of the plant", plant.response.shape().to_vec());
            return Err(SignalError::Shape {
                name,
                found,
                needed,
            }
            .into());
        }
        let lines = plant.frequency_hz.iter().zip(plant.response.outer_iter());
        let inertia = lines.map(|(&frequency_hz, response)| {
            positive("frequencies of the plant", frequency_hz)?;
            let response =
                DMatrix::from_fn(n_axes, n_axes, |output, input| response[[output, input]]);
            let inverse = right_divide(&DMatrix::identity(n_axes, n_axes), &response);
            let finite = inverse.iter().all(|value| value.is_finite());
            finite
                .then(|| inverse / Complex64::new(0.0, TAU * frequency_hz))
                .ok_or(EstimateError::SingularPlant { frequency_hz })
        });
        let inertia: Vec<DMatrix<Complex64>> = inertia.collect::<Result<_, _>>()?;
        Ok(Self {
            frequency_hz: &plant.frequency_hz,
            inertia: medians(&inertia),
        })
    }

    /// 1 up to four fifths of the highest frequency, then a half cosine down to 0 there: the ends
    /// of a band ring less.
    fn weight(&self, hz: f64) -> f64 {
        let highest_hz = self.frequency_hz.last().copied().unwrap_or(0.0);
        let place = ((highest_hz - hz) / (0.2 * highest_hz)).clamp(0.0, 1.0);
        0.5 - 0.5 * (PI * place).cos()
    }

    /// Torque in N m of accelerations in rad/s^2 at a frequency.
    fn torque(&self, hz: f64, acceleration: &[Complex64]) -> Vec<Complex64> {
        let last = self.frequency_hz.len() - 1;
        let above = self
            .frequency_hz
            .partition_point(|&line_hz| line_hz < hz)
            .min(last);
        let below = above.saturating_sub(usize::from(self.frequency_hz[above] > hz));
        let gap_hz = self.frequency_hz[above] - self.frequency_hz[below];
        let share = if gap_hz > 0.0 {
            (hz - self.frequency_hz[below]) / gap_hz
        } else {
            0.0
        };
        let (low, high) = (&self.inertia[below], &self.inertia[above]);
        let entry = |row: usize, column: usize| {
            low[(row, column)] * (1.0 - share) + high[(row, column)] * share
        };
        let n = acceleration.len();
        (0..n)
            .map(|row| {
                (0..n)
                    .map(|column| entry(row, column) * acceleration[column])
                    .sum()
            })
            .collect()
    }
}

/// Entry by entry, real and imaginary part, the median over each frequency and its neighbours on
/// either side: M is smooth, but a first estimate is far off on the few frequencies that the ripple
/// itself hits.
fn medians(inertia: &[DMatrix<Complex64>]) -> Vec<DMatrix<Complex64>> {
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
    };
    let around = |line: usize| {
        &inertia[line.saturating_sub(NEIGHBOURS)..(line + NEIGHBOURS + 1).min(inertia.len())]
    };
    let smoothed = |line: usize| {
        let part = |row, column, of: fn(&Complex64) -> f64| {
            median(
                around(line)
                    .iter()
                    .map(|matrix| of(&matrix[(row, column)]))
                    .collect(),
            )
        };
        let (n_rows, n_columns) = inertia[line].shape();
        DMatrix::from_fn(n_rows, n_columns, |row, column| {
            Complex64::new(
                part(row, column, |value| value.re),
                part(row, column, |value| value.im),
            )
        })
    };
    (0..inertia.len()).map(smoothed).collect()
}
