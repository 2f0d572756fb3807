//! Tests for a decaying or growing part `c z^q` in the spectra of successive periods, line by line.
//!
//! Of the squares of a line about its mean over n periods, a shape explains E and leaves R. Without
//! such a part `p = (R/(R + E))^(n - 2)` is uniform whatever the noise of that line is, and over several
//! lines the sum of -ln p is of the gamma distribution. Where neighbours have noise alike, E over
//! theirs is of the F distribution, which tells much more when there are few periods.

use std::iter::zip;
use std::ops::Range;

use ndarray::{Array1, Array2, ArrayView2, Axis};
use num_complex::Complex64;

use crate::settling::decay_shapes::{Mode, Shape, shapes, steady_turns};

/// Chance of a false alarm in a sound campaign, over all its tests.
const FALSE_ALARM: f64 = 5e-4;
/// Lines on either side whose noise is taken for that of a line: so many over the degrees of freedom
/// of each, and so few and so many at least and at most ..
const NEIGHBOURS: f64 = 12.0;
const FEWEST_NEIGHBOURS: f64 = 2.0;
const MOST_NEIGHBOURS: f64 = 8.0;
/// .. none of them at more than this multiple of its frequency, as noise falls ..
const WITHIN: usize = 3;
/// .. times this much (6 dB): noise of a wander falls with the square of the frequency, and is twice as
/// strong on the lowest of the odd lines as on that and the next together.
const UNLIKE: f64 = 4.0;
/// .. and only where the line's own noise agrees by at least this chance, as it does not where noise
/// has a peak.
const OWN: f64 = 0.01;
/// Lines that are tested together.
const GROUP: usize = 16;
/// Noise of neighbouring lines is not independent where it is a slow wander, which makes all lines of
/// a period leak alike: sums of -ln p over lines count by this factor.
const LEAKING: f64 = 0.35;
/// A decay that turns must be this much less likely a steady turn.
const STEADY: f64 = 1e-3;
/// Share of the power of a channel that is rounding.
const ROUNDING: f64 = 1e-24;

/// A line that has not settled, within one channel.
#[derive(Debug, Clone)]
pub(super) struct Unsteady {
    /// Its place in the list of lines.
    pub(super) place: usize,
    pub(super) mode: Mode,
    /// -ln p.
    pub(super) evidence: f64,
}

/// Spectra of one channel about their mean, `(period, line)`.
pub(super) struct Deviations<'a> {
    /// DFT bins, rising.
    lines: &'a [usize],
    /// Numbers of the periods, rising.
    pub(super) numbers: &'a [usize],
    pub(super) values: Array2<Complex64>,
    /// Squares of a line over all periods.
    squares: Vec<f64>,
    /// Squares of a line that are rounding.
    rounding: f64,
    mean: Array1<Complex64>,
}

impl<'a> Deviations<'a> {
    pub(super) fn of(
        lines: &'a [usize],
        numbers: &'a [usize],
        spectra: ArrayView2<Complex64>,
    ) -> Self {
        let n_periods = numbers.len() as f64;
        let mean = spectra.sum_axis(Axis(0)) / Complex64::from(n_periods);
        let power: f64 = mean.iter().map(Complex64::norm_sqr).sum();
        let values = &spectra - &mean;
        let squares = values.mapv(|value| value.norm_sqr()).sum_axis(Axis(0));
        Self {
            lines,
            numbers,
            squares: squares.to_vec(),
            rounding: ROUNDING * power * n_periods,
            values,
            mean,
        }
    }

    /// Modulus of the mean of a line.
    pub(super) fn level(&self, place: usize) -> f64 {
        self.mean[place].norm()
    }

    /// Noise variance of a line that a shape leaves: its own, at least that of its neighbours.
    pub(super) fn noise(&self, place: usize, shape: &Shape) -> f64 {
        let left = |place: usize| self.left(place, self.along(shape, place).norm_sqr());
        let near = self.near(place);
        let n_near = near.len() as f64;
        left(place).max(near.map(left).sum::<f64>() / n_near) / self.n_free()
    }

    /// A line and its neighbours.
    fn near(&self, place: usize) -> Range<usize> {
        let reach = (NEIGHBOURS / self.n_free()).clamp(FEWEST_NEIGHBOURS, MOST_NEIGHBOURS) as usize;
        let end = self.n_lines().min(place + reach + 1);
        let alike = |&line: &usize| line <= WITHIN * self.lines[place];
        let n_above = self.lines[place..end]
            .iter()
            .take_while(|line| alike(line))
            .count();
        place.saturating_sub(reach)..place + n_above
    }

    fn n_lines(&self) -> usize {
        self.values.ncols()
    }

    /// Complex degrees of freedom that a shape leaves.
    pub(super) fn n_free(&self) -> f64 {
        self.numbers.len() as f64 - 2.0
    }

    /// Component of a line along a shape.
    pub(super) fn along(&self, shape: &Shape, place: usize) -> Complex64 {
        zip(&shape.direction, self.values.column(place))
            .map(|(direction, value)| direction.conj() * value)
            .sum()
    }

    /// Squares of every line along a shape.
    fn explained(&self, shape: &Shape) -> Vec<f64> {
        (0..self.n_lines())
            .map(|place| self.along(shape, place).norm_sqr())
            .collect()
    }

    /// What is left of a line when so much of it is explained.
    pub(super) fn left(&self, place: usize, explained: f64) -> f64 {
        (self.squares[place] - explained).max(0.0) + self.rounding
    }

    /// Lines that have not settled; `n_channels` are tested beside each other.
    pub(super) fn unsteady(&self, n_channels: usize) -> Vec<Unsteady> {
        let mut found: Vec<Option<Unsteady>> = vec![None; self.n_lines()];
        for shapes in shapes(self.numbers) {
            let n_tests = 3 * n_channels * self.n_lines() * shapes.len();
            // turning or not share the false alarms
            let needed = -(0.5 * FALSE_ALARM / n_tests.max(1) as f64).ln();
            for shape in &shapes {
                for new in self.along_shape(shape, needed) {
                    let old = &mut found[new.place];
                    if old.as_ref().is_none_or(|old| old.evidence < new.evidence) {
                        *old = Some(new);
                    }
                }
            }
        }
        let turns = steady_turns(self.numbers);
        found
            .into_iter()
            .flatten()
            .filter(|line| !line.mode.is_turning() || self.is_no_steady_turn(line, &turns))
            .collect()
    }

    /// Lines in which a shape is found, with the evidence needed.
    fn along_shape(&self, shape: &Shape, needed: f64) -> Vec<Unsteady> {
        let explained = self.explained(shape);
        let left: Vec<f64> = (0..self.n_lines())
            .map(|place| self.left(place, explained[place]))
            .collect();
        let own: Vec<f64> = zip(&explained, &left)
            .map(|(explained, left)| self.n_free() * (explained / left).ln_1p())
            .collect();
        let mut evidence: Vec<f64> = (0..self.n_lines())
            .map(|place| match own[place] > -OWN.ln() {
                true => own[place].max(self.beside_neighbours(place, explained[place], &left)),
                false => own[place],
            })
            .collect();
        // a mode that turns has a few lines beside it, and a wander turns by chance
        if !shape.mode.is_turning() {
            add_groups(&own, needed, &mut evidence);
        }
        let found = |(place, evidence): (usize, f64)| Unsteady {
            place,
            mode: shape.mode,
            evidence,
        };
        let all = evidence.into_iter().enumerate();
        all.filter(|(_, evidence)| *evidence > needed)
            .map(found)
            .collect()
    }

    /// -ln p of a line if its noise is that of its neighbours.
    fn beside_neighbours(&self, place: usize, explained: f64, left: &[f64]) -> f64 {
        let near = self.near(place);
        let n_free = near.len() as f64 * self.n_free();
        let noise = UNLIKE * left[near].iter().sum::<f64>();
        n_free * (explained / noise).ln_1p()
    }

    /// Whether a steady turn is far from doing as well as the turn that decays or grows.
    fn is_no_steady_turn(&self, line: &Unsteady, turns: &[Shape]) -> bool {
        let left = |shape: &Shape| {
            let explained = self.along(shape, line.place).norm_sqr();
            self.left(line.place, explained)
        };
        let steady = turns.iter().map(left).fold(f64::INFINITY, f64::min);
        let evidence = self.n_free() * (steady / left(&line.mode.over(self.numbers))).ln();
        evidence > -STEADY.ln()
    }
}

/// Adds the evidence of groups of lines to those of its lines that take part in it.
fn add_groups(own: &[f64], needed: f64, evidence: &mut [f64]) {
    for (first, group) in own.windows(GROUP).enumerate() {
        let together = gamma_tail(GROUP, LEAKING * group.iter().sum::<f64>());
        if together > needed {
            for (own, evidence) in zip(group, &mut evidence[first..first + GROUP]) {
                if *own > -OWN.ln() {
                    *evidence = evidence.max(together);
                }
            }
        }
    }
}

/// -ln of the chance that a sum of so many exponential numbers of mean 1 exceeds `sum`.
fn gamma_tail(size: usize, sum: f64) -> f64 {
    let (mut term, mut total) = (1.0, 0.0);
    for k in 1..=size {
        total += term;
        term *= sum / k as f64;
    }
    sum - total.ln()
}
