//! Excitation of every input line by line: whether it stands out of rounding, of the lines beside
//! it, and of its own noise.
//!
//! With the means over n_q periods `U_pm` of every realization and experiment, and the noise `s^2`
//! of one period from the spread around them, an input that is not excited on a line has
//!
//! ```text
//! F = sum_pm n_q |U_pm|^2 / (n_p n_ex s^2),   2 n_p n_ex and 2 n_p n_ex (n_q - 1) degrees of freedom
//! ```
//!
//! (R. Pintelon, J. Schoukens, System Identification, 2nd ed., section 2.5). Where the estimate goes
//! through the reference, that is what must be excited; a machine may answer it with little input on
//! some lines, where the estimate is as uncertain as it says. Only an input that follows the reference
//! on no line is not excited: over all lines together
//!
//! ```text
//! F = sum T M^-1 T^H / sum n_r s^2,   T = sum_p n_q U_p R_p^H,   M = sum_p n_q R_p R_p^H
//! ```

mod along_reference;
mod noise;

use std::ops::Range;

use ndarray::Array2;
use rayon::prelude::*;

use crate::error::deficient_line::Deficiency;
use crate::frf::excitation::along_reference::power_along;
use crate::frf::excitation::noise::Noise;
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
/// Chance that a line without excitation is significant: below one line of an FRF.
const SIGNIFICANCE: f64 = 1e-3;
/// The same of a line that speaks for those beside it: below one line of all FRFs of a day.
const SURE: f64 = 1e-6;
/// A line that is not significant but has this share of the excitation of a significant one beside it
/// (-13 dB) is taken for weakly excited: a resonance in a closed loop leaves that little of the input.
const SHARE_OF_BESIDE: f64 = 0.05;
/// Complex degrees of freedom that a noise level should have: it is then known to a quarter, and
/// more neighbours need not be like the line.
const ENOUGH_FREEDOM: usize = 20;

/// What is known of the excitation of every input on every line.
pub(crate) struct Excitation {
    u: Tested,
    /// The reference, where the estimate goes through it, and whether each input follows it.
    r: Option<(Tested, Vec<bool>)>,
    /// The output, where noise on it biases the estimate.
    y: Option<Tested>,
}

/// A signal against its noise, `(channel, line)`.
struct Tested {
    spread: Spread,
    /// Power of the means.
    power: Array2<f64>,
    /// The same, each mean times its number of periods: to be compared with the noise.
    evidence: Array2<f64>,
}

impl Excitation {
    /// Of complete blocks, by realization and period.
    pub(crate) fn of(
        realizations: &[Vec<Block>],
        through_reference: bool,
        by_output: bool,
    ) -> Self {
        let u = Tested::of(Spread::of(realizations, |run| Some(&run.u)));
        let reference = || {
            let r = Tested::of(Spread::of(realizations, |run| run.r.as_ref()));
            let follows = u.follows(&r.spread);
            (r, follows)
        };
        let r = through_reference.then(reference);
        let output = || Tested::of(Spread::of(realizations, |run| Some(&run.y)));
        let y = by_output.then(output);
        Self { u, r, y }
    }

    /// Power over that of the noise in one period, of the weakest input and the weakest output; the
    /// output's is infinite where it was not asked for. `None` with one period.
    pub(crate) fn weakest(&self, line: usize) -> Option<[f64; 2]> {
        let output = self
            .y
            .as_ref()
            .map_or(Some(f64::INFINITY), |y| y.weakest(line));
        let input = match &self.r {
            Some((r, _)) => self.u.weakest_along(&r.spread, line),
            None => self.u.weakest(line),
        };
        Some([input?, output?])
    }

    /// Why the line cannot be used, by the first input that is not excited on it.
    pub(crate) fn deficiency(&self, line: usize) -> Option<Deficiency> {
        let n_inputs = self.u.power.nrows();
        (0..n_inputs).find_map(|input| self.deficiency_of(input, line))
    }

    fn deficiency_of(&self, input: usize, line: usize) -> Option<Deficiency> {
        let commanded = self.r.as_ref().map_or(&self.u, |(r, _)| r);
        let silent = commanded.silent(input, line);
        self.u
            .silent(input, line)
            .or(silent)
            .or_else(|| commanded.weak(input, line))
            .or_else(|| commanded.noisy(input, line))
            .or_else(|| self.unmoved(input, line))
    }

    /// Whether an input does not follow the reference.
    fn unmoved(&self, input: usize, line: usize) -> Option<Deficiency> {
        let (_, follows) = self.r.as_ref()?;
        let snr_db = self.u.snr_db(input, line);
        (!follows[input]).then_some(Deficiency::InputNoisy { input, snr_db })
    }

    /// Power of the excitation of U over that of its noise in one period, `(input, line)`, in dB;
    /// `None` with one period.
    pub(crate) fn snr_db(&self) -> Option<Array2<f64>> {
        let is_known = self.u.spread.freedom > 0;
        let at = |(input, line)| self.u.snr_db(input, line);
        is_known.then(|| Array2::from_shape_fn(self.u.power.dim(), at))
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
            spread,
            power,
            evidence,
        }
    }

    /// Whether each channel follows a reference, over all lines together; taken for granted with
    /// one period.
    fn follows(&self, r: &Spread) -> Vec<bool> {
        let (n_channels, n_lines) = self.power.dim();
        let along = (0..n_lines).into_par_iter();
        let along = along.map(|line| power_along(&self.spread, r, line));
        let along: Vec<Vec<f64>> = along.filter(|powers| !powers.is_empty()).collect();
        let follows = |channel: usize| self.follows_along(channel, &along);
        (0..n_channels).map(follows).collect()
    }

    /// The same of one channel, from the power of every one along the reference, line by line.
    fn follows_along(&self, channel: usize, along: &[Vec<f64>]) -> bool {
        let (n_channels, n_lines) = self.power.dim();
        let power: f64 = along.iter().map(|powers| powers[channel]).sum();
        let sum = self.spread.squares.row(channel).sum();
        let noise = Noise::of(sum, n_lines * self.spread.freedom);
        let terms = along.len() * n_channels;
        terms == 0 || noise.is_none_or(|noise| noise.is_below(power, terms, SIGNIFICANCE))
    }

    /// Whether a channel is nothing but rounding on a line.
    fn silent(&self, input: usize, line: usize) -> Option<Deficiency> {
        let powers = self.power.row(input);
        let rounding = ROUNDING * ROUNDING * largest(powers.iter().copied());
        (powers[line] <= rounding).then_some(Deficiency::InputSilent { input })
    }

    /// Whether a channel is far below the lines beside it.
    fn weak(&self, input: usize, line: usize) -> Option<Deficiency> {
        let powers = self.power.row(input);
        let beside = window(line, BESIDE, powers.len());
        let level_db = decibels(powers[line] / largest(beside.map(|k| powers[k])));
        (level_db < WEAK_DB).then_some(Deficiency::InputWeak { input, level_db })
    }

    /// Whether a channel cannot be told from its noise, neither by itself nor by what stands beside.
    fn noisy(&self, input: usize, line: usize) -> Option<Deficiency> {
        let snr = self.snr(input, line)?;
        let is_told = self.stands_out(input, line, SIGNIFICANCE)
            || is_like(snr, self.strongest_beside(input, line));
        let snr_db = decibels(snr);
        (!is_told).then_some(Deficiency::InputNoisy { input, snr_db })
    }

    /// The strongest excitation of a line beside that stands out for sure; 0 without one.
    fn strongest_beside(&self, input: usize, line: usize) -> f64 {
        let beside = window(line, BESIDE, self.power.ncols());
        let sure = beside.filter(|&k| self.stands_out(input, k, SURE));
        largest(sure.filter_map(|k| self.snr(input, k)))
    }

    /// Whether a line is significant at this chance; not with one period.
    fn stands_out(&self, channel: usize, line: usize, chance: f64) -> bool {
        let power = self.evidence[[channel, line]];
        let terms = self.spread.means.len();
        let noise = self.noise(channel, line);
        noise.is_some_and(|noise| noise.is_below(power, terms, chance))
    }

    /// Noise of a channel, neighbours taken in until there is enough; `None` with one period.
    fn noise(&self, channel: usize, line: usize) -> Option<Noise> {
        let squares = self.spread.squares.row(channel);
        let beside = window(line, self.noise_reach(), squares.len());
        let freedom = beside.len() * self.spread.freedom;
        Noise::of(beside.map(|k| squares[k]).sum(), freedom)
    }

    /// How many neighbours on either side make the noise well known.
    fn noise_reach(&self) -> usize {
        let freedom = |reach: usize| (2 * reach + 1) * self.spread.freedom;
        let enough = (0..BESIDE).find(|&reach| freedom(reach) >= ENOUGH_FREEDOM);
        enough.unwrap_or(BESIDE)
    }

    /// Power of the excitation over that of the noise in one period, the noise's own share of the
    /// evidence taken off; `None` with one period.
    fn snr(&self, channel: usize, line: usize) -> Option<f64> {
        let noise = self.noise(channel, line)?.power;
        let own = self.spread.means.len() as f64 * noise;
        let excited = (self.evidence[[channel, line]] - own).max(0.0);
        Some(excited / (self.spread.n_runs as f64 * noise))
    }

    /// The same of the weakest channel, of the excitation that follows a reference: over many realizations
    /// it is better known.
    fn weakest_along(&self, r: &Spread, line: usize) -> Option<f64> {
        let powers = power_along(&self.spread, r, line);
        let n_references = powers.len() as f64;
        let snr = |(channel, power): (usize, f64)| {
            let noise = self.noise(channel, line)?.power;
            let excited = (power - n_references * noise).max(0.0);
            Some(excited / (self.spread.n_runs as f64 * noise))
        };
        smallest(powers.into_iter().enumerate().map(snr))
    }

    /// The same of the weakest channel.
    fn weakest(&self, line: usize) -> Option<f64> {
        let channels = 0..self.power.nrows();
        smallest(channels.map(|channel| self.snr(channel, line)))
    }

    /// The same in dB; not a number with one period.
    fn snr_db(&self, channel: usize, line: usize) -> f64 {
        decibels(self.snr(channel, line).unwrap_or(f64::NAN))
    }
}

/// The smallest of all; `None` if one is unknown.
fn smallest(all: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let all: Option<Vec<f64>> = all.collect();
    all?.into_iter().reduce(f64::min)
}

/// Whether a line is excited like the strongest beside it, if there is one.
fn is_like(snr: f64, strongest: f64) -> bool {
    strongest > 0.0 && snr >= SHARE_OF_BESIDE * strongest
}

/// The largest of some powers or ratios of them.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// A ratio of powers in dB.
fn decibels(ratio: f64) -> f64 {
    10.0 * ratio.log10()
}

/// Lines within `reach` of a line.
fn window(line: usize, reach: usize, n_lines: usize) -> Range<usize> {
    line.saturating_sub(reach)..(line + reach + 1).min(n_lines)
}
