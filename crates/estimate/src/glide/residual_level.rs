//! Residual of ripple against noise on free lines, over the references of a campaign.
//!
//! Over the n_q repetitions of each of R references the noise differs, what remains of ripple (and
//! other distortion by the machine) does not. With the means X_r over repetitions, s^2 the noise of one
//! run, and n free lines h around an excited line
//!
//! ```text
//! C = mean over h, r of |X_r(h)|^2                     what repeats, and noise of the means
//! N = a + b,   a = s^2/n_q,   b = s_g^2/n_g            noise of the means, of the mean of n_g glides
//! ```
//!
//! The glides' noise is in every run: with b left out it would be told as ripple. s_g^2 is the spread of
//! the glides, with one glide s^2. E C = residual^2 + N, so residual^2 = C - N, floored at 0. Without a
//! residual C/N is about F-distributed: N has `(a + b)^2 / (a^2/nu_a + b^2/nu_b)` complex degrees of
//! freedom, and C, in which b is one and the same for all references, has
//! `n R^2 (a + b)^2 / ((R - 1) a^2 + (a + R b)^2)`. (Sample mean and variance over periods:
//! R. Pintelon, J. Schoukens, System Identification, 2nd ed., ch. 2 and 4.)

use std::iter::zip;

use ndarray::{Array2, ArrayView1, Zip};
use num_complex::Complex64;

use crate::frf::f_distribution::f_tail;
use crate::glide::ripple_residual::FreeLines;

/// Chance that a campaign without any residual has a line that is flagged.
const FALSE_ALARM: f64 = 0.05;

/// Coherent part and noise around every excited line, as squared single-sided amplitudes (2|X|/N)^2
/// in the signal's unit, `(channel, excited line)`; both of the mean over the repetitions.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualLevel {
    /// C: what repeats, with the noise on top.
    pub coherent_power: Array2<f64>,
    /// N: the noise of the mean over the repetitions, and of the mean glide.
    pub noise_power: Array2<f64>,
    /// Chance that noise alone makes C so large.
    pub chance: Array2<f64>,
}

/// Spectra of the repetitions of a reference.
type Repetitions = Vec<Array2<Complex64>>;

impl ResidualLevel {
    /// Of references that are all repeated, at least one.
    pub(crate) fn of(
        lines: &FreeLines,
        references: &[&Repetitions],
        glides: &[Array2<Complex64>],
    ) -> Self {
        let all: Vec<Spread> = references.iter().map(|one| Spread::of(one)).collect();
        let mean = |power: &dyn Fn(&Spread) -> Array2<f64>| {
            let sum = all.iter().map(power).reduce(|sum, power| sum + power);
            lines.around(&(sum.unwrap_or_default() / all.len() as f64))
        };
        let coherent_power = mean(&Spread::power_of_mean);
        let of_runs = mean(&Spread::noise_of_mean);
        let of_glides = match glides.len() {
            0 => Array2::zeros(of_runs.dim()),
            1 => mean(&Spread::noise_of_one),
            _ => lines.around(&Spread::of(glides).noise_of_mean()),
        };
        let freedom = FreeLinesFreedom {
            references: all.len() as f64,
            runs: all.iter().map(Spread::freedom).sum(),
            glides: (glides.len() > 1).then_some(glides.len() as f64 - 1.0),
        };
        let chance = freedom.chance(&lines.n_neighbours(), &coherent_power, &of_runs, &of_glides);
        Self {
            coherent_power,
            noise_power: of_runs + of_glides,
            chance,
        }
    }

    /// Amplitude of the residual over that of the noise, `sqrt((C - N)/N)` floored at 0, `(channel,
    /// excited line)`; infinite where a residual stands out of no noise at all.
    #[must_use]
    pub fn ratio(&self) -> Array2<f64> {
        let mut ratio = &self.coherent_power - &self.noise_power;
        ratio.zip_mut_with(&self.noise_power, |excess, noise| {
            *excess = if *excess > 0.0 {
                (*excess / noise).sqrt()
            } else {
                0.0
            };
        });
        ratio
    }

    /// Whether the residual exceeds the noise in any channel, per excited line: there the
    /// uncertainty that repetitions show is not the whole error. By chance no line at all is flagged in
    /// 19 of 20 campaigns without a residual.
    #[must_use]
    pub fn exceeds_noise(&self) -> Vec<bool> {
        let most = FALSE_ALARM / self.chance.len() as f64;
        let mut exceeds = self.ratio().mapv(|ratio| ratio > 1.0);
        exceeds.zip_mut_with(&self.chance, |exceeds, &chance| {
            *exceeds &= chance <= most;
        });
        let lines = exceeds.columns().into_iter();
        lines
            .map(|channels| channels.iter().any(|&exceeds| exceeds))
            .collect()
    }
}

/// Spectra about their mean.
struct Spread {
    mean: Array2<Complex64>,
    /// `sum |X_q - X|^2`.
    squares: Array2<f64>,
    n: f64,
}

impl Spread {
    /// Of at least one, all of one shape.
    fn of(spectra: &[Array2<Complex64>]) -> Self {
        let n = spectra.len() as f64;
        let mut mean = Array2::zeros(spectra[0].dim());
        spectra.iter().for_each(|spectra| mean += spectra);
        mean /= Complex64::from(n);
        let mut squares = Array2::zeros(mean.dim());
        for spectra in spectra {
            Zip::from(&mut squares).and(spectra).and(&mean).for_each(
                |squares: &mut f64, value: &Complex64, mean: &Complex64| {
                    *squares += (value - mean).norm_sqr();
                },
            );
        }
        Self { mean, squares, n }
    }

    fn freedom(&self) -> f64 {
        self.n - 1.0
    }

    fn power_of_mean(&self) -> Array2<f64> {
        self.mean.mapv(|value| value.norm_sqr())
    }

    fn noise_of_one(&self) -> Array2<f64> {
        &self.squares / self.freedom()
    }

    fn noise_of_mean(&self) -> Array2<f64> {
        self.noise_of_one() / self.n
    }
}

/// Degrees of freedom on a free line.
struct FreeLinesFreedom {
    references: f64,
    runs: f64,
    /// `None` where the runs tell the noise of the glides, too.
    glides: Option<f64>,
}

impl FreeLinesFreedom {
    /// Chance of C by noise alone, `(channel, excited line)`.
    fn chance(
        &self,
        n_neighbours: &[usize],
        coherent: &Array2<f64>,
        of_runs: &Array2<f64>,
        of_glides: &Array2<f64>,
    ) -> Array2<f64> {
        let shares: Vec<f64> = zip(of_runs.rows(), of_glides.rows())
            .map(|(a, b)| share_of_glides(a, b))
            .collect();
        let noise = of_runs + of_glides;
        Array2::from_shape_fn(coherent.dim(), |(channel, line)| {
            let place = [channel, line];
            let ratio = coherent[place] / noise[place];
            self.chance_of(n_neighbours[line] as f64, ratio, shares[channel])
        })
    }

    /// Chance of a ratio C/N; NaN, of nothing over nothing, is none.
    fn chance_of(&self, n: f64, ratio: f64, b: f64) -> f64 {
        if !ratio.is_finite() {
            return if ratio > 0.0 { 0.0 } else { 1.0 };
        }
        let (references, a) = (self.references, 1.0 - b);
        let squares = (references - 1.0) * a * a + (a + references * b).powi(2);
        let of_coherent = n * references * references / squares;
        let of_noise = match self.glides {
            None => self.runs,
            Some(glides) => 1.0 / (a * a / self.runs + b * b / glides),
        };
        f_tail(ratio, of_coherent.round() as usize, n * of_noise)
    }
}

/// Share of the glides in the noise of a channel, `b/(a + b)`: the mean ratio of all lines, since that of
/// a line has few degrees of freedom and would be least where C/N is largest by chance.
fn share_of_glides(of_runs: ArrayView1<f64>, of_glides: ArrayView1<f64>) -> f64 {
    let ratios = zip(of_runs, of_glides).map(|(a, b)| b / a);
    let ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
    mean / (1.0 + mean)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::f64::consts::TAU;

    use frfid_signals::random::{normal, stream};

    use super::*;
    use crate::spectra::Transform;

    const SAMPLES: usize = 4096;
    const REPETITIONS: u64 = 5;

    fn excited() -> Vec<usize> {
        let odd = |k| (25.0 * 20f64.powf(f64::from(k) / 59.0) / 2.0) as usize * 2 + 1;
        (0..60)
            .map(odd)
            .collect::<BTreeSet<_>>()
            .into_iter()
            .collect()
    }

    /// Two channels of white noise of rms 1, the mean of `n_glides` more subtracted, the second channel
    /// with a residual on a free line.
    fn level(
        residual: f64,
        free_line: usize,
        n_references: u64,
        n_glides: u64,
        seed: u64,
    ) -> ResidualLevel {
        let lines = FreeLines::new(SAMPLES, &excited(), 12).expect("sound");
        let noise = |name: &str, indices: &[u64]| {
            let mut rng = stream(seed, name, indices);
            Array2::from_shape_simple_fn((2, SAMPLES), || normal(&mut rng))
        };
        let spectrum = |signal: Array2<f64>| lines.transform("y", signal.view()).expect("fits");
        let ripple = Array2::from_shape_fn((2, SAMPLES), |(channel, k)| {
            let angle = TAU * (free_line * k % SAMPLES) as f64 / SAMPLES as f64;
            channel as f64 * residual * (angle + free_line as f64).sin()
        });
        let ripple = spectrum(ripple);
        let glides: Vec<_> = (0..n_glides)
            .map(|glide| spectrum(noise("glide", &[glide])))
            .collect();
        let reference = |reference: u64| {
            let run = |repetition: u64| {
                let run = spectrum(noise("run", &[reference, repetition])) + &ripple;
                let share = Complex64::from(1.0 / n_glides.max(1) as f64);
                glides.iter().fold(run, |run, glide| run - glide * share)
            };
            (0..REPETITIONS).map(run).collect()
        };
        let references: Vec<Vec<_>> = (0..n_references).map(reference).collect();
        lines.level(&references, &glides).expect("repeated")
    }

    #[test]
    fn the_level_is_that_of_the_residual_and_of_the_noise() {
        // one of the twelve lines around its excited neighbour holds all of the residual
        let (residual, line) = (0.3, 100);
        let level = level(residual, line, 1, 0, 1);
        let index = excited().partition_point(|&other| other < line);
        let noise_power = 4.0 / (SAMPLES as f64 * REPETITIONS as f64); // variance of 2|X|/N for white noise of rms 1
        let mean_noise = level.noise_power.mean().expect("not empty");
        assert!(
            (mean_noise / noise_power - 1.0).abs() < 0.05,
            "{mean_noise:e} against {noise_power:e}"
        );
        let excess = level.coherent_power[[1, index]] - noise_power;
        assert!(
            (excess * 12.0 / (residual * residual) - 1.0).abs() < 0.1,
            "{excess:e}"
        );
        let ratio = level.ratio();
        let expected = residual / (12.0 * noise_power).sqrt();
        assert!(
            (ratio[[1, index]] / expected - 1.0).abs() < 0.3,
            "{} against {expected}",
            ratio[[1, index]]
        );
        let flagged = level.exceeds_noise();
        assert!(flagged[index] && flagged.iter().filter(|&&flag| flag).count() < 10);
    }

    /// The noise of the glides is one and the same in all references, and no ripple: of 120
    /// campaigns 6 may have a flag.
    #[test]
    fn noise_alone_is_not_flagged_with_any_number_of_glides() {
        for (n_glides, n_references) in [(0, 1), (1, 1), (1, 6), (2, 3), (5, 6)] {
            let levels = (0..120).map(|seed| level(0.0, 100, n_references, n_glides, seed));
            let levels: Vec<ResidualLevel> = levels.collect();
            let flagged = levels
                .iter()
                .filter(|level| level.exceeds_noise().contains(&true))
                .count();
            let (coherent, noise) = levels.iter().fold((0.0, 0.0), |(c, n), level| {
                (c + level.coherent_power.sum(), n + level.noise_power.sum())
            });
            println!(
                "{n_glides} glides, {n_references} references: {flagged} of 120, C/N {:.3}",
                coherent / noise
            );
            assert!(flagged <= 13 && (coherent / noise - 1.0).abs() < 0.1);
        }
    }

    /// Chances without a residual are chances: a tenth of them below a tenth.
    #[test]
    fn chances_of_noise_are_uniform() {
        for n_glides in [1, 3] {
            let levels = (0..30).map(|seed| level(0.0, 100, 4, n_glides, seed).chance);
            let chances: Vec<f64> = levels.flatten().collect();
            for bound in [0.02, 0.1, 0.5] {
                let below = chances.iter().filter(|&&chance| chance <= bound).count() as f64;
                let share = below / chances.len() as f64;
                assert!(
                    (share / bound - 1.0).abs() < 0.45,
                    "{n_glides}: {share} below {bound}"
                );
            }
        }
    }
}
