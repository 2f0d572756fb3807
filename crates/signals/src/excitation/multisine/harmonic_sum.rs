//! Sums of harmonics: synthesis of a period by inverse FFT, with all phases turned at will, and the
//! true peak between its samples.

use std::f64::consts::{PI, TAU};

use frfid_transforms::{ComplexToReal, TransformPlanner};
use num_complex::Complex64;

use crate::number::power::sample_peak;

/// Least points per shortest period when the peak is searched: between two of them the sum rises by
/// at most 1/cos(pi/16).
const POINTS_PER_PERIOD: usize = 16;

/// `x(t) = sum_s |a_s| sin(2 pi line_s t / T + arg a_s)`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HarmonicSum<'a> {
    /// Lines, multiples of 1/T, rising.
    pub lines: &'a [usize],
    /// Complex amplitudes of the sines.
    pub amplitudes: &'a [Complex64],
}

/// A sum on a grid fine enough to find its peaks. Turned by phi in every phase it is
/// `cos(phi) x + sin(phi) q`, where q is x turned by a quarter: two transforms serve every turn.
pub(crate) struct TurnedSum<'a> {
    sum: HarmonicSum<'a>,
    in_phase: Vec<f64>,
    quadrature: Vec<f64>,
    /// Points of the grid per sample.
    oversampling: usize,
}

impl HarmonicSum<'_> {
    /// One period of `x`, turned, at as many equidistant points as `inverse` makes; the lines must
    /// lie below half of that.
    pub(crate) fn period(&self, turn: Complex64, inverse: &dyn ComplexToReal<f64>) -> Vec<f64> {
        let mut spectrum = inverse.make_input_vec();
        let sine = turn * Complex64::new(0.0, -0.5); // sin x = Re(-i e^{ix}), half of it on each side
        for (&line, amplitude) in self.lines.iter().zip(self.amplitudes) {
            spectrum[line] = amplitude * sine;
        }
        let mut samples = inverse.make_output_vec();
        inverse
            .process(&mut spectrum, &mut samples)
            .expect("buffers come from the plan, DC and Nyquist are real zeros");
        samples
    }

    /// |x| at the extremum near `start` (in periods), reached by Newton steps of at most `reach`; x is turned.
    fn refined(&self, turn: Complex64, start: f64, reach: f64) -> f64 {
        let (mut place, mut peak) = (start, 0.0f64);
        for _ in 0..4 {
            let (value, slope, curvature) = self.derivatives(turn, place);
            peak = peak.max(value.abs());
            if curvature == 0.0 {
                break;
            }
            place -= (slope / curvature).clamp(-reach, reach);
        }
        peak
    }

    /// x, x' and x'' of the turned sum at `place` in periods.
    fn derivatives(&self, turn: Complex64, place: f64) -> (f64, f64, f64) {
        self.lines.iter().zip(self.amplitudes).fold(
            (0.0, 0.0, 0.0),
            |(value, slope, curvature), (&line, amplitude)| {
                let omega = TAU * line as f64;
                let z = amplitude * turn * Complex64::cis(omega * place);
                (
                    value + z.im,
                    slope + omega * z.re,
                    curvature - omega * omega * z.im,
                )
            },
        )
    }
}

/// Points per sample of the grid on which a sum shows its peaks.
pub(crate) fn oversampling(lines: &[usize], n_samples: usize) -> usize {
    let highest = lines.last().copied().unwrap_or(1);
    (POINTS_PER_PERIOD * highest).div_ceil(n_samples)
}

impl<'a> TurnedSum<'a> {
    /// The sum on `n_samples` or, where these are too few to find peaks, on a multiple of them.
    pub(crate) fn new(
        sum: HarmonicSum<'a>,
        n_samples: usize,
        planner: &mut TransformPlanner,
    ) -> Self {
        let oversampling = oversampling(sum.lines, n_samples);
        let inverse = planner.inverse(oversampling * n_samples);
        let [in_phase, quadrature] =
            [Complex64::ONE, Complex64::I].map(|turn| sum.period(turn, &*inverse));
        Self {
            sum,
            in_phase,
            quadrature,
            oversampling,
        }
    }

    /// The samples of the sum times `turn`: its argument turns every phase, its modulus scales.
    pub(crate) fn samples(&self, turn: Complex64) -> impl Iterator<Item = f64> {
        self.points(turn, self.oversampling)
    }

    /// Largest |x(t)| of the turned sum over all t, not only over samples: a search on the grid,
    /// refined by Newton's method on x'(t).
    pub(crate) fn true_peak(&self, turn: Complex64) -> f64 {
        let grid: Vec<f64> = self.points(turn, 1).collect();
        let n = grid.len();
        let coarse_peak = sample_peak(&grid);
        let reachable = coarse_peak * (PI / POINTS_PER_PERIOD as f64).cos();
        let is_candidate = |&k: &usize| {
            let height = grid[k].abs();
            height >= reachable
                && height >= grid[(k + 1) % n].abs()
                && height >= grid[(k + n - 1) % n].abs()
        };
        let candidates = (0..n).filter(is_candidate);
        candidates
            .map(|k| self.sum.refined(turn, k as f64 / n as f64, 0.5 / n as f64))
            .fold(coarse_peak, f64::max)
    }

    /// Every `step`-th point of the grid.
    fn points(&self, turn: Complex64, step: usize) -> impl Iterator<Item = f64> {
        let point = move |k: usize| turn.re * self.in_phase[k] + turn.im * self.quadrature[k];
        (0..self.in_phase.len()).step_by(step).map(point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned<'a>(
        lines: &'a [usize],
        amplitudes: &'a [Complex64],
        n_samples: usize,
    ) -> TurnedSum<'a> {
        TurnedSum::new(
            HarmonicSum { lines, amplitudes },
            n_samples,
            &mut TransformPlanner::default(),
        )
    }

    #[test]
    fn a_period_is_the_sum_of_its_sines_in_every_turn() {
        let (lines, amplitudes) = (
            [1, 3, 7],
            [
                Complex64::from_polar(2.0, 0.3),
                Complex64::from_polar(0.5, -2.0),
                Complex64::new(0.0, 1.0),
            ],
        );
        let sum = turned(&lines, &amplitudes, 19);
        for phi in [0.0, 0.7, PI] {
            let samples: Vec<f64> = sum.samples(Complex64::cis(phi)).collect();
            assert_eq!(samples.len(), 19);
            for (k, sample) in samples.iter().enumerate() {
                let sines = lines.iter().zip(amplitudes);
                let expected: f64 = sines
                    .map(|(&l, a)| a.norm() * (TAU * (l * k) as f64 / 19.0 + a.arg() + phi).sin())
                    .sum();
                assert!((sample - expected).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn the_peak_lies_between_the_samples() {
        let (lines, amplitudes) = ([3], [Complex64::from_polar(2.0, 0.1)]);
        let sine = turned(&lines, &amplitudes, 7);
        for phi in [0.0, 0.2, 1.5] {
            assert!((sine.true_peak(Complex64::cis(phi)) - 2.0).abs() < 1e-14);
        }
        let samples: Vec<f64> = sine.samples(Complex64::ONE).collect();
        assert!(sample_peak(&samples) < 1.99);
    }
}
