//! Trend of a run: drift and slow transients, which are alike in every period, so that the spread of
//! periods does not show them.
//!
//! A run is `x(t) = p(t) + slope t + b exp(-t/tau)` with p of the period and of any waveform. Each
//! part is accepted only where it stands out of the noise and matters to an excited line; a sound
//! run keeps every bit.

mod period_windows;
mod phase_means;
pub(crate) mod trend_model;

use std::iter::zip;

use ndarray::{Array1, ArrayView1, ArrayViewMut1, Axis};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::trend::period_windows::PeriodWindows;
use crate::trend::phase_means::{PhaseMeans, numbers};
use crate::trend::trend_model::{Decay, Model, Trendless};

/// A slope must explain this many times the noise variance: four standard deviations, 6e-5 by
/// chance.
const ONE_PARAMETER: f64 = 16.0;
/// A decay, of two parameters, must explain this many: 5e-5 by chance.
const TWO_PARAMETERS: f64 = 20.0;
/// Slope, amplitude and time constant.
const MOST_PARAMETERS: usize = 3;
/// Below this share of a line's own standard deviation a trend does no harm: the 95 % region would
/// still hold 94 %.
const MATERIAL: f64 = 0.3;
/// .. and below this share of the line itself it is rounding.
const ROUNDING: f64 = 1e-9;

/// A trend in one channel of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    /// Slope per sample; 0 where there is none.
    pub slope_per_sample: f64,
    /// A decay, if there is one.
    pub decay: Option<Decay>,
    /// What it adds to the mean spectrum over all periods, on the excited line where that is most,
    /// over the standard deviation of that line's mean.
    pub effect_over_noise: f64,
    /// What its own uncertainty adds to the variance of a line's mean, as a share of that, on the
    /// excited line where it is most.
    pub variance_share: f64,
}

impl Trend {
    /// Takes the trend off the channel and run in which it was found, its mean left in place.
    pub fn subtract_from(&self, mut run: ArrayViewMut1<f64>) {
        let middle = 0.5 * (run.len() as f64 - 1.0);
        for (k, value) in run.iter_mut().enumerate() {
            *value -= self.at(k as f64, middle);
        }
    }

    fn at(&self, time: f64, middle: f64) -> f64 {
        let decay = self.decay.map_or(0.0, |decay| {
            decay.amplitude * (-time / decay.time_constant_samples).exp()
        });
        self.slope_per_sample * (time - middle) + decay
    }
}

/// The trend of a run of one channel from its first used period on; samples that are not numbers are
/// left out. The period is so many samples, not necessarily whole; `lines` are those excited.
///
/// `None` where none stands out and matters, and with less than two periods. Of three periods or more
/// the 95 % region of a line holds as it should once the trend is off (91 % at worst, three periods,
/// for trends just too small to be found); two periods do not tell a decay well enough (90 %).
///
/// # Errors
/// [`frfid_signals::SignalError::Shape`] for a period longer than the run or shorter than three
/// samples, those of [`LineDft::new`](crate::LineDft::new).
pub fn find_trend(
    run: ArrayView1<f64>,
    period: f64,
    lines: &[usize],
) -> Result<Option<Trend>, EstimateError> {
    let windows = PeriodWindows::new(run.len(), period, lines)?;
    let phases = PhaseMeans::of(run, period);
    if windows.n_periods < 2 || phases.n_free <= MOST_PARAMETERS {
        return Ok(None);
    }
    let search = Search {
        trendless: Trendless::of(run, &phases),
        phases: &phases,
        windows: &windows,
    };
    let (model, variance) = search.select()?;
    if model.n_parameters == 0 {
        return Ok(None);
    }
    search.rate(run, &model, variance)
}

/// What models are chosen by.
struct Search<'a> {
    trendless: Trendless<'a>,
    phases: &'a PhaseMeans,
    windows: &'a PeriodWindows,
}

impl Search<'_> {
    /// The model with the most parameters that each stand out, and the noise variance that it leaves.
    fn select(&self) -> Result<(Model, f64), EstimateError> {
        let nothing = self.trendless.nothing();
        let slope = self.trendless.slope();
        let mut best = self.better(nothing, slope)?;
        for (with_slope, time_constant) in zip([false, true], self.time_constants()) {
            let decay = self.trendless.decay(time_constant, with_slope);
            best = self.better(best, decay)?;
        }
        let variance = self.variance(&best)?;
        Ok((best, variance))
    }

    /// Of the decay that explains most alone and of the one beside a slope, looked for among means over
    /// parts of a period.
    fn time_constants(&self) -> [f64; 2] {
        let length = self.phases.part_length();
        let condensed = self.phases.condensed(&self.trendless.values);
        let phases = PhaseMeans::of(condensed.view(), self.windows.period / length);
        let trendless = Trendless::of(condensed.view(), &phases);
        [false, true].map(|with_slope| length * trendless.time_constant(with_slope))
    }

    /// The larger model if it explains enough more than the smaller one.
    fn better(&self, small: Model, large: Model) -> Result<Model, EstimateError> {
        let gain = small.squares() - large.squares();
        let needed = match large.n_parameters - small.n_parameters {
            0 => 0.0,
            1 => ONE_PARAMETER,
            _ => TWO_PARAMETERS,
        };
        let stands_out = gain > needed * self.variance(&large)?;
        Ok(if stands_out { large } else { small })
    }

    /// Noise variance of a sample as a slow trend meets it.
    fn variance(&self, model: &Model) -> Result<f64, EstimateError> {
        let slow = self.windows.slow_variance(&self.phases.times, model)?;
        Ok(slow.max(model.variance(self.phases.n_free)))
    }

    /// The trend, if it matters.
    fn rate(
        &self,
        run: ArrayView1<f64>,
        model: &Model,
        variance: f64,
    ) -> Result<Option<Trend>, EstimateError> {
        let times: Vec<f64> = (0..run.len()).map(|k| k as f64).collect();
        let mut trend = Trend {
            slope_per_sample: model.slope,
            decay: model.decay,
            effect_over_noise: 0.0,
            variance_share: 0.0,
        };
        let values: Vec<f64> = times.iter().map(|&time| trend.at(time, 0.0)).collect();
        let effect = self.mean_spectrum(&times, &values)?;
        let noise = self.variance_of_mean(model)?;
        trend.effect_over_noise = largest_ratio(&effect, &noise, &self.signal(run)?);
        if trend.effect_over_noise < MATERIAL {
            return Ok(None);
        }
        trend.variance_share = self.variance_share(model, variance, &times, &noise)?;
        Ok(Some(trend))
    }

    /// Mean spectrum of the run as it is.
    fn signal(&self, run: ArrayView1<f64>) -> Result<Array1<Complex64>, EstimateError> {
        self.mean_spectrum(&self.phases.times, &numbers(run))
    }

    /// What the uncertainty of a model adds to the variance of a line's mean, as a share of that.
    fn variance_share(
        &self,
        model: &Model,
        variance: f64,
        times: &[f64],
        noise: &Array1<f64>,
    ) -> Result<f64, EstimateError> {
        let mut added = Array1::<f64>::zeros(noise.len());
        for values in self.trendless.uncertainty(model, times) {
            let spectrum = self.mean_spectrum(times, &values)?;
            added += &spectrum.mapv(|value| variance * value.norm_sqr());
        }
        // the spread over few periods is small by chance on one line or the other
        let usual = noise.mean().unwrap_or(0.0);
        let share = zip(&added, noise).map(|(added, noise)| added / noise.max(usual));
        Ok(share.fold(0.0, f64::max))
    }

    /// Mean over the periods of the spectra on the excited lines.
    fn mean_spectrum(
        &self,
        times: &[f64],
        values: &[f64],
    ) -> Result<Array1<Complex64>, EstimateError> {
        let spectra = self.windows.spectra(times, values)?;
        Ok(spectra.mean_axis(Axis(0)).unwrap_or_default())
    }

    /// Variance of that mean by the spread over periods.
    fn variance_of_mean(&self, model: &Model) -> Result<Array1<f64>, EstimateError> {
        let spectra = self.windows.spectra(&self.phases.times, &model.residual)?;
        let n = self.windows.n_periods as f64;
        Ok(spectra.mapv(|value| value.norm_sqr()).sum_axis(Axis(0)) / (n * (n - 1.0)))
    }
}

/// Effect over the standard deviation of the noise on the line where that is most, where it is more
/// than rounding of the signal.
fn largest_ratio(
    effect: &Array1<Complex64>,
    noise: &Array1<f64>,
    signal: &Array1<Complex64>,
) -> f64 {
    let lines = zip(effect, zip(noise, signal));
    let lines = lines.filter(|(effect, (_, signal))| effect.norm() > ROUNDING * signal.norm());
    lines
        .map(|(effect, (noise, _))| effect.norm() / noise.sqrt())
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
