//! Residual of ripple after the glide was subtracted, seen on the lines that a multisine leaves free.
//!
//! Around every excited line s stand free lines h, on which a linear machine answers with noise
//! alone. Over the n_q repetitions of one reference the noise differs, what remains of ripple (and
//! other distortion by the machine) does not:
//!
//! ```text
//! C(s) = mean over h of |X(h)|^2,   X = 1/n_q sum_q X_q                    coherent part and noise of the mean
//! N(s) = mean over h of sum_q |X_q(h) - X(h)|^2 / (n_q (n_q - 1))          noise of the mean alone
//! ```
//!
//! E C = residual^2 + N, so residual^2 = C - N, floored at 0. Without a residual C/N is
//! F-distributed with 2 n and 2 n (n_q - 1) degrees of freedom, n the number of free lines: with n
//! = 12 and n_q = 5 it exceeds 2, which is where the residual is taken to exceed the noise, in 1
//! line of 100. (Sample mean and variance over periods: R. Pintelon, J. Schoukens, System
//! Identification, 2nd ed., ch. 2 and 4.)

use std::collections::BTreeSet;

use frfid_signals::checks::require_shape;
use frfid_signals::{Frf, SignalError};
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::Transform;
use crate::spectra::line_dft::LineDft;

/// The free lines around the excited lines of a period; found once, used for every run.
#[derive(Clone)]
pub struct FreeLines {
    dft: LineDft,
    excited: Vec<usize>,
    /// Per excited line the places of its neighbours among the lines of the DFT.
    neighbours: Vec<Vec<usize>>,
}

/// Coherent part and noise around every excited line, as squared single-sided amplitudes (2|X|/N)^2
/// in the signal's unit, `(channel, excited line)`; both of the mean over the repetitions.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualLevel {
    /// C(s): what repeats, with the noise of the mean on top.
    pub coherent_power: Array2<f64>,
    /// N(s): the noise of the mean.
    pub noise_power: Array2<f64>,
}

impl FreeLines {
    /// The `n_neighbours` free lines nearest to each of the `excited` lines (which rise) of a
    /// period of `n_samples`.
    ///
    /// # Errors
    /// As [`LineDft::new`]; [`EstimateError::EmptyList`] if no line is free, or none was asked for.
    pub fn new(
        n_samples: usize,
        excited: &[usize],
        n_neighbours: usize,
    ) -> Result<Self, EstimateError> {
        LineDft::new(n_samples, excited)?;
        let around = nearest_free(n_samples, excited, n_neighbours);
        let lines: BTreeSet<usize> = around.iter().flatten().copied().collect();
        if lines.is_empty() {
            return Err(EstimateError::EmptyList("lines that are not excited"));
        }
        let lines: Vec<usize> = lines.into_iter().collect();
        let place = |line: usize| lines.partition_point(|&other| other < line);
        let neighbours = around
            .into_iter()
            .map(|around| around.into_iter().map(place).collect())
            .collect();
        Ok(Self {
            dft: LineDft::new(n_samples, &lines)?,
            excited: excited.to_vec(),
            neighbours,
        })
    }

    /// What of y on the free lines the plant does not explain by u: `E(h) = Y(h) - G(h) U(h)`,
    /// `(output, free line)`, from spectra that [`Transform::transform`] made of one period; G is
    /// interpolated between the excited lines, where `plant` stands. Ripple moves the machine on
    /// free lines too, and y answers to the corrected u as to any other: only E disturbs.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError::Shape`] if the spectra or the plant have other lines or channels.
    pub fn unexplained(
        &self,
        u: &Array2<Complex64>,
        y: &Array2<Complex64>,
        plant: &Frf,
    ) -> Result<Array2<Complex64>, EstimateError> {
        let (n_outputs, n_inputs, n_lines) = (plant.n_outputs(), plant.n_inputs(), self.n_lines());
        check_dim("u on free lines", u, (n_inputs, n_lines))?;
        check_dim("y on free lines", y, (n_outputs, n_lines))?;
        let n_excited = self.excited.len();
        let fits = plant.n_frequencies() == n_excited;
        let needed = format_args!("({n_excited}, output, input), the excited lines");
        require_shape("plant", plant.response.shape(), fits, needed)?;
        Ok(Array2::from_shape_fn(
            (n_outputs, n_lines),
            |(output, place)| y[[output, place]] - self.explained(u, plant, output, place),
        ))
    }

    /// What of an output on a free line the plant explains by u: G U.
    fn explained(
        &self,
        u: &Array2<Complex64>,
        plant: &Frf,
        output: usize,
        place: usize,
    ) -> Complex64 {
        let (below, above, share) = self.between(self.dft.lines()[place]);
        let response = |input: usize| {
            let [low, high] = [below, above].map(|line| plant.response[[line, output, input]]);
            low + (high - low) * share
        };
        (0..plant.n_inputs())
            .map(|input| response(input) * u[[input, place]])
            .sum()
    }

    /// The excited lines below and above a line, by their place, and where it stands between them;
    /// the nearest beyond the ends.
    fn between(&self, line: usize) -> (usize, usize, f64) {
        let above = self.excited.partition_point(|&excited| excited < line);
        match above {
            0 => (0, 0, 0.0),
            above if above == self.excited.len() => (above - 1, above - 1, 0.0),
            above => {
                let (low, high) = (self.excited[above - 1] as f64, self.excited[above] as f64);
                (above - 1, above, (line as f64 - low) / (high - low))
            }
        }
    }

    /// Levels from spectra of the repetitions of one reference, of [`Transform::transform`] or
    /// [`FreeLines::unexplained`]: same realization, same experiment, glide subtracted.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError`] for fewer than two repetitions, and if they differ in shape.
    pub fn level(&self, repetitions: &[Array2<Complex64>]) -> Result<ResidualLevel, EstimateError> {
        let n_q = repetitions.len() as f64;
        let [first, _, ..] = repetitions else {
            return Err(EstimateError::parameter(
                "repetitions of one reference",
                n_q,
                "2 or more, or what repeats cannot be told from noise",
            ));
        };
        let mut sum = Array2::zeros(first.dim());
        for spectra in repetitions {
            if spectra.dim() != first.dim() || spectra.ncols() != self.n_lines() {
                let needed = format!("({}, {}), as the first", first.nrows(), self.n_lines());
                let name = "spectra of a repetition";
                return Err(EstimateError::shape(name, spectra.shape(), needed));
            }
            sum += spectra;
        }
        let mean = sum / Complex64::from(n_q);
        let scatter = scatter(repetitions, &mean);
        Ok(ResidualLevel {
            coherent_power: self.around(&mean.mapv(|value| value.norm_sqr())),
            noise_power: self.around(&(scatter / (n_q * (n_q - 1.0)))),
        })
    }

    /// Mean over the neighbours of every excited line, from |X|^2 to squared amplitudes.
    fn around(&self, power: &Array2<f64>) -> Array2<f64> {
        let scale = 4.0 / (self.dft.n_samples() as f64).powi(2);
        Array2::from_shape_fn((power.nrows(), self.neighbours.len()), |(channel, line)| {
            let around = &self.neighbours[line];
            let sum: f64 = around.iter().map(|&place| power[[channel, place]]).sum();
            scale * sum / around.len() as f64
        })
    }

    fn n_lines(&self) -> usize {
        self.dft.lines().len()
    }
}

/// Of every excited line the free lines nearest to it, near ones first.
fn nearest_free(n_samples: usize, excited: &[usize], n_neighbours: usize) -> Vec<Vec<usize>> {
    let taken: BTreeSet<usize> = excited.iter().copied().collect();
    let free = |line: &usize| !taken.contains(line);
    let nearest = |&line: &usize| {
        let below = (1..line).rev().filter(free).take(n_neighbours);
        let above = line + 1..=(n_samples - 1) / 2;
        let above = above.filter(free).take(n_neighbours);
        let mut around: Vec<usize> = below.chain(above).collect();
        around.sort_by_key(|&other| other.abs_diff(line));
        around.truncate(n_neighbours);
        around
    };
    excited.iter().map(nearest).collect()
}

/// `sum_q |X_q - X|^2` about the mean X.
fn scatter(spectra: &[Array2<Complex64>], mean: &Array2<Complex64>) -> Array2<f64> {
    let mut scatter = Array2::zeros(mean.dim());
    for spectra in spectra {
        scatter.zip_mut_with(&(spectra - mean), |scatter, deviation| {
            *scatter += deviation.norm_sqr();
        });
    }
    scatter
}

fn check_dim(
    name: &'static str,
    found: &Array2<Complex64>,
    needed: (usize, usize),
) -> Result<(), SignalError> {
    let fits = found.dim() == needed;
    require_shape(name, found.shape(), fits, format_args!("{needed:?}"))
}

impl Transform for FreeLines {
    fn transform(
        &self,
        name: &'static str,
        period: ArrayView2<f64>,
    ) -> Result<Array2<Complex64>, EstimateError> {
        self.dft.transform(name, period)
    }
}

impl ResidualLevel {
    /// The mean level of several references (realizations, experiments); `None` of none, or of
    /// different shapes.
    #[must_use]
    pub fn mean(levels: &[Self]) -> Option<Self> {
        let shapes = |level: &Self| (level.coherent_power.dim(), level.noise_power.dim());
        let alike = |(first, rest): &(&Self, &[Self])| {
            rest.iter().all(|level| shapes(level) == shapes(first))
        };
        let (first, rest) = levels.split_first().filter(alike)?;
        let mut mean = first.clone();
        for level in rest {
            mean.coherent_power += &level.coherent_power;
            mean.noise_power += &level.noise_power;
        }
        mean.coherent_power /= levels.len() as f64;
        mean.noise_power /= levels.len() as f64;
        Some(mean)
    }

    /// Amplitude of the residual over that of the noise of the mean, `sqrt((C - N)/N)` floored at
    /// 0, `(channel, excited line)`; infinite where a residual stands out of no noise at all.
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
    /// uncertainty that repetitions show is not the whole error.
    #[must_use]
    pub fn exceeds_noise(&self) -> Vec<bool> {
        self.ratio()
            .columns()
            .into_iter()
            .map(|channels| channels.iter().any(|&ratio| ratio > 1.0))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;
    use frfid_signals::random::{normal, stream};
    use std::f64::consts::TAU;

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

    /// Two channels of a multisine with white noise of rms 1, the second with a residual on a free
    /// line.
    fn level(residual: f64, free_line: usize, seed: u64) -> ResidualLevel {
        let lines = FreeLines::new(SAMPLES, &excited(), 12).expect("sound");
        let sine = |line: usize, k: usize| {
            (TAU * (line * k % SAMPLES) as f64 / SAMPLES as f64 + line as f64).sin()
        };
        let clean = Array2::from_shape_fn((2, SAMPLES), |(channel, k)| {
            let multisine: f64 = excited().iter().map(|&line| 10.0 * sine(line, k)).sum();
            multisine + channel as f64 * residual * sine(free_line, k)
        });
        let spectra = (0..REPETITIONS).map(|repetition| {
            let mut rng = stream(seed, "noise", &[repetition]);
            lines
                .transform("y", clean.mapv(|value| value + normal(&mut rng)).view())
                .expect("fits")
        });
        lines.level(&spectra.collect::<Vec<_>>()).expect("five")
    }

    #[test]
    fn what_the_plant_explains_is_no_residual() {
        let (excited, hz) = ([11, 21, 31], vec![11.0, 21.0, 31.0]);
        let lines = FreeLines::new(200, &excited, 6).expect("sound");
        // a response that grows linearly with the line, so that interpolation is exact
        let response = ndarray::Array3::from_shape_fn((3, 1, 1), |(k, _, _)| {
            Complex64::new(excited[k] as f64, 2.0)
        });
        let plant = Frf::new(hz, response).expect("shapes agree");
        let u = Array2::from_shape_fn((1, lines.n_lines()), |(_, place)| {
            Complex64::new(1.0, place as f64)
        });
        let inside = |place: usize| (11..=31).contains(&lines.dft.lines()[place]);
        let y = Array2::from_shape_fn(u.dim(), |(_, place)| {
            Complex64::new(lines.dft.lines()[place] as f64, 2.0) * u[[0, place]] + 0.25
        });
        let rest = lines.unexplained(&u, &y, &plant).expect("shapes agree");
        for place in (0..lines.n_lines()).filter(|place| inside(*place)) {
            assert!((rest[[0, place]] - 0.25).norm() < 1e-12);
        }
        let said = refusal(lines.unexplained(&y, &Array2::zeros((2, 3)), &plant));
        assert!(
            said.starts_with("y on free lines has shape [2, 3]"),
            "{said}"
        );
    }

    #[test]
    fn the_level_is_that_of_the_residual_and_of_the_noise() {
        // one of the twelve lines around its excited neighbour holds all of the residual
        let (residual, line) = (0.3, 100);
        let level = level(residual, line, 1);
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

    #[test]
    fn noise_alone_is_seldom_flagged() {
        let levels: Vec<ResidualLevel> = (10..30).map(|seed| level(0.0, 100, seed)).collect();
        let flags: Vec<bool> = levels
            .iter()
            .flat_map(ResidualLevel::exceeds_noise)
            .collect();
        let share = flags.iter().filter(|&&flag| flag).count() as f64 / flags.len() as f64;
        assert!(share < 0.04, "two channels, one in a hundred each: {share}");
        let mean = ResidualLevel::mean(&levels).expect("not empty");
        assert!(
            mean.exceeds_noise().iter().all(|&flag| !flag) && ResidualLevel::mean(&[]).is_none()
        );
        let other = ResidualLevel {
            noise_power: Array2::zeros((1, 3)),
            ..mean.clone()
        };
        assert_eq!(ResidualLevel::mean(&[mean.clone(), other]), None);
        let ratio = mean.coherent_power.sum() / mean.noise_power.sum();
        assert!((ratio - 1.0).abs() < 0.05, "{ratio}");
    }

    #[test]
    fn what_cannot_be_measured_is_refused() {
        let all: Vec<usize> = (1..32).collect();
        assert_eq!(
            FreeLines::new(64, &all, 12).err(),
            Some(EstimateError::EmptyList("lines that are not excited"))
        );
        assert!(refusal(FreeLines::new(64, &[40], 12)).starts_with("line 40 is not"));
        let lines = FreeLines::new(64, &[3, 9], 4).expect("sound");
        let spectra = lines
            .transform("u", Array2::zeros((1, 64)).view())
            .expect("fits");
        let said = refusal(lines.level(std::slice::from_ref(&spectra)));
        assert!(
            said.starts_with("repetitions of one reference is 1,"),
            "{said}"
        );
        let said = refusal(lines.level(&[spectra.clone(), Array2::zeros((1, 2))]));
        assert!(
            said.starts_with("spectra of a repetition has shape [1, 2]"),
            "{said}"
        );
        assert_eq!(
            lines
                .level(&[spectra.clone(), spectra])
                .expect("fits")
                .ratio()
                .sum(),
            0.0
        );
    }
}
