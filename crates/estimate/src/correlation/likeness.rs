//! Likeness of a recording to itself one lag later, sample by sample.
//!
//! `d[k] = (x[k + T] - x[k])^2 / (2 P[k])`, P the power between the two samples: 0 on average where
//! the signal repeats, 1 where two strangers meet, and in noise.

use std::ops::Range;

use crate::correlation::channel::{Channel, present};
use crate::correlation::lag::Lag;
use crate::correlation::local_power::LocalPower;
use frfid_signals::median;

/// Power below this share of that of the channel is rounding.
const ROUNDING: f64 = 1e-12;

/// The shares `d[k]` of every `stride`-th sample; NaN where a sample is lost, infinite where nothing
/// moves.
pub(crate) struct Likeness {
    pub(crate) stride: usize,
    pub(crate) shares: Vec<f64>,
    pub(crate) power: LocalPower,
}

impl Likeness {
    /// Compares `channels` with themselves `period` samples later.
    pub(crate) fn new(channels: &[Channel], period: f64, stride: usize) -> Self {
        let power = LocalPower::new(channels, period.round() as usize, stride);
        Self {
            stride,
            shares: shares(channels, &Lag::new(period), &power, stride),
            power,
        }
    }

    /// Share of the power that does not repeat within the places `ranges` of the shares.
    pub(crate) fn residual(&self, ranges: &[Range<usize>]) -> f64 {
        let (mut difference, mut power) = (0.0, f64::MIN_POSITIVE);
        for place in self.known_places(ranges) {
            let weight = self.power.from(place * self.stride);
            difference += self.shares[place] * weight;
            power += weight;
        }
        difference / power
    }

    /// Mean power around the places of a stretch.
    pub(crate) fn mean_power(&self, stretch: &Range<usize>) -> f64 {
        let samples = stretch.start * self.stride..stretch.end * self.stride;
        self.power.mean(&samples)
    }

    /// Places within `ranges` whose share is known.
    fn known_places(&self, ranges: &[Range<usize>]) -> impl Iterator<Item = usize> {
        let places = ranges.iter().cloned().flatten();
        places.filter(|&place| self.shares[place].is_finite())
    }
}

/// `difference / (2 power)`, infinite where nothing moves.
fn share(difference: f64, power: f64) -> f64 {
    if power > ROUNDING || difference.is_nan() {
        0.5 * difference / power.max(ROUNDING)
    } else {
        f64::INFINITY
    }
}

fn shares(channels: &[Channel], lag: &Lag, power: &LocalPower, stride: usize) -> Vec<f64> {
    let n_pairs = lag.n_pairs(Channel::n_samples(channels));
    let share = |k| share(squared_difference(channels, lag, k), power.from(k));
    (0..n_pairs).step_by(stride).map(share).collect()
}

/// Over the channels that have both samples; NaN if none has.
fn squared_difference(channels: &[Channel], lag: &Lag, k: usize) -> f64 {
    let squared = |channel: &Channel| lag.difference(channel.values(), k).powi(2);
    sum_present(channels.iter().map(squared))
}

fn sum_present(values: impl Iterator<Item = f64>) -> f64 {
    let present = values.filter(|value| !value.is_nan());
    present.reduce(|a, b| a + b).unwrap_or(f64::NAN)
}

/// Median of the mean shares of sixteenths of a period.
pub(crate) fn quieter_half(shares: &[f64], length: f64) -> f64 {
    let part = (length / 16.0).ceil().max(1.0) as usize;
    let means = shares.chunks(part).filter_map(mean_present);
    median(means.collect()).unwrap_or(0.0)
}

/// Mean of the shares that are there.
fn mean_present(shares: &[f64]) -> Option<f64> {
    let count = present(shares).count();
    (count > 0).then(|| present(shares).sum::<f64>() / count as f64)
}
