//! Fourier series of a sampled signal: its values, derivatives and integral at any rate.

use std::f64::consts::TAU;

use frfid_transforms::TransformPlanner;
use num_complex::Complex64;

/// Lines this far below the strongest are rounding.
const ROUNDING: f64 = 1e-13;
/// Steps of the rotation after which a direct sum takes its phase anew.
const RESYNC: usize = 256;
/// Longest transform.
const LONGEST: f64 = (1u64 << 26) as f64;

/// `x(t) = mean + sum Re(z_l e^{j 2 pi l t/T})`: the only band-limited signal through the samples of
/// one period T.
#[derive(Debug, Clone)]
pub(super) struct Series {
    period_s: f64,
    mean: f64,
    /// Lines with their complex amplitudes.
    lines: Vec<(usize, Complex64)>,
}

impl Series {
    /// The series through one period of samples.
    pub(super) fn through(
        samples: &[f64],
        sample_time_s: f64,
        planner: &mut TransformPlanner,
    ) -> Self {
        let n = samples.len();
        let forward = planner.forward(n);
        let (mut input, mut spectrum) = (samples.to_vec(), forward.make_output_vec());
        forward
            .process(&mut input, &mut spectrum)
            .expect("buffers come from the plan");
        let scale = |line: usize| if 2 * line == n { 1.0 } else { 2.0 } / n as f64;
        let lines = (1..spectrum.len()).map(|line| (line, scale(line) * spectrum[line]));
        let mut lines: Vec<_> = lines.collect();
        let strongest = lines.iter().map(|(_, z)| z.norm()).fold(0.0, f64::max);
        lines.retain(|(_, z)| z.norm() > ROUNDING * strongest);
        Self {
            period_s: n as f64 * sample_time_s,
            mean: spectrum[0].re / n as f64,
            lines,
        }
    }

    /// The same signal that much later on its own clock: `x(t + shift_s)`.
    pub(super) fn advanced(mut self, shift_s: f64) -> Self {
        for (line, z) in &mut self.lines {
            *z *= Complex64::cis(TAU * (*line as f64 * shift_s / self.period_s).fract());
        }
        self
    }

    /// Integral from t = 0 (order 0), value (1) and derivatives (2, 3) at `n` instants
    /// `(first + k) step_s`.
    pub(super) fn sampled(
        &self,
        order: i32,
        step_s: f64,
        first: isize,
        n: usize,
        planner: &mut TransformPlanner,
    ) -> Vec<f64> {
        let amplitudes = self.amplitudes(order);
        let points = self.period_s / step_s;
        let is_whole = (points - points.round()).abs() < 1e-9 * points.round();
        let mut sum = if is_whole && (1.0..=LONGEST).contains(&points.round()) {
            transformed(&amplitudes, points.round() as usize, first, n, planner)
        } else {
            summed(&amplitudes, step_s / self.period_s, first, n)
        };
        match order {
            0 => {
                let at_zero: f64 = amplitudes.iter().map(|(_, z)| z.re).sum();
                for (k, value) in sum.iter_mut().enumerate() {
                    *value += self.mean * (first + k as isize) as f64 * step_s - at_zero;
                }
            }
            1 => sum.iter_mut().for_each(|value| *value += self.mean),
            _ => {}
        }
        sum
    }

    /// Amplitudes of the derivative of `order - 1`.
    fn amplitudes(&self, order: i32) -> Vec<(usize, Complex64)> {
        let derived = |&(line, z): &(usize, Complex64)| {
            let j_omega = Complex64::new(0.0, TAU * line as f64 / self.period_s);
            (line, z * j_omega.powi(order - 1))
        };
        self.lines.iter().map(derived).collect()
    }
}

/// The sum at points that divide the period, by one inverse transform; lines beyond their Nyquist
/// fold, which is exact at the points.
fn transformed(
    amplitudes: &[(usize, Complex64)],
    points: usize,
    first: isize,
    n: usize,
    planner: &mut TransformPlanner,
) -> Vec<f64> {
    let inverse = planner.inverse(points);
    let mut spectrum = inverse.make_input_vec();
    for (line, z) in amplitudes {
        let bin = line % points;
        match 2 * bin {
            twice if bin == 0 || twice == points => spectrum[bin] += z.re,
            twice if twice < points => spectrum[bin] += 0.5 * z,
            _ => spectrum[points - bin] += 0.5 * z.conj(),
        }
    }
    let mut period = inverse.make_output_vec();
    inverse
        .process(&mut spectrum, &mut period)
        .expect("buffers come from the plan, DC and Nyquist are real");
    let at = |k: usize| period[(first + k as isize).rem_euclid(points as isize) as usize];
    (0..n).map(at).collect()
}

/// The sum at points that do not, line by line; `step` in periods.
fn summed(amplitudes: &[(usize, Complex64)], step: f64, first: isize, n: usize) -> Vec<f64> {
    let mut sum = vec![0.0; n];
    for &(line, z) in amplitudes {
        let turn = Complex64::cis(TAU * (line as f64 * step).fract());
        for (chunk, part) in sum.chunks_mut(RESYNC).enumerate() {
            let k = first + (chunk * RESYNC) as isize;
            let mut term = z * Complex64::cis(TAU * (line as f64 * k as f64 * step).fract());
            for value in part {
                *value += term.re;
                term *= turn;
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A signal, its integral from 0 and its derivatives.
    fn exact(t: f64) -> [f64; 4] {
        let (a, b) = (TAU * 3.0 / 2.0, TAU * 7.0 / 2.0);
        [
            0.25 * t + (a * t).sin() / a - ((b * t + 0.4).cos() - 0.4f64.cos()) / b,
            0.25 + (a * t).cos() + (b * t + 0.4).sin(),
            -a * (a * t).sin() + b * (b * t + 0.4).cos(),
            -a * a * (a * t).cos() - b * b * (b * t + 0.4).sin(),
        ]
    }

    #[test]
    fn values_derivatives_and_integral_are_exact_at_every_rate() {
        let mut planner = TransformPlanner::default();
        let samples: Vec<f64> = (0..40).map(|k| exact(f64::from(k) * 0.05)[1]).collect();
        let series = Series::through(&samples, 0.05, &mut planner);
        let shift_s = 0.37;
        let shifted = series.clone().advanced(shift_s);
        for step_s in [0.05, 0.02, 0.2, 0.013] {
            for order in 0..4i32 {
                let found = series.sampled(order, step_s, -30, 100, &mut planner);
                let later = shifted.sampled(order, step_s, -30, 100, &mut planner);
                for k in 0..100 {
                    let t = (k as f64 - 30.0) * step_s;
                    let place = order as usize;
                    assert!(
                        (found[k] - exact(t)[place]).abs() < 1e-9,
                        "{order} {step_s} {k}"
                    );
                    let from = if order == 0 { exact(shift_s)[0] } else { 0.0 };
                    assert!((later[k] - exact(t + shift_s)[place] + from).abs() < 1e-9);
                }
            }
        }
    }
}
