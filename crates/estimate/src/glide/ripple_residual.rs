//! Residual of ripple after the glide was subtracted, seen on the lines that a multisine leaves free.
//!
//! Around every excited line stand free lines, on which a linear machine answers with noise alone:
//! what repeats there in every repetition of a reference is ripple, or other distortion by the
//! machine. [`ResidualLevel`] has the statistics.

use std::collections::BTreeSet;

use frfid_signals::checks::require_shape;
use frfid_signals::{Frf, SignalError};
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::frf::between::between;
use crate::glide::residual_level::ResidualLevel;
use crate::spectra::Transform;
use crate::spectra::line_dft::{LineDft, check_lines};

/// The free lines around the excited lines of a period; found once, used for every run.
#[derive(Clone)]
pub struct FreeLines {
    dft: LineDft,
    excited: Vec<f64>,
    /// Per excited line the places of its neighbours among the lines of the DFT.
    neighbours: Vec<Vec<usize>>,
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
        check_lines(n_samples, excited)?;
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
            excited: excited.iter().map(|&line| line as f64).collect(),
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
        let (below, above, share) = between(&self.excited, self.dft.lines()[place] as f64);
        let response = |input: usize| {
            let [low, high] = [below, above].map(|line| plant.response[[line, output, input]]);
            low + (high - low) * share
        };
        (0..plant.n_inputs())
            .map(|input| response(input) * u[[input, place]])
            .sum()
    }

    /// Levels from spectra of the repetitions of each reference (same realization, same experiment),
    /// of [`Transform::transform`] or [`FreeLines::unexplained`], and of the glides whose mean was
    /// subtracted from all of them.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError`] unless a reference has two repetitions or more, and for spectra
    /// of different shapes.
    pub fn level(
        &self,
        references: &[Vec<Array2<Complex64>>],
        glides: &[Array2<Complex64>],
    ) -> Result<ResidualLevel, EstimateError> {
        let all = references.iter().flatten().chain(glides);
        self.check_shapes(&all.collect::<Vec<_>>())?;
        let repeated: Vec<_> = references.iter().filter(|one| one.len() > 1).collect();
        if repeated.is_empty() {
            let most = references.iter().map(Vec::len).max().unwrap_or(0);
            return Err(EstimateError::parameter(
                "repetitions of one reference",
                most as f64,
                "2 or more, or what repeats cannot be told from noise",
            ));
        }
        Ok(ResidualLevel::of(self, &repeated, glides))
    }

    /// Refuses spectra of other lines, or of other channels than the first.
    fn check_shapes(&self, all: &[&Array2<Complex64>]) -> Result<(), EstimateError> {
        let Some(first) = all.first() else {
            return Ok(());
        };
        let needed = (first.nrows(), self.n_lines());
        let Some(odd) = all.iter().find(|spectra| spectra.dim() != needed) else {
            return Ok(());
        };
        let needed = format!("{needed:?}, as the first");
        Err(EstimateError::shape(
            "spectra of a repetition",
            odd.shape(),
            needed,
        ))
    }

    /// Mean over the neighbours of every excited line, from |X|^2 to squared amplitudes.
    pub(crate) fn around(&self, power: &Array2<f64>) -> Array2<f64> {
        let scale = 4.0 / (self.dft.n_samples() as f64).powi(2);
        Array2::from_shape_fn((power.nrows(), self.neighbours.len()), |(channel, line)| {
            let around = &self.neighbours[line];
            let sum: f64 = around.iter().map(|&place| power[[channel, place]]).sum();
            scale * sum / around.len() as f64
        })
    }

    /// Number of free lines around every excited one.
    pub(crate) fn n_neighbours(&self) -> Vec<usize> {
        self.neighbours.iter().map(Vec::len).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;

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
        let level = |one: &[Array2<Complex64>]| lines.level(&[one.to_vec()], &[]);
        let said = refusal(level(std::slice::from_ref(&spectra)));
        assert!(
            said.starts_with("repetitions of one reference is 1,"),
            "{said}"
        );
        let said = refusal(level(&[spectra.clone(), Array2::zeros((1, 2))]));
        assert!(
            said.starts_with("spectra of a repetition has shape [1, 2]"),
            "{said}"
        );
        let still = level(&[spectra.clone(), spectra]).expect("fits");
        assert_eq!(still.ratio().sum(), 0.0);
        assert!(!still.exceeds_noise().contains(&true));
    }
}
