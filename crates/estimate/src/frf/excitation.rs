//! Excitation of every input line by line: whether it stands out of rounding, of the lines beside
//! it, and of its own noise.
//!
//! With the mean over periods `U_p` of each realization and experiment, and `s^2` the noise of one
//! period from their spread, an input that is not excited has
//!
//! ```text
//! F = sum_pm n_q |U_pm|^2 / (n_p n_ex s^2)            2 n_p n_ex and 2 n_p n_ex (n_q - 1) degrees of freedom
//! F = |T M^-1 T^H| / (n_r s^2),  T = sum U R^H, M = sum R R^H      with a reference; 2 n_r instead
//! ```
//!
//! (R. Pintelon, J. Schoukens, System Identification, 2nd ed., section 2.5.) With a reference the
//! sum over all blocks comes before the square, so that weaker lines are told from noise.

use nalgebra::{DMatrix, DVector};
use ndarray::{Array2, Zip};
use num_complex::Complex64;
use rayon::prelude::*;

use crate::error::Deficiency;
use crate::spectra::campaign::{Block, RunSpectra};

/// Amplitudes below this share of a channel's strongest line are rounding: what numbers of 24 bits
/// leave (6e-8 of a sample, spread over the lines of a period).
const ROUNDING: f64 = 1e-8;
/// A line this far below the strongest one beside it is not excited, in dB: the range that
/// `find_lines` grants the lines of a multisine.
const WEAK_DB: f64 = -60.0;
/// Asked lines on either side that count as beside a line: few enough for a steep spectrum.
const BESIDE: usize = 5;
/// Chance that a line without excitation is taken for excited: one in as many lines as an FRF has.
const SIGNIFICANCE: f64 = 1e-3;
/// Complex degrees of freedom that a noise level should have: it is then known to a quarter, and
/// neighbours are asked for no more.
const ENOUGH_FREEDOM: usize = 20;

/// What is known of the excitation of every input on every line, `(input, line)`.
pub(crate) struct Excitation {
    /// Power of what was commanded: the reference where the estimate goes through it, else U.
    commanded: Array2<f64>,
    /// Power of U.
    power: Array2<f64>,
    /// Power that stands out if the input is excited, to be compared with the noise.
    evidence: Array2<f64>,
    /// Number of complex terms in `evidence`; 0 where it is not known.
    terms: Vec<usize>,
    /// Sum of squared deviations of U from the mean over periods.
    spread: Array2<f64>,
    /// Complex degrees of freedom of `spread`; 0 with one period.
    freedom: usize,
    /// Number of periods over all experiments.
    n_runs: usize,
}

impl Excitation {
    /// Of complete blocks, by realization and period.
    pub(crate) fn of(realizations: &[Vec<Block>], through_reference: bool) -> Self {
        let of_u = Powers::of(realizations, |run| Some(&run.u));
        let n_runs = realizations.iter().flatten().map(Vec::len).sum();
        let n_means: usize = realizations.iter().map(|periods| periods[0].len()).sum();
        let mut excitation = Self {
            commanded: of_u.mean.clone(),
            terms: vec![n_means; of_u.mean.ncols()],
            power: of_u.mean,
            evidence: of_u.weighted,
            spread: of_u.spread,
            freedom: n_runs - n_means,
            n_runs,
        };
        if through_reference {
            excitation.commanded = Powers::of(realizations, |run| run.r.as_ref()).mean;
            excitation.take_evidence_along_reference(realizations);
        }
        excitation
    }

    /// Why the line cannot be used, by the first input that is not excited on it.
    pub(crate) fn deficiency(&self, line: usize) -> Option<Deficiency> {
        (0..self.power.nrows()).find_map(|input| {
            let is_silent = |power: &Array2<f64>| {
                let strongest = power.row(input).iter().copied().fold(0.0, f64::max);
                power[[input, line]] <= ROUNDING * ROUNDING * strongest
            };
            if is_silent(&self.power) || is_silent(&self.commanded) {
                return Some(Deficiency::InputSilent { input });
            }
            self.weak(input, line).or_else(|| self.noisy(input, line))
        })
    }

    /// Whether what was commanded is far below the lines beside it.
    fn weak(&self, input: usize, line: usize) -> Option<Deficiency> {
        let powers = self.commanded.row(input);
        let beside = window(line, BESIDE, powers.len());
        let strongest = beside.map(|k| powers[k]).fold(0.0, f64::max);
        let level_db = 10.0 * (powers[line] / strongest).log10();
        (level_db < WEAK_DB).then_some(Deficiency::InputWeak { input, level_db })
    }

    /// Whether the input cannot be told from its noise.
    fn noisy(&self, input: usize, line: usize) -> Option<Deficiency> {
        let terms = self.terms[line];
        let (noise, freedom) = self.noise(input, line)?;
        let ratio = self.evidence[[input, line]] / (terms as f64 * noise);
        let is_noise = noise > 0.0 && terms > 0 && f_tail(ratio, terms, freedom) > SIGNIFICANCE;
        is_noise.then(|| Deficiency::InputNoisy {
            input,
            snr_db: self.snr_db_at(input, line),
        })
    }

    /// Noise power of one period with its complex degrees of freedom, neighbours taken in until
    /// there are enough; `None` with one period.
    fn noise(&self, input: usize, line: usize) -> Option<(f64, usize)> {
        let reach = (0..BESIDE).find(|reach| (2 * reach + 1) * self.freedom >= ENOUGH_FREEDOM);
        let beside = window(line, reach.unwrap_or(BESIDE), self.spread.ncols());
        let freedom = beside.len() * self.freedom;
        let sum: f64 = beside.map(|k| self.spread[[input, k]]).sum();
        (freedom > 0).then(|| (sum / freedom as f64, freedom))
    }

    /// Power of the excitation over that of the noise in one period, `(input, line)`, in dB; `None`
    /// with one period.
    pub(crate) fn snr_db(&self) -> Option<Array2<f64>> {
        (self.freedom > 0).then(|| {
            Array2::from_shape_fn(self.power.dim(), |(input, line)| {
                self.snr_db_at(input, line)
            })
        })
    }

    /// The noise's own share of the evidence taken off; not a number where nothing is known.
    fn snr_db_at(&self, input: usize, line: usize) -> f64 {
        let Some((noise, _)) = self.noise(input, line) else {
            return f64::NAN;
        };
        let excited = self.evidence[[input, line]] - self.terms[line] as f64 * noise;
        10.0 * (excited.max(0.0) / (self.n_runs as f64 * noise)).log10()
    }

    /// Replaces the power of U by that of its part along R.
    fn take_evidence_along_reference(&mut self, realizations: &[Vec<Block>]) {
        let lines = 0..self.power.ncols();
        let along: Vec<_> = lines
            .into_par_iter()
            .map(|line| along_reference(realizations, line))
            .collect();
        for (line, along) in along.into_iter().enumerate() {
            self.terms[line] = along.as_ref().map_or(0, |(_, terms)| *terms);
            for (input, power) in along
                .iter()
                .flat_map(|(powers, _)| powers.iter().enumerate())
            {
                self.evidence[[input, line]] = *power;
            }
        }
    }
}

/// Lines within `reach` of a line.
fn window(line: usize, reach: usize, n_lines: usize) -> std::ops::Range<usize> {
    line.saturating_sub(reach)..(line + reach + 1).min(n_lines)
}

/// Powers of a signal, `(channel, line)`, summed over realizations and experiments.
struct Powers {
    /// `sum |mean over periods|^2`.
    mean: Array2<f64>,
    /// The same, each realization times its number of periods.
    weighted: Array2<f64>,
    /// `sum |X - mean|^2`, over periods too.
    spread: Array2<f64>,
}

impl Powers {
    fn of<'a>(
        realizations: &[Vec<Block<'a>>],
        signal: impl Fn(&'a RunSpectra) -> Option<&'a Array2<Complex64>>,
    ) -> Self {
        let shape = realizations[0][0][0].u.dim();
        let mut powers = Self {
            mean: Array2::zeros(shape),
            weighted: Array2::zeros(shape),
            spread: Array2::zeros(shape),
        };
        for periods in realizations {
            for experiment in 0..periods[0].len() {
                let spectra = periods.iter().filter_map(|block| signal(block[experiment]));
                powers.add(&spectra.collect::<Vec<_>>());
            }
        }
        powers
    }

    /// Adds the periods of one experiment.
    fn add(&mut self, periods: &[&Array2<Complex64>]) {
        let n = periods.len() as f64;
        let Some((first, rest)) = periods.split_first() else {
            return;
        };
        let mut mean = (*first).clone();
        for period in rest {
            mean += *period;
        }
        mean /= Complex64::from(n);
        for period in periods {
            Zip::from(&mut self.spread)
                .and(*period)
                .and(&mean)
                .for_each(|sum, value, mean| *sum += (value - mean).norm_sqr());
        }
        Zip::from(&mut self.mean)
            .and(&mut self.weighted)
            .and(&mean)
            .for_each(|power, weighted, mean| {
                *power += mean.norm_sqr();
                *weighted += n * mean.norm_sqr();
            });
    }
}

/// Power of each input along the reference, `T M^-1 T^H`, and its number of complex terms; `None`
/// where the references of the experiments do not span their space.
fn along_reference(realizations: &[Vec<Block>], line: usize) -> Option<(Vec<f64>, usize)> {
    let runs = || realizations.iter().flatten().flatten();
    let n_inputs = runs().next()?.u.nrows();
    let mut r_r = DMatrix::zeros(n_inputs, n_inputs);
    let mut r_u = DMatrix::zeros(n_inputs, n_inputs);
    for run in runs() {
        let on_line = |x: &Array2<Complex64>| {
            DVector::from_iterator(x.nrows(), x.column(line).iter().copied())
        };
        let (r, u) = (on_line(run.r.as_ref()?), on_line(&run.u));
        r_r.gerc(Complex64::ONE, &r, &r, Complex64::ONE);
        r_u.gerc(Complex64::ONE, &r, &u, Complex64::ONE);
    }
    // rows to equal size first: channels may have different units
    let sizes = r_r.diagonal().map(|power: Complex64| power.re.sqrt());
    let scale = |row: usize| Complex64::from(1.0 / sizes[row]);
    let r_r = DMatrix::from_fn(n_inputs, n_inputs, |i, j| r_r[(i, j)] * scale(i) * scale(j));
    let r_u = DMatrix::from_fn(n_inputs, n_inputs, |i, j| r_u[(i, j)] * scale(i));
    let solved = r_r.cholesky()?.solve(&r_u);
    let power = |input: usize| r_u.column(input).dotc(&solved.column(input)).re;
    Some(((0..n_inputs).map(power).collect(), n_inputs))
}

/// Probability that an F variable with `2 a` and `2 b` degrees of freedom exceeds `ratio`: with
/// `w = a ratio / (b + a ratio)` it is `(1 - w)^b sum_(i < a) C(b + i - 1, i) w^i`. (M. Abramowitz,
/// I. Stegun, 26.6.4 and 26.5.6.)
fn f_tail(ratio: f64, a: usize, b: usize) -> f64 {
    let (scaled, b) = (a as f64 * ratio, b as f64);
    let ln_w = (scaled / (b + scaled)).ln();
    let mut ln_term = -b * (scaled / b).ln_1p();
    let (mut largest, mut sum) = (ln_term, 1.0);
    // as logarithms: with many terms the first of them underflows
    for i in 0..a.saturating_sub(1) {
        ln_term += ln_w + ((b + i as f64) / (i as f64 + 1.0)).ln();
        if ln_term > largest {
            sum = sum * (largest - ln_term).exp() + 1.0;
            largest = ln_term;
        } else {
            sum += (ln_term - largest).exp();
        }
    }
    (largest + sum.ln()).exp()
}
