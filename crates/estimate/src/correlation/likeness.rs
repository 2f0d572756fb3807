//! Likeness of a recording to itself one lag later, sample by sample.
//!
//! `d[k] = (x[k + T] - x[k])^2 / (2 P[k])`, P the power between the two samples: 0 on average where
//! the signal repeats, 1 where two strangers meet, and in noise.

use std::ops::Range;

use crate::correlation::channel::Channel;
use crate::correlation::lag::Lag;
use crate::correlation::local_power::LocalPower;

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
        let lag = Lag::new(period);
        let n_samples = channels.first().map_or(0, |channel| channel.values().len());
        let share = |k: usize| {
            let (difference, between) = (squared_difference(channels, &lag, k), power.from(k));
            match between > ROUNDING || difference.is_nan() {
                true => 0.5 * difference / between.max(ROUNDING),
                false => f64::INFINITY,
            }
        };
        let shares = (0..lag.n_pairs(n_samples))
            .step_by(stride)
            .map(share)
            .collect();
        Self {
            stride,
            shares,
            power,
        }
    }

    /// Share of the power that does not repeat within the places `ranges` of the shares.
    pub(crate) fn residual(&self, ranges: &[Range<usize>]) -> f64 {
        let (mut difference, mut power) = (0.0, f64::MIN_POSITIVE);
        for place in ranges.iter().cloned().flatten() {
            let share = self.shares[place];
            if share.is_finite() {
                let weight = self.power.from(place * self.stride);
                difference += share * weight;
                power += weight;
            }
        }
        difference / power
    }
}

/// Over the channels that have both samples; NaN if none has.
fn squared_difference(channels: &[Channel], lag: &Lag, k: usize) -> f64 {
    let differences = channels
        .iter()
        .map(|channel| lag.difference(channel.values(), k).powi(2));
    let present = differences.filter(|difference| !difference.is_nan());
    present.reduce(|a, b| a + b).unwrap_or(f64::NAN)
}

/// Median of the mean shares of sixteenths of a period.
pub(crate) fn quieter_half(shares: &[f64], length: f64) -> f64 {
    let part = (length / 16.0).ceil().max(1.0) as usize;
    let mean = |part: &[f64]| {
        let present: Vec<f64> = part
            .iter()
            .copied()
            .filter(|share| !share.is_nan())
            .collect();
        (!present.is_empty()).then(|| present.iter().sum::<f64>() / present.len() as f64)
    };
    let mut means: Vec<f64> = shares.chunks(part).filter_map(mean).collect();
    means.sort_unstable_by(f64::total_cmp);
    means.get(means.len() / 2).copied().unwrap_or(0.0)
}
