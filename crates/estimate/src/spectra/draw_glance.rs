//! Glance at two draws of phases: a few leading lines tell most of them apart, before delays are searched on all lines.
//!
//! Where a delay and a constant leave differences of rms `eps` on all lines, which count W together, they leave at most
//! `eps (W/W_l)^1/2` on the leading ones, which count `W_l`. As `cos x >= 1 - x^2/2`, on a grid of delays of which one
//! is at most `delta` rad off
//!
//! ```text
//! max |sum_l w e^{j (angle + 2 pi f tau)}| >= W_l (1 - (eps (W/W_l)^1/2 + delta)^2 / 2)
//! ```
//!
//! Draws that stay below that for the largest `eps` of a repetition are none, whatever the other lines say.

use std::f64::consts::PI;
use std::sync::Arc;

use frfid_transforms::{ComplexToReal, TransformPlanner};
use ndarray::Array2;
use num_complex::Complex64;

use crate::spectra::delay::OVERSAMPLING;

/// Lines that lead: this share of all, but so many at least. Fewer might agree by chance.
const LEADING_SHARE: usize = 8;
const LEAST_LEADING: usize = 16;
/// How far the lines may lie off multiples of their spacing, in spacings.
const OFF_GRID: f64 = 1e-3;
/// Delays on the grid are a sixteenth of a turn off at the ends of the band, and what lines off the grid bring.
const DELTA_RAD: f64 = PI / 16.0 + 2.0 * PI * OFF_GRID;

/// The leading lines on a grid of delays; planned once.
pub(super) struct Glance {
    /// Where each leading line lies on the grid.
    bins: Vec<usize>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

/// What the channels of one line bring to a comparison.
#[derive(Default)]
pub(super) struct OnLine {
    /// `sum w`, and `sum w` times the variance of a phase.
    weight: f64,
    noise: f64,
    /// `sum w e^{j angle}`.
    direction: Complex64,
}

/// What two draws are compared by.
pub(super) struct Sums {
    lines: OnLine,
    squares: f64,
    n_lines: usize,
    /// Directions of the leading lines, and what these count.
    leading: Vec<Complex64>,
    leading_weight: f64,
}

impl OnLine {
    /// Adds a channel.
    pub(super) fn add(&mut self, weight: f64, variance: f64, direction: Complex64) {
        self.weight += weight;
        self.noise += weight * variance;
        self.direction += weight * direction;
    }
}

impl Sums {
    pub(super) fn zeros(n_leading: usize) -> Self {
        Self {
            lines: OnLine::default(),
            squares: 0.0,
            n_lines: 0,
            leading: vec![Complex64::ZERO; n_leading],
            leading_weight: 0.0,
        }
    }

    /// Adds the next line.
    pub(super) fn add(&mut self, line: OnLine) {
        self.lines.weight += line.weight;
        self.lines.noise += line.noise;
        self.squares += line.weight * line.weight;
        if let Some(leading) = self.leading.get_mut(self.n_lines) {
            *leading = line.direction;
            self.leading_weight += line.weight;
        }
        self.n_lines += 1;
    }

    /// Rms of what noise does to the differences, in rad.
    pub(super) fn noise_rad(&self) -> f64 {
        (self.lines.noise / self.lines.weight).sqrt()
    }

    /// Number of lines, those that count less as parts of one.
    pub(super) fn number_of_lines(&self) -> f64 {
        self.lines.weight * self.lines.weight / self.squares
    }
}

impl Glance {
    /// On the lines of a campaign; `None` where they are no multiples of a spacing.
    pub(super) fn of(frequency_hz: &[f64], spacing_hz: f64) -> Option<Self> {
        let place = |hz: &f64| (hz - frequency_hz[0]) / spacing_hz;
        let is_on_grid = |place: f64| (place - place.round()).abs() < OFF_GRID;
        if !frequency_hz.iter().map(place).all(is_on_grid) {
            return None;
        }
        let n_leading = (frequency_hz.len() / LEADING_SHARE).max(LEAST_LEADING);
        let leading = frequency_hz.iter().take(n_leading);
        // from bin 1 on, as bin 0 must be real
        let bins: Vec<usize> = leading.map(|hz| place(hz).round() as usize + 1).collect();
        let size = (OVERSAMPLING * (bins.last()? + 1)).next_power_of_two();
        Some(Self {
            bins,
            inverse: TransformPlanner::default().inverse(size),
        })
    }

    /// Number of the leading lines.
    pub(super) fn n_leading(&self) -> usize {
        self.bins.len()
    }

    /// Whether no delay and constant make two draws equal up to `eps_rad`.
    pub(super) fn tells_apart(&self, sums: &Sums, eps_rad: f64) -> bool {
        let leading_rad = eps_rad * (sums.lines.weight / sums.leading_weight).sqrt() + DELTA_RAD;
        let needed = sums.leading_weight * (1.0 - 0.5 * leading_rad * leading_rad);
        needed > 0.0 && self.largest_square(&sums.leading) < needed * needed
    }

    /// `max |sum_l w e^{j (angle + 2 pi f tau)}|^2` on the grid; the inverse FFT is real, hence two of them.
    fn largest_square(&self, sums: &[Complex64]) -> f64 {
        let [re, im] = [Complex64::ONE, -Complex64::I].map(|part| self.real_part(sums, part));
        let squares = re.iter().zip(&im).map(|(re, im)| re * re + im * im);
        squares.fold(0.0, f64::max)
    }

    fn real_part(&self, sums: &[Complex64], factor: Complex64) -> Vec<f64> {
        let mut bins = self.inverse.make_input_vec();
        for (&bin, sum) in self.bins.iter().zip(sums) {
            bins[bin] += 0.5 * factor * sum; // the other half lies at negative frequencies
        }
        let mut samples = self.inverse.make_output_vec();
        let done = self.inverse.process(&mut bins, &mut samples);
        done.map_or(Vec::new(), |()| samples)
    }
}

/// Directions of numbers in the complex plane.
pub(super) fn directions(values: &Array2<Complex64>, sizes: &Array2<f64>) -> Array2<Complex64> {
    ndarray::Zip::from(values)
        .and(sizes)
        .map_collect(|value, size| value / size)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const EPS_RAD: f64 = 0.2;

    /// A number between -1 and 1 for each k, as if drawn.
    fn drawn(k: usize) -> f64 {
        2.0 * (1e4 * (1.0 + k as f64).sin()).fract().abs() - 1.0
    }

    fn told_apart(lines: &[usize], phase: impl Fn(usize) -> f64) -> bool {
        let hz: Vec<f64> = lines.iter().map(|&line| 0.1 * line as f64).collect();
        let glance = Glance::of(&hz, 0.2).expect("on a grid");
        let mut sums = Sums::zeros(glance.n_leading());
        for &line in lines {
            let mut of_line = OnLine::default();
            of_line.add(25.0, 0.0, Complex64::cis(phase(line)));
            sums.add(of_line);
        }
        glance.tells_apart(&sums, EPS_RAD)
    }

    #[test]
    fn no_repetition_is_missed_and_random_phases_are_told_apart() {
        for n_lines in [20, 75, 400] {
            let lines: Vec<usize> = (0..n_lines).map(|k| 11 + 2 * (k + k * k / 50)).collect();
            for draw in 0..200 {
                let (delay, constant) = (10.0 * drawn(draw), TAU * drawn(draw + 7));
                // all that a repetition may differ by, on the leading lines alone
                let leading = (n_lines / LEADING_SHARE).max(LEAST_LEADING);
                let worst = EPS_RAD * (n_lines as f64 / leading as f64).sqrt();
                let left = |line: usize| match lines.iter().position(|&l| l == line) {
                    Some(k) if k < leading => worst * drawn(line + draw).signum(),
                    _ => 0.0,
                };
                let repeated = |line| constant - TAU * 0.1 * line as f64 * delay + left(line);
                assert!(
                    !told_apart(&lines, repeated),
                    "{n_lines} lines, draw {draw}"
                );
            }
            let apart = (0..200)
                .filter(|draw| told_apart(&lines, |line| 99.0 * PI * drawn(line + 1000 * draw)));
            assert!(apart.count() > 150, "{n_lines} lines");
        }
    }
}
