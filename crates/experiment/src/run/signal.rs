//! Signal of channels: what a reference reaches, against their limits.

use std::iter::zip;

use frfid_signals::format::significant;
use frfid_signals::power::{about_mean, crest_factor, rms, sample_peak};
use frfid_signals::{Injection, Limit, Run, largest_by_axis};
use ndarray::{Array2, Axis};
use serde::Serialize;

use crate::description::limits::{MAX_INPUT, MAX_INPUT_RATE};
use crate::description::text::ConfigError;
use crate::experiment::Experiment;
use crate::run::fading::fading_advice;
use crate::run::load::larger;

/// A limit that is only touched, but for rounding, is kept.
const ROUNDING: f64 = 1e-9;

/// What the references of a plan reach at most, sample by sample, one value for each channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SignalPeaks {
    /// Largest value, in the unit of the channel.
    pub peak: Vec<f64>,
    /// Largest change from one sample of a run to the next, from and to rest included, in that unit
    /// per second.
    pub rate: Vec<f64>,
    /// Crest factor about the mean, peak over rms of the same run.
    pub crest_factor: Vec<f64>,
}

impl SignalPeaks {
    /// Those of one run.
    pub(crate) fn of(run: &Run, injection: Injection) -> Self {
        Self {
            peak: largest_by_axis(&run.reference),
            rate: run.steepest_per_s(injection),
            crest_factor: crest_factors(&run.reference),
        }
    }

    pub(crate) fn larger(self, other: Self) -> Self {
        Self {
            peak: larger(&self.peak, &other.peak),
            rate: larger(&self.rate, &other.rate),
            crest_factor: larger(&self.crest_factor, &other.crest_factor),
        }
    }

    /// The values that a limit bounds, by its key.
    fn bounded_by(&self, key: &str) -> &[f64] {
        if key == MAX_INPUT_RATE {
            &self.rate
        } else {
            &self.peak
        }
    }
}

/// Crest factor of every channel about its mean.
fn crest_factors(reference: &Array2<f64>) -> Vec<f64> {
    let channels = reference.axis_iter(Axis(0)).map(about_mean);
    channels
        .map(|channel| crest_factor(sample_peak(&channel), rms(&channel)))
        .collect()
}

/// A limit that a signal exceeds.
struct SignalExcess {
    key: &'static str,
    channel: usize,
    found: f64,
    allowed: f64,
}

impl SignalExcess {
    fn factor(&self) -> f64 {
        self.allowed / self.found
    }
}

impl Experiment {
    /// The limits of the signal of channels: key and value of each, in the unit of the channel, or that per second.
    pub fn signal_limits(&self) -> impl Iterator<Item = (&'static str, &[f64])> {
        self.config.limits.of_signal()
    }

    /// Refuses a signal beyond its limits.
    ///
    /// # Errors
    /// [`ConfigError`] at the limit that binds most, with the factor that keeps it.
    pub fn check_signal(&self, peaks: &SignalPeaks) -> Result<(), ConfigError> {
        let excesses = self
            .signal_limits()
            .flat_map(|limit| excesses(limit, peaks));
        let binding = excesses.min_by(|a, b| a.factor().total_cmp(&b.factor()));
        binding.map_or(Ok(()), |excess| Err(self.beyond(&excess, peaks)))
    }

    fn beyond(&self, excess: &SignalExcess, peaks: &SignalPeaks) -> ConfigError {
        let &SignalExcess { key, channel, .. } = excess;
        let units = self.reference_units();
        let per = if key == MAX_INPUT { "" } else { " per s" };
        let [found, allowed] = [excess.found, excess.allowed].map(|value| significant(value, 4));
        // rounded down, so that the advice is inside the limit
        let factor = (excess.factor() * 1000.0).floor() / 1000.0;
        let smaller = zip(&peaks.peak, &units)
            .map(|(peak, unit)| format!("{} {unit}", significant(factor * peak, 3)));
        let smaller = smaller.collect::<Vec<_>>().join(", ");
        let (name, unit) = (&self.joint_names[channel], &units[channel]);
        let fading = fading_advice(&self.plan, Limit::TorqueRate)
            .filter(|_| key == MAX_INPUT_RATE)
            .map(|advice| format!("; {advice}"))
            .unwrap_or_default();
        let message = format!(
            "{name} would reach {found} {unit}{per}, {key} is {allowed} {unit}{per}; multiply the amplitudes by {factor} or \
             less (to {smaller}), or raise the limit{fading}"
        );
        self.text.error(&["limits", key], message)
    }
}

/// The channels beyond a limit.
fn excesses<'a>(
    (key, allowed): (&'static str, &'a [f64]),
    peaks: &'a SignalPeaks,
) -> impl Iterator<Item = SignalExcess> + 'a {
    let channels = zip(peaks.bounded_by(key), allowed).enumerate();
    let excesses = channels.map(move |(channel, (&found, &allowed))| SignalExcess {
        key,
        channel,
        found,
        allowed,
    });
    excesses.filter(|excess| excess.found > excess.allowed * (1.0 + ROUNDING))
}
