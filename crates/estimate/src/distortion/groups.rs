//! Levels of a signal in groups of detection lines, from the powers of its lines.

use std::iter::zip;

use frfid_signals::{DistortionLevel, SignalLevels};
use ndarray::{Array2, s};

use crate::distortion::bursts::Pairs;
use crate::distortion::detection_lines::{DetectionLines, Group};
use crate::distortion::interval::{MeanSquare, interval, interval_of_difference};
use crate::distortion::line_powers::LinePowers;

/// A signal on excited lines and on detection lines.
pub(super) struct OnLines<'a> {
    pub(super) lines: &'a DetectionLines,
    /// Frequencies of the detection lines.
    pub(super) frequency_hz: &'a [f64],
    /// Mean power of the excited lines, `(channel, line)`.
    pub(super) excited: Array2<f64>,
    pub(super) free: LinePowers,
}

impl OnLines<'_> {
    /// Levels of every channel.
    pub(super) fn levels(&self) -> Vec<SignalLevels> {
        let [odd, even] = [&self.lines.odd, &self.lines.even]
            .map(|groups| (&groups[..], self.lines.pairs(groups)));
        let levels = |channel| SignalLevels {
            odd: self.of_groups(channel, &odd),
            even: self.of_groups(channel, &even),
        };
        (0..self.excited.nrows()).map(levels).collect()
    }

    fn of_groups(&self, channel: usize, parity: &(&[Group], Pairs)) -> Vec<DistortionLevel> {
        let (groups, pairs) = parity;
        let powers = self.free.powers_of(channel, groups, pairs);
        let levels = zip(*groups, powers).map(|(group, power)| self.level(channel, group, power));
        levels.collect()
    }

    fn level(&self, channel: usize, group: &Group, power: MeanSquare) -> DistortionLevel {
        let noise = self.free.noise_of(channel, group);
        let in_power = noise.map(|[_, in_power]| in_power);
        let [low, high] = match in_power {
            Some(noise) => interval_of_difference(power, noise),
            None => interval(power),
        };
        let stands_out = in_power.is_none_or(|noise| power.stands_out_of(noise));
        let distortion = power.value - in_power.map_or(0.0, |noise| noise.value);
        let is_known = stands_out && distortion > self.rounding(channel);
        DistortionLevel {
            frequency_hz: self.centre_hz(group),
            n_lines: group.len(),
            excited: self.rms(self.excited_around(channel, group)),
            noise: noise.map(|[of_one, _]| self.rms(of_one.value)),
            level: is_known.then(|| self.rms(distortion)),
            low: self.rms(low),
            high: self.rms(high),
        }
    }

    fn rms(&self, power: f64) -> f64 {
        (power * self.lines.mean_square()).sqrt()
    }

    fn centre_hz(&self, group: &Group) -> f64 {
        let [first, last] =
            [group[0], group[group.len() - 1]].map(|place| self.frequency_hz[place]);
        (first * last).sqrt()
    }

    /// Power of the excited lines around a group.
    fn excited_around(&self, channel: usize, group: &Group) -> f64 {
        let around = self.lines.excited_within(group);
        let powers = self.excited.slice(s![channel, around]);
        powers.mean().unwrap_or(f64::NAN)
    }

    /// Power below which a channel's lines are rounding, from its strongest line.
    fn rounding(&self, channel: usize) -> f64 {
        /// Amplitudes below this share of the strongest line are rounding.
        const ROUNDING: f64 = 1e-12;
        let powers = self.excited.row(channel);
        let strongest = powers.iter().copied().fold(0.0, f64::max);
        ROUNDING * ROUNDING * strongest
    }
}
