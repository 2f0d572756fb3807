//! Inverse model of an axis from its velocity to its torque, of low order, with friction as a second input.
//!
//! On the lines of the whole record, with p = s over the middle of the band,
//!
//! ```text
//! A(p) U = B(p) Y + A(p) F_c S + T(p),   A = 1 + a_1 p + a_2 p^2,  B of order 3,  T of order 2
//! ```
//!
//! S the friction over F_c, T what the ends of the record leave; U and S are held over a sample. The equations are
//! weighted by 1/abs(B), so that noise on Y is even, and multiplied by the columns with Y replaced by what the model
//! before says of it (refined instruments): noise on y then does not bias them.

use std::iter::zip;

use nalgebra::{DMatrix, DVector};
use ndarray::{ArrayView1, Axis};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::friction::instruments::Equations;
use crate::spectra::Transform;
use crate::spectra::line_dft::LineDft;

/// Lines beyond the band: below it by this factor, above it, where friction answers too, by the other.
const BEYOND: [f64; 2] = [0.8, 2.0];
/// Fits without instruments, which give the first of them, and with them.
const ROUNDS: [usize; 2] = [2, 4];
/// Orders of A, B and T.
const ORDERS: [usize; 3] = [2, 3, 2];
const N_A: usize = ORDERS[0];
const N_B: usize = ORDERS[1] + 1;
/// Which unknown F_c is.
const COULOMB: usize = N_A + N_B;
const N_UNKNOWNS: usize = N_A + N_B + 1 + ORDERS[2] + 1;

/// Torque of a motor without its friction: `J s + (n_0 + n_1 s + n_2 s^2) / (1 + d_1 s + d_2 s^2)`.
#[derive(Debug, Clone, Copy)]
pub(super) struct InverseModel {
    pub(super) inertia: f64,
    pub(super) numerator: [f64; 3],
    pub(super) denominator: [f64; 2],
    pub(super) coulomb_nm: f64,
    pub(super) standard_error_nm: f64,
}

/// Spectra of a record.
pub(super) struct Lines {
    dft: LineDft,
    /// p.
    p: Vec<Complex64>,
    hold: Vec<Complex64>,
    u: Vec<Complex64>,
    y: Vec<Complex64>,
    pub(super) middle_rad_s: f64,
}

/// A and the rest of a fit, on the lines.
struct OnLines {
    a: Vec<Complex64>,
    b: Vec<Complex64>,
    t: Vec<Complex64>,
    coulomb: f64,
}

impl Lines {
    pub(super) fn of(
        u: ArrayView1<f64>,
        y: ArrayView1<f64>,
        sample_time_s: f64,
        [low_hz, high_hz]: [f64; 2],
    ) -> Result<Self, EstimateError> {
        let length_s = u.len() as f64 * sample_time_s;
        let first = (BEYOND[0] * low_hz * length_s).ceil().max(1.0) as usize;
        let highest = u.len().saturating_sub(1) / 2;
        let last = ((BEYOND[1] * high_hz * length_s) as usize).min(highest);
        if last < first + N_UNKNOWNS {
            return Err(EstimateError::ShortRecord { n_lines: last });
        }
        let dft = LineDft::new(u.len(), &(first..=last).collect::<Vec<_>>())?;
        let middle_rad_s = std::f64::consts::TAU * (low_hz * high_hz).sqrt();
        let s = dft.frequency_hz(sample_time_s)?;
        let s = s
            .iter()
            .map(|hz| Complex64::new(0.0, std::f64::consts::TAU * hz));
        let s: Vec<Complex64> = s.collect();
        let held = |s: &Complex64| (1.0 - (-s * sample_time_s).exp()) / (s * sample_time_s);
        let hold: Vec<Complex64> = s.iter().map(held).collect();
        let spectrum = |name, signal: ArrayView1<f64>| -> Result<Vec<Complex64>, EstimateError> {
            Ok(dft
                .transform(name, signal.insert_axis(Axis(0)))?
                .into_raw_vec_and_offset()
                .0)
        };
        Ok(Self {
            u: times(&spectrum("torque", u)?, &hold),
            y: spectrum("velocity", y)?,
            p: s.iter().map(|s| s / middle_rad_s).collect(),
            hold,
            middle_rad_s,
            dft,
        })
    }

    /// The model with friction of a shape; `None` where it is none of a machine.
    pub(super) fn fit(&self, shape: &[f64]) -> Result<Option<InverseModel>, EstimateError> {
        let shape = ArrayView1::from(shape).insert_axis(Axis(0));
        let shape = self
            .dft
            .transform("friction", shape)?
            .into_raw_vec_and_offset()
            .0;
        let shape = times(&shape, &self.hold);
        let ones = vec![Complex64::ONE; self.p.len()];
        let mut found = OnLines {
            a: ones.clone(),
            b: ones,
            t: Vec::new(),
            coulomb: 0.0,
        };
        let mut model = None;
        for round in 0..ROUNDS[0] + ROUNDS[1] {
            let instrument = (round >= ROUNDS[0]).then(|| self.answer(&found, &shape));
            let equations = self.equations(&found, &shape, instrument.as_deref());
            let Some(unknowns) = equations.solution() else {
                return Ok(None);
            };
            found = self.on_lines(&unknowns);
            model = Some((equations, unknowns));
        }
        Ok(model.and_then(|(equations, unknowns)| {
            let error_nm = equations.standard_error(&unknowns, COULOMB)?;
            InverseModel::of(unknowns.as_slice(), error_nm, self.middle_rad_s)
        }))
    }

    /// What the model says of y.
    fn answer(&self, found: &OnLines, shape: &[Complex64]) -> Vec<Complex64> {
        let driven = |k: usize| found.a[k] * (self.u[k] - shape[k] * found.coulomb) - found.t[k];
        (0..self.p.len()).map(|k| driven(k) / found.b[k]).collect()
    }

    /// Weighted equations, with an instrument in place of y or without.
    fn equations(
        &self,
        before: &OnLines,
        shape: &[Complex64],
        instrument: Option<&[Complex64]>,
    ) -> Equations {
        let left = self.columns(before, shape, &self.y);
        let instruments = match instrument {
            Some(y) => self.columns(before, shape, y),
            None => left.clone(),
        };
        let right = zip(&self.u, &before.b).map(|(u, b)| -u / b.norm());
        Equations::new(left, instruments, split(right))
    }

    /// What each unknown is multiplied by, weighted: a_1.., b_0.., F_c, t_0..
    fn columns(&self, before: &OnLines, shape: &[Complex64], y: &[Complex64]) -> DMatrix<f64> {
        let lines = 0..self.p.len();
        let weighted = |of: &dyn Fn(usize) -> Complex64| {
            split(lines.clone().map(|k| of(k) / before.b[k].norm()))
        };
        let power = |k: usize, order: usize| self.p[k].powi(order as i32);
        let of_a = (1..=ORDERS[0]).map(|order| weighted(&|k| power(k, order) * self.u[k]));
        let of_b = (0..=ORDERS[1]).map(|order| weighted(&|k| -power(k, order) * y[k]));
        let of_friction = weighted(&|k| -before.a[k] * shape[k]);
        let of_t = (0..=ORDERS[2]).map(|order| weighted(&|k| -power(k, order)));
        let columns = of_a.chain(of_b).chain([of_friction]).chain(of_t);
        DMatrix::from_columns(&columns.collect::<Vec<_>>())
    }

    fn on_lines(&self, unknowns: &DVector<f64>) -> OnLines {
        let polynomial = |coefficients: &[f64]| -> Vec<Complex64> {
            let at = |p: &Complex64| {
                let powers = coefficients.iter().rev();
                powers.fold(Complex64::ZERO, |sum, value| sum * p + value)
            };
            self.p.iter().map(at).collect()
        };
        let unknowns = unknowns.as_slice();
        let a: Vec<f64> = [1.0]
            .into_iter()
            .chain(unknowns[..N_A].iter().copied())
            .collect();
        OnLines {
            a: polynomial(&a),
            b: polynomial(&unknowns[N_A..COULOMB]),
            t: polynomial(&unknowns[COULOMB + 1..]),
            coulomb: unknowns[COULOMB],
        }
    }
}

impl InverseModel {
    /// From unknowns in p; `None` unless it is that of a machine: inertia and friction above 0, H stable.
    fn of(unknowns: &[f64], standard_error_nm: f64, middle_rad_s: f64) -> Option<Self> {
        let [a1, a2, b0, b1, b2, b3, coulomb_nm] = *unknowns.first_chunk()?;
        let inertia = b3 / a2; // in p
        let is_machine = inertia > 0.0 && a1 > 0.0 && a2 > 0.0 && coulomb_nm > 0.0;
        let second = middle_rad_s.powi(2);
        is_machine.then_some(Self {
            inertia: inertia / middle_rad_s,
            numerator: [
                b0,
                (b1 - inertia) / middle_rad_s,
                (b2 - inertia * a1) / second,
            ],
            denominator: [a1 / middle_rad_s, a2 / second],
            coulomb_nm,
            standard_error_nm,
        })
    }
}

/// Real parts, then imaginary parts.
fn split(values: impl Iterator<Item = Complex64> + Clone) -> DVector<f64> {
    let parts = values
        .clone()
        .map(|value| value.re)
        .chain(values.map(|value| value.im));
    DVector::from_vec(parts.collect())
}

fn times(a: &[Complex64], b: &[Complex64]) -> Vec<Complex64> {
    zip(a, b).map(|(a, b)| a * b).collect()
}
