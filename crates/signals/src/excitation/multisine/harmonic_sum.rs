//! Sums of harmonics: synthesis of a period by inverse FFT, with all phases turned at will.

use std::borrow::Cow;
use std::f64::consts::TAU;
use std::sync::Arc;

use frfid_transforms::{ComplexToReal, kept_inverse};
use num_complex::Complex64;

/// Least points per shortest period when the peak is searched: between two of them the sum rises by
/// at most 1/cos(pi/16).
pub(super) const POINTS_PER_PERIOD: usize = 16;

/// `x(t) = sum_s |a_s| sin(2 pi line_s t / T + arg a_s)`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HarmonicSum<'a> {
    /// Lines, multiples of 1/T, rising.
    pub lines: &'a [usize],
    /// Complex amplitudes of the sines.
    pub amplitudes: &'a [Complex64],
}

/// Synthesis of periods of one length, with the memory that each of them takes.
pub(crate) struct Synthesis {
    inverse: Arc<dyn ComplexToReal<f64>>,
    spectrum: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

/// A sum on a grid fine enough to find its peaks. Turned by phi in every phase it is
/// `cos(phi) x + sin(phi) q`, where q is x turned by a quarter: two transforms serve every turn.
pub(crate) struct TurnedSum<'a> {
    pub(super) sum: HarmonicSum<'a>,
    pub(super) in_phase: Vec<f64>,
    pub(super) quadrature: Vec<f64>,
    /// Points of the grid per sample.
    oversampling: usize,
}

impl Synthesis {
    pub(crate) fn new(inverse: Arc<dyn ComplexToReal<f64>>) -> Self {
        Self {
            spectrum: inverse.make_input_vec(),
            scratch: inverse.make_scratch_vec(),
            inverse,
        }
    }

    /// One period of `x`, turned, at equidistant points; the lines must lie below half their number.
    pub(crate) fn period(&mut self, sum: &HarmonicSum, turn: Complex64) -> Vec<f64> {
        let sine = turn * Complex64::new(0.0, -0.5); // sin x = Re(-i e^{ix}), half of it on each side
        self.spectrum.fill(Complex64::ZERO);
        for (&line, amplitude) in sum.lines.iter().zip(sum.amplitudes) {
            self.spectrum[line] = amplitude * sine;
        }
        let mut samples = self.inverse.make_output_vec();
        self.inverse
            .process_with_scratch(&mut self.spectrum, &mut samples, &mut self.scratch)
            .expect("buffers come from the plan, DC and Nyquist are real zeros");
        samples
    }
}

impl HarmonicSum<'_> {
    /// |x| at the extremum near `start` (in periods), reached by Newton steps of at most `reach`; x is turned.
    pub(super) fn refined(&self, turn: Complex64, start: f64, reach: f64) -> f64 {
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
    /// The sums on `n_samples` or, where these are too few to find peaks, on a multiple of them; all of the same lines.
    pub(crate) fn each(
        sums: impl IntoIterator<Item = HarmonicSum<'a>>,
        lines: &[usize],
        n_samples: usize,
    ) -> Vec<Self> {
        let oversampling = oversampling(lines, n_samples);
        let mut synthesis = Synthesis::new(kept_inverse(oversampling * n_samples));
        let turned = |sum| {
            let [in_phase, quadrature] =
                [Complex64::ONE, Complex64::I].map(|turn| synthesis.period(&sum, turn));
            Self {
                sum,
                in_phase,
                quadrature,
                oversampling,
            }
        };
        sums.into_iter().map(turned).collect()
    }

    /// The sum and its quadrature at the samples: `turn.re` of the one and `turn.im` of the other are the sum times `turn`,
    /// whose argument turns every phase and whose modulus scales.
    pub(crate) fn at_samples(&self) -> [Cow<'_, [f64]>; 2] {
        [&self.in_phase, &self.quadrature].map(|grid| match self.oversampling {
            1 => Cow::Borrowed(&grid[..]),
            step => grid.iter().step_by(step).copied().collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

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
        let sum = HarmonicSum {
            lines: &lines,
            amplitudes: &amplitudes,
        };
        let turned = TurnedSum::each([sum], &lines, 19);
        let [in_phase, quadrature] = turned[0].at_samples();
        assert_eq!((in_phase.len(), quadrature.len()), (19, 19));
        for phi in [0.0, 0.7, PI] {
            for (k, (x, q)) in in_phase.iter().zip(&*quadrature).enumerate() {
                let sines = lines.iter().zip(amplitudes);
                let expected: f64 = sines
                    .map(|(&l, a)| a.norm() * (TAU * (l * k) as f64 / 19.0 + a.arg() + phi).sin())
                    .sum();
                assert!((phi.cos() * x + phi.sin() * q - expected).abs() < 1e-14);
            }
        }
    }
}
