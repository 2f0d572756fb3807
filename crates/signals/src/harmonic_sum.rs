//! Sums of harmonics: synthesis of a period by inverse FFT and the true peak between its samples.

use std::f64::consts::TAU;

use num_complex::Complex64;
use realfft::RealFftPlanner;

/// Points per shortest period when the peak is searched: between two of them the sum rises by at most 1/cos(pi/32).
const POINTS_PER_PERIOD: usize = 32;

/// `x(t) = sum_s |a_s| sin(2 pi line_s t / T + arg a_s)`.
#[derive(Debug, Clone)]
pub(crate) struct HarmonicSum<'a> {
    /// Lines, multiples of 1/T, rising.
    pub lines: &'a [usize],
    /// Complex amplitudes of the sines.
    pub amplitudes: &'a [Complex64],
}

impl HarmonicSum<'_> {
    /// One period of `x` at `n` equidistant points, by one inverse FFT; the lines must lie below n/2.
    pub fn period(&self, n: usize) -> Vec<f64> {
        let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(n);
        let mut spectrum = inverse.make_input_vec();
        for (&line, amplitude) in self.lines.iter().zip(self.amplitudes) {
            spectrum[line] = amplitude * Complex64::new(0.0, -0.5); // sin x = Re(-i e^{ix}), half of it on each side
        }
        let mut samples = inverse.make_output_vec();
        inverse
            .process(&mut spectrum, &mut samples)
            .expect("buffers come from the plan, DC and Nyquist are real zeros");
        samples
    }

    /// Largest |x(t)| over all t, not only over samples: a search on a fine grid, refined by Newton's method on x'(t).
    pub fn true_peak(&self) -> f64 {
        let highest = self.lines.last().copied().unwrap_or(1);
        let fine = self.period((POINTS_PER_PERIOD * highest).next_power_of_two());
        let n = fine.len();
        let coarse_peak = crate::power::sample_peak(&fine);
        let reachable = coarse_peak * (std::f64::consts::PI / POINTS_PER_PERIOD as f64).cos();
        let is_candidate = |&k: &usize| {
            let height = fine[k].abs();
            height >= reachable && height >= fine[(k + 1) % n].abs() && height >= fine[(k + n - 1) % n].abs()
        };
        (0..n)
            .filter(is_candidate)
            .map(|k| self.refined(k as f64 / n as f64, 0.5 / n as f64))
            .fold(coarse_peak, f64::max)
    }

    /// |x| at the extremum near `start` (in periods), reached by Newton steps of at most `reach`.
    fn refined(&self, start: f64, reach: f64) -> f64 {
        let (mut turn, mut peak) = (start, 0.0f64);
        for _ in 0..4 {
            let (value, slope, curvature) = self.derivatives(turn);
            peak = peak.max(value.abs());
            if curvature == 0.0 {
                break;
            }
            turn -= (slope / curvature).clamp(-reach, reach);
        }
        peak
    }

    /// x, x' and x'' at `turn` periods.
    fn derivatives(&self, turn: f64) -> (f64, f64, f64) {
        self.lines.iter().zip(self.amplitudes).fold((0.0, 0.0, 0.0), |(value, slope, curvature), (&line, amplitude)| {
            let omega = TAU * line as f64;
            let z = amplitude * Complex64::cis(omega * turn);
            (value + z.im, slope + omega * z.re, curvature - omega * omega * z.im)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_period_is_the_sum_of_its_sines() {
        let (lines, amplitudes) =
            ([1, 3, 7], [Complex64::from_polar(2.0, 0.3), Complex64::from_polar(0.5, -2.0), Complex64::new(0.0, 1.0)]);
        let sum = HarmonicSum { lines: &lines, amplitudes: &amplitudes };
        for (k, sample) in sum.period(19).iter().enumerate() {
            let expected: f64 = lines
                .iter()
                .zip(amplitudes)
                .map(|(&l, a)| a.norm() * (TAU * (l * k) as f64 / 19.0 + a.arg()).sin())
                .sum();
            assert!((sample - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn the_peak_lies_between_the_samples() {
        let (lines, amplitudes) = ([3], [Complex64::from_polar(2.0, 0.1)]);
        let sine = HarmonicSum { lines: &lines, amplitudes: &amplitudes };
        assert!((sine.true_peak() - 2.0).abs() < 1e-14);
        assert!(crate::power::sample_peak(&sine.period(7)) < 1.99);
    }
}
