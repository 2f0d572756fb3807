//! Excitation of every input line by line: whether it stands out of rounding, of the lines beside
//! it, and of its own noise.
//!
//! With the means over n_q periods `U_pm` of every realization and experiment, and the noise `s^2`
//! of one period from the spread around them, an input that is not excited has
//!
//! ```text
//! F = sum_pm n_q |U_pm|^2 / (n_p n_ex s^2)      2 n_p n_ex and 2 n_p n_ex (n_q - 1) degrees of freedom
//! F = T M^-1 T^H / (n_r s^2)                    2 n_r instead, through the reference
//! T = sum_p n_q U_p R_p^H,   M = sum_p n_q R_p R_p^H
//! ```
//!
//! R. Pintelon, J. Schoukens, System Identification, 2nd ed., section 2.5. Through the reference the
//! sum comes before the square, so that weaker lines are told from noise.

use std::iter::zip;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use ndarray::Array2;
use num_complex::Complex64;
use rayon::prelude::*;

use crate::error::Deficiency;
use crate::frf::f_distribution::f_tail;
use crate::frf::right_division::MAX_CONDITION;
use crate::frf::singular::condition_of_finite;
use crate::spectra::campaign::Block;
use crate::spectra::spread::Spread;

/// Amplitudes below this share of a channel's strongest line are rounding: what numbers of 24 bits
/// leave (6e-8 of a sample, spread over the lines of a period).
const ROUNDING: f64 = 1e-8;
/// A line this far below the strongest one beside it is not excited, in dB: the range that
/// `find_lines` grants the lines of a multisine.
const WEAK_DB: f64 = -60.0;
/// Asked lines on either side that count as beside a line: few enough for a steep spectrum.
const BESIDE: usize = 5;
/// Chance that a line without excitation is taken for excited: below one line of an FRF.
const SIGNIFICANCE: f64 = 1e-3;
/// Complex degrees of freedom that a noise level should have: it is then known to a quarter, and
/// more neighbours need not be like the line.
const ENOUGH_FREEDOM: usize = 20;

/// What is known of the excitation of every input on every line.
pub(crate) struct Excitation {
    u: Tested,
    /// The reference, where the estimate goes through it.
    r: Option<Tested>,
}

/// A signal against its noise, `(channel, line)`.
struct Tested {
    spread: Spread,
    /// Power of the means.
    power: Array2<f64>,
    /// What stands out if a channel is excited, to be compared with the noise.
    evidence: Array2<f64>,
    /// Number of complex terms in the evidence of every line; 0 where it is not known.
    terms: Vec<usize>,
}

impl Excitation {
    /// Of complete blocks, by realization and period.
    pub(crate) fn of(realizations: &[Vec<Block>], through_reference: bool) -> Self {
        let mut u = Tested::of(Spread::of(realizations, |run| Some(&run.u)));
        let r = through_reference.then(|| {
            let r = Tested::of(Spread::of(realizations, |run| run.r.as_ref()));
            u.take_evidence_along(&r.spread);
            r
        });
        Self { u, r }
    }

    /// Why the line cannot be used, by the first input that is not excited on it.
    pub(crate) fn deficiency(&self, line: usize) -> Option<Deficiency> {
        let commanded = self.r.as_ref().unwrap_or(&self.u);
        let signals = || self.r.iter().chain([&self.u]);
        (0..self.u.power.nrows()).find_map(|input| {
            if signals().any(|signal| signal.is_silent(input, line)) {
                return Some(Deficiency::InputSilent { input });
            }
            let weak = commanded.weak(input, line);
            weak.or_else(|| signals().find_map(|signal| signal.noisy(input, line)))
        })
    }

    /// Power of the excitation of U over that of its noise in one period, `(input, line)`, in dB;
    /// `None` with one period.
    pub(crate) fn snr_db(&self) -> Option<Array2<f64>> {
        let shape = self.u.power.dim();
        let place = |(input, line)| self.u.snr_db(input, line);
        (self.u.spread.freedom > 0).then(|| Array2::from_shape_fn(shape, place))
    }
}

impl Tested {
    /// By the power of its means.
    fn of(spread: Spread) -> Self {
        let mut power = Array2::zeros(spread.squares.dim());
        let mut evidence = power.clone();
        for (mean, n_periods) in &spread.means {
            let powers = mean.mapv(|value| value.norm_sqr());
            evidence.scaled_add(*n_periods as f64, &powers);
            power += &powers;
        }
        Self {
            terms: vec![spread.means.len(); power.ncols()],
            power,
            evidence,
            spread,
        }
    }

    /// Takes the power along a reference as evidence instead.
    fn take_evidence_along(&mut self, r: &Spread) {
        let lines = (0..self.power.ncols()).into_par_iter();
        let along = lines.map(|line| power_along(&self.spread, r, line));
        for (line, along) in along.collect::<Vec<_>>().into_iter().enumerate() {
            self.terms[line] = along.len();
            for (input, power) in along.into_iter().enumerate() {
                self.evidence[[input, line]] = power;
            }
        }
    }

    /// Whether a channel is nothing but rounding on a line.
    fn is_silent(&self, channel: usize, line: usize) -> bool {
        let powers = self.power.row(channel);
        let strongest = powers.iter().copied().fold(0.0, f64::max);
        powers[line] <= ROUNDING * ROUNDING * strongest
    }

    /// Whether a channel is far below the lines beside it.
    fn weak(&self, input: usize, line: usize) -> Option<Deficiency> {
        let powers = self.power.row(input);
        let beside = window(line, BESIDE, powers.len());
        let strongest = beside.map(|k| powers[k]).fold(0.0, f64::max);
        let level_db = 10.0 * (powers[line] / strongest).log10();
        (level_db < WEAK_DB).then_some(Deficiency::InputWeak { input, level_db })
    }

    /// Whether a channel cannot be told from its noise.
    fn noisy(&self, input: usize, line: usize) -> Option<Deficiency> {
        let (terms, (noise, freedom)) = (self.terms[line], self.noise(input, line)?);
        let ratio = self.evidence[[input, line]] / (terms as f64 * noise);
        let is_noise = noise > 0.0 && terms > 0 && f_tail(ratio, terms, freedom) > SIGNIFICANCE;
        let snr_db = self.snr_db(input, line);
        is_noise.then_some(Deficiency::InputNoisy { input, snr_db })
    }

    /// Noise power of one period with its complex degrees of freedom, neighbours taken in until
    /// there are enough; `None` with one period.
    fn noise(&self, channel: usize, line: usize) -> Option<(f64, usize)> {
        let Spread {
            squares, freedom, ..
        } = &self.spread;
        let reach = (0..BESIDE).find(|reach| (2 * reach + 1) * freedom >= ENOUGH_FREEDOM);
        let beside = window(line, reach.unwrap_or(BESIDE), squares.ncols());
        let freedom = beside.len() * freedom;
        let sum: f64 = beside.map(|k| squares[[channel, k]]).sum();
        (freedom > 0).then(|| (sum / freedom as f64, freedom))
    }

    /// Excitation over noise in one period in dB, the noise's own share of the evidence taken off;
    /// not a number with one period.
    fn snr_db(&self, channel: usize, line: usize) -> f64 {
        let Some((noise, _)) = self.noise(channel, line) else {
            return f64::NAN;
        };
        let excited = self.evidence[[channel, line]] - self.terms[line] as f64 * noise;
        10.0 * (excited.max(0.0) / (self.spread.n_runs as f64 * noise)).log10()
    }
}

/// Lines within `reach` of a line.
fn window(line: usize, reach: usize, n_lines: usize) -> Range<usize> {
    line.saturating_sub(reach)..(line + reach + 1).min(n_lines)
}

/// Power of every channel of u along the references, `T M^-1 T^H`; empty where the references do not
/// span their space.
fn power_along(u: &Spread, r: &Spread, line: usize) -> Vec<f64> {
    let n = u.squares.nrows();
    let (mut m, mut t) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    for ((u, n_periods), (r, _)) in zip(&u.means, &r.means) {
        let [u, r] = [u, r].map(|x| DVector::from_iterator(n, x.column(line).iter().copied()));
        let weight = Complex64::from(*n_periods as f64);
        m.gerc(weight, &r, &r, Complex64::ONE);
        t.gerc(weight, &r, &u, Complex64::ONE);
    }
    if m.diagonal().iter().any(|power: &Complex64| power.re <= 0.0) {
        return Vec::new();
    }
    // rows to equal size first: channels may have different units
    let scale = m
        .diagonal()
        .map(|power| Complex64::from(1.0 / power.re.sqrt()));
    let scaled = DMatrix::from_fn(n, n, |i, j| m[(i, j)] * scale[i] * scale[j]);
    let t = DMatrix::from_fn(n, n, |i, j| t[(i, j)] * scale[i]);
    if condition_of_finite(&scaled) > MAX_CONDITION {
        return Vec::new();
    }
    let Some(cholesky) = scaled.cholesky() else {
        return Vec::new();
    };
    let solved = cholesky.solve(&t);
    let power = |input: usize| t.column(input).dotc(&solved.column(input)).re;
    (0..n).map(power).collect()
}
