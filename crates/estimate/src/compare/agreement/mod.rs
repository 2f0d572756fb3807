//! Test whether two FRFs agree within their noise: the difference over its covariance, line by line,
//! summed over the band.
//!
//! With `d = vec(G_B - G_A)` of m entries and `S = S_A + S_B`, `d^H S^-1 d` is Hotelling's T^2; over
//! its degrees of freedom it is F distributed with `2 m` and `2 (nu - m + 1)`. (The complex case of
//! N. Goodman, Ann. Math. Stat. 34 (1963) 152; nu of a sum of two covariances by K. Krishnamoorthy,
//! J. Yu, Stat. Prob. Lett. 66 (2004) 161.) Where nu does not suffice for the matrix each entry is
//! tested by itself. The logarithms `-ln p` of the independent lines add up to a Gamma variable, 1
//! a line by chance (R. Fisher); for one entry and many degrees of freedom they are `|d|^2 / S`.

pub(crate) mod common_lines;
mod hotelling;
mod words;

use serde::Serialize;

use crate::compare::agreement::common_lines::CommonLines;
use crate::compare::agreement::hotelling::{entry_ln_p, matrix_ln_p};
use crate::compare::measured::{Measured, Spread};

/// Chance of calling the same machine, measured twice, another one. Small beside the 5 % that are
/// promised: the degrees of freedom of a sum of covariances are an approximation.
const FALSE_ALARM: f64 = 0.01;
/// Common lines that a test takes.
const FEWEST_LINES: usize = 3;
/// `-ln p` of a line that belongs to the band in which two FRFs differ most: by chance one line in
/// twenty has it.
const STANDS_OUT: f64 = 3.0;

/// Whether two FRFs, or one entry of both, agree within their noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Agreement {
    /// It was tested.
    Tested(NoiseTest),
    /// It cannot be told.
    Unknown {
        /// Why.
        reason: UnknownAgreement,
    },
}

/// Why it cannot be told whether two FRFs agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum UnknownAgreement {
    /// One of them has no covariance.
    NoCovariance,
    /// Fewer than three lines are common to both.
    NotOnTheSameLines,
    /// One of them is blurred over frequency, by how much in level is not known.
    Blurred,
}

/// The test over all common lines.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseTest {
    /// Whether the difference is no more than the noise; in one of a hundred cases it says no of
    /// the same machine.
    pub agrees: bool,
    /// Sum of `-ln p` over the lines; for one entry and many degrees of freedom `|d|^2` over its
    /// variance.
    pub statistic: f64,
    /// Lines common to both: what the statistic is by chance.
    pub n_lines: usize,
    /// Probability of as large a statistic by chance.
    pub p_value: f64,
    /// The entry `(output, input)` that it is of; `None` for all entries together.
    pub entry: Option<(usize, usize)>,
    /// What the variances hold; noise if one of the two has noise alone.
    pub spread: Spread,
    /// Where they differ most; `None` where no line stands out.
    pub worst: Option<WorstBand>,
}

/// The band in which the difference stands out most.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WorstBand {
    /// Lowest frequency in Hz.
    pub low_hz: f64,
    /// Highest frequency in Hz.
    pub high_hz: f64,
    /// Rms of the difference over that of A, in percent.
    pub difference_percent: f64,
}

impl Agreement {
    /// Whether the two agree; `None` where it cannot be told.
    #[must_use]
    pub fn agrees(&self) -> Option<bool> {
        match self {
            Self::Tested(test) => Some(test.agrees),
            Self::Unknown { .. } => None,
        }
    }
}

/// Tests every entry, outputs first, and all of them together, in a band.
pub(crate) fn agreements(
    a: &Measured,
    b: &Measured,
    band_hz: (f64, f64),
) -> (Agreement, Vec<Agreement>) {
    let (rows, columns) = (a.frf.n_outputs(), a.frf.n_inputs());
    let entries = || (0..rows).flat_map(|o| (0..columns).map(move |i| (o, i)));
    let lines = match common_lines(a, b, band_hz) {
        Ok(lines) => lines,
        Err(reason) => {
            let unknown = Agreement::Unknown { reason };
            return (unknown.clone(), vec![unknown; rows * columns]);
        }
    };
    let of_entry = |entry| tested(&lines, &entry_ln_p(&lines, entry), Some(entry));
    let each: Vec<Agreement> = entries().map(of_entry).collect();
    let whole = match matrix_ln_p(&lines) {
        Some(ln_p) if each.len() > 1 => tested(&lines, &ln_p, None),
        _ => worst_of(&each),
    };
    (whole, each)
}

fn common_lines<'a>(
    a: &'a Measured,
    b: &'a Measured,
    band_hz: (f64, f64),
) -> Result<CommonLines<'a>, UnknownAgreement> {
    if a.is_blurred() || b.is_blurred() {
        return Err(UnknownAgreement::Blurred);
    }
    let lines = CommonLines::of(a, b, band_hz).ok_or(UnknownAgreement::NoCovariance)?;
    if lines.len() < FEWEST_LINES {
        return Err(UnknownAgreement::NotOnTheSameLines);
    }
    Ok(lines)
}

/// The test over lines; NaN for those that are not known.
fn tested(lines: &CommonLines, ln_p: &[f64], entry: Option<(usize, usize)>) -> Agreement {
    let known = || ln_p.iter().filter(|value| !value.is_nan());
    let n_lines = known().count();
    if n_lines < FEWEST_LINES {
        let reason = UnknownAgreement::NotOnTheSameLines;
        return Agreement::Unknown { reason };
    }
    // not -0 of equal FRFs
    let statistic = 0.0 - known().sum::<f64>();
    let p_value = gamma_tail(statistic, n_lines);
    Agreement::Tested(NoiseTest {
        agrees: p_value >= FALSE_ALARM,
        statistic,
        n_lines,
        p_value,
        entry,
        spread: lines.spread(),
        worst: worst_band(lines, ln_p, entry),
    })
}

/// All entries together by that which differs most: by chance one of m does m times as often
/// (Bonferroni).
fn worst_of(each: &[Agreement]) -> Agreement {
    let tests = || {
        each.iter().filter_map(|agreement| match agreement {
            Agreement::Tested(test) => Some(test),
            Agreement::Unknown { .. } => None,
        })
    };
    let key =
        |test: &NoiseTest| (test.statistic - test.n_lines as f64) / (test.n_lines as f64).sqrt();
    let worst = tests().min_by(|x, y| {
        x.p_value
            .total_cmp(&y.p_value)
            .then(key(y).total_cmp(&key(x)))
    });
    let Some(worst) = worst else {
        return each[0].clone();
    };
    let p_value = (worst.p_value * tests().count() as f64).min(1.0);
    Agreement::Tested(NoiseTest {
        agrees: p_value >= FALSE_ALARM,
        p_value,
        ..worst.clone()
    })
}

/// Probability that the sum of n exponential variables of mean 1 exceeds `sum`:
/// `exp(-sum) sum_(j < n) sum^j / j!`.
fn gamma_tail(sum: f64, n: usize) -> f64 {
    if sum <= 0.0 {
        return 1.0;
    }
    let (mut ln_term, mut tail) = (-sum, 0.0);
    for j in 0..n {
        tail += ln_term.exp();
        ln_term += (sum / (j as f64 + 1.0)).ln();
    }
    tail.min(1.0)
}

/// The run of lines with the largest sum of what stands out (J. Bentley, Commun. ACM 27 (1984)
/// 865).
fn worst_band(
    lines: &CommonLines,
    ln_p: &[f64],
    entry: Option<(usize, usize)>,
) -> Option<WorstBand> {
    let (mut best, mut best_sum) = (None, 0.0);
    let (mut from, mut sum) = (0, 0.0);
    for (k, ln_p) in ln_p.iter().enumerate() {
        if sum <= 0.0 {
            (from, sum) = (k, 0.0);
        }
        sum += if ln_p.is_nan() {
            0.0
        } else {
            -ln_p - STANDS_OUT
        };
        if sum > best_sum {
            (best, best_sum) = (Some(from..=k), sum);
        }
    }
    let band = best?;
    Some(WorstBand {
        low_hz: lines.hz(*band.start()),
        high_hz: lines.hz(*band.end()),
        difference_percent: 100.0 * lines.relative_difference(band, entry),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// scipy 1.17: `scipy.stats.gamma.sf(sum, n)`.
    #[test]
    fn tails_of_sums_are_those_of_scipy() {
        for (sum, n, expected) in [
            (3.0, 1, 0.049787068367863944),
            (71.0, 71, 0.4842168913141965),
            (111.0, 71, 2.0144987323888308e-05),
            (2000.0, 2000, 0.49702645155779744),
        ] {
            let found = gamma_tail(sum, n);
            assert!((found / expected - 1.0).abs() < 1e-9, "{sum}, {n}: {found}");
        }
    }
}
