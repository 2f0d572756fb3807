//! Coulomb friction of several axes that move each other, told from their runs without a constant velocity.
//!
//! While a motor slips, its friction is `F_i sgn(y_i)`, late or early by what sensor and hold shift it: a second drive of
//! the torque beside the velocities of all axes. Every narrow band says what it is ([`window`]), all of them together
//! F_i and one delay for all axes ([`pooled`]): `F_i e^{j omega delay}`. No inertia, no pole and no shape of what holds a
//! motor while it sticks is assumed; that makes F_i uncertain by more than the noise, and the bands show it.
//!
//! Source: ours; partial regression after R. Frisch, F. V. Waugh, Econometrica 1 (1933) 387-401.

mod pooled;
pub(super) mod run;
mod window;

use std::f64::consts::TAU;

use frfid_signals::SignalError;
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::friction::SIGNIFICANT;
use crate::friction::axes::pooled::Pooled;
use crate::friction::axes::run::FrictionSpectra;
use crate::friction::axes::window::{Answer, N_TERMS, answers};

/// Lines of the longest run to either side of a narrow band's middle, at least.
const HALF_WIDTH: usize = 20;
/// Bands from which the scatter of what they say is known.
const FEWEST_BANDS: usize = 4;
/// Steps to the delay.
const STEPS: usize = 10;

/// The friction of one axis among several.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisFriction {
    /// Coulomb friction F_c.
    pub coulomb_nm: f64,
    /// Its standard error, from what the bands differ by.
    pub standard_error_nm: f64,
    /// What the bands differ by beyond their own noise, as a standard deviation.
    pub between_bands_nm: f64,
    /// Share of the samples in which it does not slip all the time, in the run in which it is largest.
    pub stuck_share: f64,
}

/// The friction of several axes.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionOfAxes {
    /// Axis by axis.
    pub axes: Vec<AxisFriction>,
    /// By how much the signs of the measured velocities are late.
    pub delay_s: f64,
}

/// The friction of all axes from all their runs.
///
/// # Errors
/// [`SignalError::Unfit`] for runs of other axes than the first, and where too little of a band says what the friction
/// is; [`EstimateError::EmptyList`] without runs.
pub fn find_friction_of_axes(runs: &[FrictionSpectra]) -> Result<FrictionOfAxes, EstimateError> {
    let first = runs.first().ok_or(EstimateError::EmptyList("runs"))?;
    if runs.iter().any(|run| run.n_axes() != first.n_axes()) {
        return Err(SignalError::unfit("runs", "some have other axes than the first").into());
    }
    let answers = answers_of_axes(runs);
    if answers.iter().any(|of_axis| of_axis.len() < FEWEST_BANDS) {
        return Err(not_found());
    }
    let pooled_at = |delay_s: f64| answers.iter().map(move |axis| Pooled::of(axis, delay_s));
    let mut delay_s = 0.0;
    for _ in 0..STEPS {
        let equations = pooled_at(delay_s).map(|axis| axis.delay_equation());
        let [right, factor] = equations.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
        delay_s += if factor > 0.0 { right / factor } else { 0.0 };
    }
    let axis = |(axis, pooled): (usize, Pooled)| AxisFriction {
        coulomb_nm: pooled.coulomb_nm,
        standard_error_nm: pooled.standard_error_nm(),
        between_bands_nm: pooled.between_nm,
        stuck_share: largest(runs.iter().map(|run| run.stuck_shares[axis])),
    };
    Ok(FrictionOfAxes {
        axes: pooled_at(delay_s).enumerate().map(axis).collect(),
        delay_s,
    })
}

/// What all narrow bands say, axis by axis.
fn answers_of_axes(runs: &[FrictionSpectra]) -> Vec<Vec<Answer>> {
    let spacings = runs.iter().map(FrictionSpectra::spacing_hz);
    let spacing_hz = spacings.fold(f64::INFINITY, f64::min);
    let half_hz = (half_width(runs) as f64 + 0.5) * spacing_hz;
    let ends = runs.iter().filter_map(|run| run.line_hz.last()).copied();
    let low_hz = runs[0].line_hz.first().copied().unwrap_or(f64::NAN);
    let n_bands = ((largest(ends) - low_hz) / (2.0 * half_hz)) as usize;
    let mut of_axes = vec![Vec::new(); runs[0].n_axes()];
    for band in 0..n_bands {
        let middle_hz = low_hz + (2 * band + 1) as f64 * half_hz;
        for (of_axis, answer) in of_axes.iter_mut().zip(answers(runs, middle_hz, half_hz)) {
            of_axis.extend(answer);
        }
    }
    of_axes
}

/// Lines to either side that give every unknown two equations.
fn half_width(runs: &[FrictionSpectra]) -> usize {
    let n_unknowns = N_TERMS * (runs[0].n_axes() + runs.len()) + 1;
    HALF_WIDTH.max(n_unknowns.div_ceil(runs.len()))
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::NEG_INFINITY, f64::max)
}

fn not_found() -> EstimateError {
    let what = "too little of the band says what it is: needed axes that all move, and a record of more lines: excite every \
                axis, for longer";
    SignalError::unfit("friction", what).into()
}

impl AxisFriction {
    /// Whether it is more than chance.
    #[must_use]
    pub fn is_significant(&self) -> bool {
        self.coulomb_nm > SIGNIFICANT * self.standard_error_nm
    }

    /// What is taken off: nothing that may be chance.
    fn taken_off_nm(&self) -> f64 {
        if self.is_significant() {
            self.coulomb_nm
        } else {
            0.0
        }
    }
}

impl FrictionOfAxes {
    /// Takes it off spectra of torques, `(axis, line)`, with those of the signs ([`mean_signs`](crate::mean_signs)) by
    /// the same transform.
    ///
    /// # Errors
    /// [`EstimateError::Signal`] for signs of another shape.
    pub fn take_off(
        &self,
        torque: &mut Array2<Complex64>,
        signs: ArrayView2<Complex64>,
        frequency_hz: &[f64],
    ) -> Result<(), EstimateError> {
        let needed = (self.axes.len(), frequency_hz.len());
        for (name, found) in [("torque", torque.dim()), ("signs", signs.dim())] {
            if found != needed {
                let needed = format!("{needed:?} (axis, line)");
                return Err(EstimateError::shape(name, &[found.0, found.1], needed));
            }
        }
        for ((axis, line), value) in torque.indexed_iter_mut() {
            let turn = Complex64::cis(TAU * frequency_hz[line] * self.delay_s);
            *value -= turn * self.axes[axis].taken_off_nm() * signs[[axis, line]];
        }
        Ok(())
    }
}
