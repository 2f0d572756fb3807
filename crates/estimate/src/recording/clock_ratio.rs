//! Period of a player in samples of a recorder whose clock is another one: not a whole number.
//!
//! Windows of N samples back to back see a line h of the true period P turn by `2 pi h N/P` from one
//! to the next, so that its phase drifts by `2 pi h (N/P - 1)`: a delay that grows steadily. With
//! |N - P| below one no line below Nyquist turns by half a turn.

use std::f64::consts::TAU;
use std::iter::zip;

use frfid_signals::SignalError;
use frfid_signals::checks::{all_finite, positive, require_shape};
use ndarray::{ArrayView3, Axis};
use num_complex::Complex64;

use crate::error::EstimateError;

/// A difference must be so many standard errors of a known noise to be told: 0.1 % by chance ..
const STANDARD_ERRORS: f64 = 3.3;
/// .. and at least this, below which a hundred periods turn line 1000 by a twentieth of a turn and
/// move no amplitude by 0.1 %.
const SMALLEST: f64 = 0.2e-6;
/// A line must be so many times as strong as the noise of a period (10 dB) for its phase to mean
/// anything.
const STRONG: f64 = 10.0;
/// Fewest periods: two show a turn and not its error.
const FEWEST: usize = 3;
/// Gauss-Newton steps; from the turn over half the record the first one is right to a percent.
const STEPS: usize = 8;

/// The period of an excitation by the clock of the recorder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockRatio {
    /// Period in samples.
    pub period_samples: f64,
    /// Its standard error in samples.
    pub standard_error_samples: f64,
}

/// The true period from spectra `(period, channel, line)` of windows of `n_samples` back to back,
/// where it is not whole; of the input or better the reference, on its excited `lines`.
///
/// `None` where the period does not differ from whole by 3.3 standard errors or by 0.2 ppm, where no
/// line stands 10 dB above the noise, and with less than three periods, which show no error.
///
/// # Errors
/// [`frfid_signals::SignalError::Shape`] for spectra that do not fit the lines,
/// [`frfid_signals::SignalError::NotFinite`].
pub fn find_clock_ratio(
    spectra: ArrayView3<Complex64>,
    lines: &[usize],
    n_samples: usize,
) -> Result<Option<ClockRatio>, EstimateError> {
    check_spectra(spectra, lines.len())?;
    positive("n_samples", n_samples as f64)?;
    let n_periods = spectra.len_of(Axis(0));
    if n_periods < FEWEST {
        return Ok(None);
    }
    let Estimate {
        drift,
        error,
        n_lines,
    } = Turns::of(spectra, lines).estimate();
    // neighbouring lines leak in, and their turns differ: second order in the drift
    let error = error.hypot(drift * drift);
    let n_free = n_lines * (n_periods - 2) as f64;
    let enough = (standard_errors(n_free) * error).max(SMALLEST);
    // N/P = 1 + drift
    let period_samples = n_samples as f64 / (1.0 + drift);
    let standard_error_samples = n_samples as f64 * error;
    Ok((drift.abs() > enough).then_some(ClockRatio {
        period_samples,
        standard_error_samples,
    }))
}

/// Refuses spectra of another number of lines, empty ones, and values that are not finite.
fn check_spectra(spectra: ArrayView3<Complex64>, n_lines: usize) -> Result<(), SignalError> {
    let fits = spectra.len_of(Axis(2)) == n_lines && !spectra.is_empty();
    let needed = format_args!("(period, channel, {n_lines}), none of them 0");
    require_shape("spectra", spectra.shape(), fits, needed)?;
    let bad = (spectra.indexed_iter()).filter(|(_, value)| !value.is_finite());
    all_finite(
        "spectra",
        bad.map(|((_, channel, line), _)| (channel, line)),
    )
}

/// Standard errors that are exceeded as rarely by chance when they come from few values: Student's
/// quantile (Wallace, Ann. Math. Stat. 30 (1959) 1124).
fn standard_errors(n_free: f64) -> f64 {
    let normal = STANDARD_ERRORS * (8.0 * n_free + 3.0) / (8.0 * n_free + 1.0);
    (n_free * (normal * normal / n_free).exp_m1()).sqrt()
}

/// Drift `N/P - 1` by the turns of lines.
struct Estimate {
    drift: f64,
    /// Standard error, by the spread of each line about its own turn; infinite where no line is strong.
    error: f64,
    /// As many lines of equal weight would be worth as much (Kish).
    n_lines: f64,
}

/// Lines of all channels whose turns are looked at.
struct Turns {
    lines: Vec<Line>,
}

/// One line of one channel.
struct Line {
    /// Radians by which a drift of one turns it from period to period.
    rate: f64,
    /// Spectral values by period, in units of the channel's rms.
    values: Vec<Complex64>,
}

impl Turns {
    fn of(spectra: ArrayView3<Complex64>, lines: &[usize]) -> Self {
        let of_channel = |channel: usize| {
            let spectra = spectra.index_axis(Axis(1), channel);
            let power: f64 = spectra.iter().map(Complex64::norm_sqr).sum();
            let scale = (power / spectra.len() as f64).sqrt().max(f64::MIN_POSITIVE);
            let line = move |(place, &line): (usize, &usize)| Line {
                rate: TAU * line as f64,
                values: spectra.column(place).mapv(|value| value / scale).to_vec(),
            };
            lines.iter().enumerate().map(line).collect::<Vec<_>>()
        };
        Self {
            lines: (0..spectra.len_of(Axis(1))).flat_map(of_channel).collect(),
        }
    }

    /// `N/P - 1`.
    fn estimate(&self) -> Estimate {
        let n_periods = self.lines.first().map_or(0, |line| line.values.len());
        let mut drift = 0.0;
        let mut lag = 1;
        // each lag is twice as far, so that the turn left over by the last one stays below half
        while 2 * lag <= n_periods {
            drift += self.turn_over(lag, drift);
            lag *= 2;
        }
        let first = self.refined(drift);
        (1..STEPS).fold(first, |last, _| self.refined(last.drift))
    }

    /// Drift that is left over, from the turns over so many periods.
    fn turn_over(&self, lag: usize, drift: f64) -> f64 {
        let (mut product, mut power) = (0.0, f64::MIN_POSITIVE);
        for line in &self.lines {
            let values = line.turned_back(drift);
            let turned = zip(&values, &values[lag..]).map(|(a, b)| b * a.conj());
            let turned: Complex64 = turned.sum();
            let rate = line.rate * lag as f64;
            product += rate * turned.norm() * turned.arg();
            power += rate * rate * turned.norm();
        }
        product / power
    }

    /// A step of Gauss and Newton from a drift.
    fn refined(&self, drift: f64) -> Estimate {
        let fits: Vec<(f64, PhaseFit)> = (self.lines.iter())
            .map(|line| (line.rate, PhaseFit::of(&line.turned_back(drift))))
            .collect();
        let noise = fits.iter().map(|(_, fit)| fit.noise).sum::<f64>() / fits.len() as f64;
        let (mut product, mut power, mut variance) = (0.0, f64::MIN_POSITIVE, 0.0);
        let mut squares = f64::MIN_POSITIVE;
        for (rate, fit) in fits.iter().filter(|(_, fit)| fit.power > STRONG * noise) {
            let weight = rate * rate * fit.weight;
            product += rate * fit.slope;
            power += weight;
            squares += weight * weight;
            variance += rate * rate * fit.variance;
        }
        let is_known = power > f64::MIN_POSITIVE;
        Estimate {
            drift: drift + product / power,
            error: if is_known {
                variance.sqrt() / power
            } else {
                f64::INFINITY
            },
            n_lines: (power * power / squares).max(1.0),
        }
    }
}

impl Line {
    /// Values with the turn of a drift taken off.
    fn turned_back(&self, drift: f64) -> Vec<Complex64> {
        let back = |q: usize| Complex64::cis(-self.rate * drift * q as f64);
        zip(0.., &self.values)
            .map(|(q, value)| value * back(q))
            .collect()
    }
}

/// Straight line through the phases of a line over the periods.
struct PhaseFit {
    /// Power of the mean over the periods.
    power: f64,
    /// Noise power of a period.
    noise: f64,
    /// Slope times weight.
    slope: f64,
    /// Power of the line times the sum of squares of the period's number about its mean.
    weight: f64,
    /// Variance of slope times weight.
    variance: f64,
}

impl PhaseFit {
    fn of(values: &[Complex64]) -> Self {
        let n_periods = values.len() as f64;
        let mean = values.iter().sum::<Complex64>() / n_periods;
        let middle = 0.5 * (n_periods - 1.0);
        let about = |(q, value): (usize, &Complex64)| (q as f64 - middle, (value * mean.conj()).im);
        let across: Vec<(f64, f64)> = values.iter().enumerate().map(about).collect();
        let slope: f64 = across.iter().map(|(q, across)| q * across).sum();
        let spread: f64 = across.iter().map(|(q, _)| q * q).sum();
        let left = |(q, across): &(f64, f64)| (across - slope / spread * q).powi(2);
        // two degrees of freedom go to mean and slope
        let left = across.iter().map(left).sum::<f64>() / (n_periods - 2.0);
        let noise = values
            .iter()
            .map(|value| (value - mean).norm_sqr())
            .sum::<f64>();
        Self {
            power: mean.norm_sqr(),
            noise: noise / (n_periods - 1.0),
            slope,
            weight: spread * mean.norm_sqr(),
            variance: spread * left,
        }
    }
}

#[cfg(test)]
mod tests;
