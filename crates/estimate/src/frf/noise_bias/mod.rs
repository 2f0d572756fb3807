//! Bias of an FRF by noise on what it is divided by, held against the uncertainty it claims.

mod input_scatter;

use std::fmt;
use std::iter::zip;

use frfid_signals::Frf;
use frfid_signals::format::{count, significant};

use crate::frf::excitation::Excitation;
use crate::frf::noise_bias::input_scatter::noise_share;
use crate::spectra::campaign::Block;

/// A bias of this share of a line's own standard deviation matters: the 95 % region would hold 94 %.
const MATERIAL: f64 = 0.3;
/// A bias below this share of the line is rounding.
const ROUNDING: f64 = 1e-9;

/// What is known of the noise on a line.
pub(crate) struct NoiseSeen {
    /// Power over that of the noise in one period, of the weakest input.
    pub(crate) input_snr: f64,
    /// The same of the weakest output, where a method asked for it; infinite otherwise.
    pub(crate) output_snr: f64,
    pub(crate) n_inputs: usize,
    /// Periods of a realization that are averaged, the fewest.
    pub(crate) n_periods: usize,
    /// Blocks of the campaign.
    pub(crate) n_blocks: usize,
}

/// Lines on which noise on the input biases the FRF by more than its region allows, with the worst of
/// them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseBias {
    /// How many lines.
    pub n_lines: usize,
    /// Of how many.
    pub n_all: usize,
    /// Frequency of the worst in Hz.
    pub frequency_hz: f64,
    /// Power of the input (of the output, where that is what the method divides by) there over that of
    /// its noise in one period, in dB.
    pub snr_db: f64,
    /// Bias there, as a share of the response.
    pub relative_bias: f64,
    /// The same over the standard deviation that is stated.
    pub bias_over_deviation: f64,
}

/// For people: what was found.
impl fmt::Display for NoiseBias {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} of {}, worst {} Hz: at {:.0} dB of signal over noise in a period the response is about {} % off, \
             {} times its standard deviation",
            count(self.n_lines, "line"),
            self.n_all,
            significant(self.frequency_hz, 4),
            self.snr_db,
            significant(100.0 * self.relative_bias, 2),
            significant(self.bias_over_deviation, 2),
        )
    }
}

/// A line and what noise does to it.
struct Line {
    place: usize,
    snr: f64,
    bias: f64,
    over_deviation: f64,
}

/// What noise does to an FRF whose method has a relative bias of so much; `None` where it does no harm,
/// or the noise is not known.
pub(crate) fn noise_bias(
    frf: &Frf,
    excitation: &Excitation,
    realizations: &[Vec<Block>],
    of_method: impl Fn(&NoiseSeen) -> f64,
) -> Option<NoiseBias> {
    let n_periods: Vec<usize> = realizations.iter().map(Vec::len).collect();
    let seen = |place: usize, share: f64| {
        let [input_snr, output_snr] = excitation.weakest(place)?;
        Some(NoiseSeen {
            input_snr: input_snr / share,
            output_snr,
            n_inputs: frf.n_inputs(),
            n_periods: n_periods.iter().copied().min().unwrap_or(0),
            n_blocks: n_periods.iter().sum(),
        })
    };
    let deviations = frf.relative_noise()?;
    let worst = |shares: &[f64]| {
        let line = |(place, (deviation, share)): (usize, (&f64, &f64))| {
            material(place, *deviation, &seen(place, *share)?, &of_method)
        };
        let lines = zip(&deviations, shares).enumerate().filter_map(line);
        worst_of(frf, lines.collect())
    };
    // usually no line is suspect, and what is not noise need not be looked for
    worst(&vec![1.0; deviations.len()])?;
    worst(&noise_share(realizations, frf))
}

/// A line whose bias matters beside its deviation.
fn material(
    place: usize,
    deviation: f64,
    seen: &NoiseSeen,
    of_method: impl Fn(&NoiseSeen) -> f64,
) -> Option<Line> {
    let bias = of_method(seen);
    let over_deviation = bias / deviation;
    let is_material = bias > ROUNDING && over_deviation > MATERIAL;
    is_material.then_some(Line {
        place,
        snr: if seen.output_snr.is_finite() {
            seen.output_snr
        } else {
            seen.input_snr
        },
        bias,
        over_deviation,
    })
}

fn worst_of(frf: &Frf, lines: Vec<Line>) -> Option<NoiseBias> {
    let by_deviation = |a: &&Line, b: &&Line| a.over_deviation.total_cmp(&b.over_deviation);
    let worst = lines.iter().max_by(by_deviation)?;
    Some(NoiseBias {
        n_lines: lines.len(),
        n_all: frf.n_frequencies(),
        frequency_hz: frf.frequency_hz[worst.place],
        snr_db: 10.0 * worst.snr.log10(),
        relative_bias: worst.bias,
        bias_over_deviation: worst.over_deviation,
    })
}

impl NoiseSeen {
    /// Share by which the mean of `(I + N)^-1` falls short of I, N of `n` by `n` circular normal numbers that
    /// stand for the noise left after so many periods are averaged: with `x = n averaged SNR`
    ///
    /// ```text
    /// 1/n sum_k Q(k, x),   Q(k, x) = exp(-x) sum_{j < k} x^j / j!
    /// ```
    ///
    /// the share of N's eigenvalues beyond the circle, their squares being Gamma(1..n) distributed (E.
    /// Kostlan, Linear Algebra Appl. 162 (1992) 385); `exp(-SNR)` for one input (R. Pintelon, J. Schoukens,
    /// System Identification, 2nd ed., section 2.6).
    pub(crate) fn bias_of_quotient(&self, averaged: usize) -> f64 {
        let n = self.n_inputs;
        let x = (n * averaged) as f64 * self.input_snr;
        let (mut term, mut sum, mut total) = ((-x).exp(), 0.0, 0.0);
        for k in 1..=n {
            sum += term;
            total += sum;
            term *= x / k as f64;
        }
        if term.is_nan() { 0.0 } else { total / n as f64 }
    }
}
