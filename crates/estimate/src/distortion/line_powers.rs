//! Powers of the lines of a signal: of its means over periods, and of the noise around them.

use std::iter::zip;

use ndarray::Array2;
use num_complex::Complex64;

use crate::distortion::bursts::Pairs;
use crate::distortion::detection_lines::Group;
use crate::distortion::interval::MeanSquare;
use crate::spectra::campaign::Block;
use crate::spectra::run_spectra::RunSpectra;
use crate::spectra::spread::Spread;

/// Powers of a signal, `(channel, line)`, and what they rest on.
pub(super) struct LinePowers {
    /// Of the means over periods, averaged over realizations and experiments.
    pub(super) power: Array2<f64>,
    /// Means over periods of every realization and experiment.
    means: Vec<(Array2<Complex64>, usize)>,
    /// Of the noise of one period; `None` with one period.
    noise: Option<Array2<f64>>,
    /// Complex degrees of freedom of that noise.
    noise_freedom: f64,
    /// Noise of the power over that of one period.
    share: f64,
    /// Draws of phases that the power is averaged over.
    n_draws: f64,
}

/// What runs have in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Draws {
    /// Number of glides whose mean was taken off all runs.
    pub(super) n_glides: usize,
    /// Number of realizations with phases of their own.
    pub(super) n_draws: usize,
}

/// What the mean of the glides costs or adds.
struct OfGlides {
    /// Draws that it takes.
    draws: f64,
    /// Noise that it adds, over that of one period.
    noise: f64,
}

impl OfGlides {
    /// With what all realizations have in common.
    const TAKEN_OFF: Self = Self {
        draws: 1.0,
        noise: 0.0,
    };
}

impl Draws {
    /// Whether what realizations have in common is noise of glides, and is told.
    fn tell_common(self, n_realizations: usize) -> bool {
        self.n_glides > 0 && self.n_draws > 1 && self.n_draws == n_realizations
    }

    /// Noise of the glides where it is not taken off.
    fn left_of_glides(self) -> OfGlides {
        let noise = match self.n_glides {
            0 => 0.0,
            n_glides => 1.0 / n_glides as f64,
        };
        OfGlides { draws: 0.0, noise }
    }
}

impl LinePowers {
    /// Of a signal of complete blocks, by realization and period.
    pub(super) fn of<'a>(
        realizations: &[Vec<Block<'a>>],
        draws: Draws,
        signal: impl Fn(&'a RunSpectra) -> &'a Array2<Complex64>,
    ) -> Self {
        let mut spread = Spread::of(realizations, |run| Some(signal(run)));
        let of_glides = if draws.tell_common(realizations.len()) {
            take_off_common(&mut spread.means, realizations[0][0].len());
            OfGlides::TAKEN_OFF
        } else {
            draws.left_of_glides()
        };
        let noise = spread.squares / spread.freedom.max(1) as f64;
        let n_draws = draws.n_draws as f64;
        let n_free = n_draws - of_glides.draws;
        Self {
            power: mean_power(&spread.means) * (n_draws / n_free),
            noise: (spread.freedom > 0).then_some(noise),
            noise_freedom: spread.freedom as f64,
            share: mean_inverse(&spread.means) * (1.0 + of_glides.noise),
            n_draws: n_free,
            means: spread.means,
        }
    }

    /// Mean squares of a channel over the groups of one parity.
    pub(super) fn powers_of(
        &self,
        channel: usize,
        groups: &[Group],
        pairs: &Pairs,
    ) -> Vec<MeanSquare> {
        let alone = groups.iter().map(|group| self.power_of(channel, group));
        let alone = Vec::from_iter(alone);
        let shared = self.shared_variance(channel, &self.rms(groups, &alone), pairs);
        let powers = alone.into_iter();
        powers.map(|power| power.with_variance(shared)).collect()
    }

    /// Rms of the group of every line; infinite where that is silent, as of lines of no group.
    fn rms(&self, groups: &[Group], powers: &[MeanSquare]) -> Vec<f64> {
        let mut rms = vec![f64::INFINITY; self.power.ncols()];
        for (group, power) in zip(groups, powers).filter(|(_, power)| power.value > 0.0) {
            group
                .iter()
                .for_each(|&line| rms[line] = power.value.sqrt());
        }
        rms
    }

    /// Relative variance that the powers of all groups share. One realization shows less of it than there is.
    fn shared_variance(&self, channel: usize, rms: &[f64], pairs: &Pairs) -> f64 {
        let of_one =
            |(mean, _): &(Array2<Complex64>, usize)| pairs.shared_variance(mean.row(channel), rms);
        let sum: f64 = self.means.iter().map(of_one).sum();
        let of_one = (sum / self.means.len() as f64).max(0.0);
        of_one * (1.0 + 1.0 / self.n_draws) / self.n_draws
    }

    /// Mean square of a channel over a group of lines, as if these had nothing in common.
    fn power_of(&self, channel: usize, group: &[usize]) -> MeanSquare {
        let powers = Vec::from_iter(group.iter().map(|&line| self.power[[channel, line]]));
        MeanSquare {
            value: powers.iter().sum::<f64>() / powers.len() as f64,
            freedom: effective_freedom(&powers, self.n_draws),
        }
    }

    /// Noise of one period over a group of lines, and the part of [`LinePowers::power_of`] that it is.
    pub(super) fn noise_of(&self, channel: usize, group: &[usize]) -> Option<[MeanSquare; 2]> {
        let noise = self.noise.as_ref()?;
        let sum: f64 = group.iter().map(|&line| noise[[channel, line]]).sum();
        let of_one = MeanSquare {
            value: sum / group.len() as f64,
            freedom: self.noise_freedom * group.len() as f64,
        };
        let value = of_one.value * self.share;
        Some([of_one, MeanSquare { value, ..of_one }])
    }
}

type Means = [(Array2<Complex64>, usize)];

/// Takes off what all realizations of an experiment have in common: noise of the glides.
fn take_off_common(means: &mut Means, n_experiments: usize) {
    let n_realizations = (means.len() / n_experiments) as f64;
    for experiment in 0..n_experiments {
        let of_experiment = || (experiment..means.len()).step_by(n_experiments);
        let mut common = Array2::zeros(means[experiment].0.dim());
        of_experiment().for_each(|place| common += &means[place].0);
        common /= Complex64::from(n_realizations);
        for place in of_experiment() {
            means[place].0 -= &common;
        }
    }
}

/// Mean of 1 over the number of periods.
fn mean_inverse(means: &Means) -> f64 {
    let inverse = means.iter().map(|(_, n_periods)| 1.0 / *n_periods as f64);
    inverse.sum::<f64>() / means.len() as f64
}

fn mean_power(means: &Means) -> Array2<f64> {
    let power = |(mean, _): &(Array2<Complex64>, usize)| mean.mapv(|value| value.norm_sqr());
    let sum = means.iter().map(power).reduce(|sum, power| sum + power);
    sum.unwrap_or_default() / means.len() as f64
}

/// Complex degrees of freedom of the mean of exponentially distributed powers, each the mean of n draws, which need not
/// be alike: `n (sum p)^2 / sum q`, where `q = p^2 n / (n + 1)` has the mean of p squared.
fn effective_freedom(powers: &[f64], n_draws: f64) -> f64 {
    let largest = powers.iter().copied().fold(0.0, f64::max); // squares of powers need not be numbers
    let shares = powers.iter().map(|power| power / largest);
    let sum: f64 = shares.clone().sum();
    let squares: f64 = shares.map(|share| share * share).sum();
    let alike = n_draws * powers.len() as f64;
    let unlike = (n_draws + 1.0) * sum * sum / squares;
    unlike.min(alike) // the lesser of the two; NaN of silent lines is none of them
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_are_unlike_count_less() {
        assert_eq!(effective_freedom(&[1.0; 12], 10.0), 120.0);
        for unit in [1e-300, 1.0, 1e300] {
            assert!(effective_freedom(&[unit, 0.0, 0.0, 0.0], 10.0) < 11.1);
        }
        assert_eq!(effective_freedom(&[0.0; 3], 2.0), 6.0);
    }
}
