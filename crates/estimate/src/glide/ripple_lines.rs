//! Lines of torque ripple in a glide: narrow ones, as a torque that depends on the motor's position makes
//! at constant velocity, against what is smooth over frequency (noise, gravity along the way).
//!
//! With a Hann window each line is held against the median power of those around it. The power of
//! noise is exponentially distributed: among 6000 lines of three channels the largest is 19 times the
//! median, or more, in one record of twenty.

use frfid_transforms::TransformPlanner;
use ndarray::{ArrayView1, ArrayView2};
use num_complex::Complex64;

/// Power over the median around it that is ripple: noise alone reaches 26 where the median of so many
/// lines is low, ripple of a robot (the r3's, 0.5 to 2 % of the torque) 700 to 70000.
const PEAK: f64 = 40.0;
/// Lines on either side that the median is taken over, and those left out, which the window fills.
const REACH: usize = 32;
const GUARD: usize = 3;
/// Lowest line: below, what changes smoothly along the way stands out as much.
const LOWEST: usize = 8;

/// Whether a channel of a record of constant velocity, `(channel, sample)`, has narrow lines: torque
/// ripple of eight cycles or more. Without any, what repeats in runs on that velocity is not ripple.
#[must_use]
pub fn has_ripple_lines(torque: ArrayView2<f64>) -> bool {
    torque.rows().into_iter().any(has_lines)
}

fn has_lines(signal: ArrayView1<f64>) -> bool {
    let power = windowed_power(signal);
    (LOWEST..power.len().saturating_sub(GUARD)).any(|line| {
        let around = median_around(&power, line);
        around.is_some_and(|median| power[line] > PEAK * median)
    })
}

/// Squared spectrum of the signal without its mean, under a Hann window.
fn windowed_power(signal: ArrayView1<f64>) -> Vec<f64> {
    let n = signal.len();
    if n < 4 * REACH {
        return Vec::new(); // too few lines to tell a narrow one
    }
    let mean = signal.sum() / n as f64;
    let window = |k: usize| 0.5 - 0.5 * (std::f64::consts::TAU * k as f64 / n as f64).cos();
    let samples = signal.iter().enumerate();
    let mut samples: Vec<f64> = samples
        .map(|(k, value)| window(k) * (value - mean))
        .collect();
    let forward = TransformPlanner::default().forward(n);
    let mut bins = forward.make_output_vec();
    forward
        .process(&mut samples, &mut bins)
        .expect("the plan's own lengths");
    bins.iter().map(Complex64::norm_sqr).collect()
}

/// Median power of the lines around one.
fn median_around(power: &[f64], line: usize) -> Option<f64> {
    let below = line.saturating_sub(REACH).max(1)..line - GUARD;
    let above = line + GUARD + 1..(line + REACH + 1).min(power.len());
    frfid_signals::median(below.chain(above).map(|line| power[line]).collect())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use frfid_signals::random::{normal, stream};
    use ndarray::Array2;

    use super::*;

    /// Noise of rms 1 on a ramp that bends, and a sine of any frequency on the second channel.
    fn torque(amplitude: f64, cycles: f64, seed: u64) -> Array2<f64> {
        let n = 12288;
        let mut rng = stream(seed, "torque", &[]);
        Array2::from_shape_fn((2, n), |(channel, k)| {
            let share = k as f64 / n as f64;
            let ripple = amplitude * channel as f64 * (TAU * cycles * share).sin();
            30.0 * share * share + ripple + normal(&mut rng)
        })
    }

    #[test]
    fn noise_and_gravity_have_no_narrow_lines_and_ripple_below_the_noise_has() {
        for seed in 0..100 {
            assert!(!has_ripple_lines(torque(0.0, 0.0, seed).view()), "{seed}");
        }
        for (seed, cycles) in [11.0, 23.5, 400.25, 3000.7].into_iter().enumerate() {
            assert!(
                has_ripple_lines(torque(0.3, cycles, seed as u64).view()),
                "{cycles}"
            );
        }
        assert!(!has_ripple_lines(Array2::zeros((1, 3)).view()));
        assert!(!has_ripple_lines(Array2::ones((1, 4096)).view()));
    }
}
