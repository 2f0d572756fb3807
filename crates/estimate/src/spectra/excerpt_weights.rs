//! Weights of an excerpt on the samples of a recording: window, Fourier kernel, low-pass and what takes the mean off,
//! in one, and their sums in vector lanes.
//!
//! With one centre `c_j = j s` every s samples, kernel `K_j = hann(c_j) e^{-2 pi i f c_j}` and low-pass h
//!
//! ```text
//! w_k = sum_j K_j h(k - c_j) - (what makes the sum of all 0, spread evenly over the excerpt)
//! h(d) = (1 + cos(pi d / 2 s)) / 4 s within 2 s of a centre,   h = 1 at it for s = 1
//! ```
//!
//! At `k = j s + m` four centres are near, whose cosines are quarter turns apart, so that with `t = pi m / 2 s`
//!
//! ```text
//! 4 s w_k = (K_{j-1} + K_j + K_{j+1} + K_{j+2}) + (K_j - K_{j+2}) cos t + (K_{j+1} - K_{j-1}) sin t
//! ```

use std::f64::consts::{FRAC_PI_2, TAU};
use std::iter::zip;
use std::ops::RangeInclusive;

use ndarray::{ArrayViewMut1, aview1};
use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd, as_arrays};

/// Registers that are summed side by side, so that no sum waits for the one before.
const SUMS: usize = 4;
/// Samples of all channels that are weighted before the next ones: their weights stay in the cache.
const AT_ONCE: usize = 1024;

/// Weights, real parts apart from imaginary ones.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Weights {
    /// Sample of the first weight; the low-pass reaches a little beyond the excerpt.
    from: usize,
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Weights {
    /// Of the excerpt from sample `first` to `last` of `n_samples`, at a frequency of so many turns per sample, with a
    /// centre every `step` samples.
    pub(super) fn of(
        [first, last]: [usize; 2],
        turns_per_sample: f64,
        step: usize,
        n_samples: usize,
    ) -> Self {
        let kernel = kernel(last - first, turns_per_sample, step);
        let mut weights = Self::filtered(&kernel, first, step, n_samples);
        weights.take_off_mean(first - weights.from..=last - weights.from);
        weights
    }

    /// Kernel and low-pass; what lies beyond the recording is left out.
    fn filtered(kernel: &[Complex64], first: usize, step: usize, n_samples: usize) -> Self {
        if step == 1 {
            return Self {
                from: first,
                re: kernel.iter().map(|value| value.re).collect(),
                im: kernel.iter().map(|value| value.im).collect(),
            };
        }
        let quarter = turns(FRAC_PI_2 / step as f64, step);
        let mut all = Self::zeros((kernel.len() + 3) * step);
        let at = |j: usize| j.checked_sub(3).and_then(|j| kernel.get(j)).copied();
        let pieces = zip(all.re.chunks_exact_mut(step), all.im.chunks_exact_mut(step));
        for (piece, (re, im)) in pieces.enumerate() {
            let near = [0, 1, 2, 3].map(|later| at(piece + later).unwrap_or_default());
            fill(re, near.map(|value| value.re), &quarter);
            fill(im, near.map(|value| value.im), &quarter);
        }
        all.within(first, 2 * step, n_samples)
    }

    fn zeros(n: usize) -> Self {
        let (re, im) = (vec![0.0; n], vec![0.0; n]);
        Self { from: 0, re, im }
    }

    /// The same, beginning so many samples before `first`, without what lies beyond the recording.
    fn within(mut self, first: usize, before: usize, n_samples: usize) -> Self {
        self.from = first.saturating_sub(before);
        let cut = before.saturating_sub(first);
        for part in [&mut self.re, &mut self.im] {
            part.drain(..cut);
            part.truncate(n_samples - self.from);
        }
        self
    }

    /// Takes the mean of the excerpt off: then the sum of all weights is 0.
    fn take_off_mean(&mut self, excerpt: RangeInclusive<usize>) {
        for part in [&mut self.re, &mut self.im] {
            let excess = aview1(part).sum() / excerpt.clone().count() as f64;
            part[excerpt.clone()]
                .iter_mut()
                .for_each(|weight| *weight -= excess);
        }
    }

    /// `sum_k w_k x_k` of every channel.
    pub(super) fn add_sums(&self, channels: &[impl AsRef<[f64]>], sums: ArrayViewMut1<Complex64>) {
        let weights = self;
        Arch::new().dispatch(Sums {
            weights,
            channels,
            sums,
        });
    }

    /// The weights from one place on, at most so many as are weighted at once.
    fn piece(&self, from: usize) -> [&[f64]; 2] {
        let to = (from + AT_ONCE).min(self.re.len());
        [&self.re[from..to], &self.im[from..to]]
    }
}

/// `K_j` at every centre of an excerpt of so many steps between samples.
fn kernel(length: usize, turns_per_sample: f64, step: usize) -> Vec<Complex64> {
    let n_centres = length / step + 1;
    let window = turns(TAU * step as f64 / length as f64, n_centres);
    let fourier = turns(-TAU * turns_per_sample * step as f64, n_centres);
    let both = zip(window, fourier);
    both.map(|(window, turn)| turn * (0.5 - 0.5 * window.re))
        .collect()
}

/// `e^{i k angle}`, k from 0 to n - 1: each the product of a coarse and a fine one, so that few are evaluated and
/// nothing adds up.
fn turns(angle: f64, n: usize) -> Vec<Complex64> {
    let (n_fine, at) = (n.isqrt() + 1, |k: usize| Complex64::cis(k as f64 * angle));
    let fine: Vec<Complex64> = (0..n_fine).map(at).collect();
    let mut all = Vec::with_capacity(n + n_fine);
    for coarse in (0..n).step_by(n_fine).map(at) {
        all.extend(fine.iter().map(|fine| coarse * fine));
    }
    all.truncate(n);
    all
}

/// The weights from one centre to the next by the formula at the head of this file, of the real or the imaginary parts
/// of the kernel at the four centres near.
fn fill(weights: &mut [f64], near: [f64; 4], quarter: &[Complex64]) {
    let share = 0.25 / weights.len() as f64;
    let [before, here, next, last] = near.map(|value| share * value);
    let (sum, even, odd) = (before + here + next + last, here - last, next - before);
    for (weight, turn) in zip(weights, quarter) {
        *weight = sum + even * turn.re + odd * turn.im;
    }
}

/// What is summed, and where to.
struct Sums<'s, C> {
    weights: &'s Weights,
    channels: &'s [C],
    sums: ArrayViewMut1<'s, Complex64>,
}

impl<C: AsRef<[f64]>> WithSimd for Sums<'_, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let weights = self.weights;
        for from in (0..weights.re.len()).step_by(AT_ONCE) {
            let piece = weights.piece(from);
            for (sum, channel) in zip(&mut self.sums, self.channels) {
                // the sum of the weights is 0: what is taken off all samples costs nothing but large numbers
                let samples = &channel.as_ref()[weights.from..];
                let level = samples[0];
                *sum += sum_of_piece(simd, piece, &samples[from..][..piece[0].len()], level);
            }
        }
    }
}

/// `sum_k w_k (x_k - level)`, real and imaginary parts of w.
#[inline(always)]
fn sum_of_piece<S: Simd>(simd: S, weights: [&[f64]; 2], samples: &[f64], level: f64) -> Complex64 {
    let level = simd.splat_f64s(level);
    let mut sums = [[simd.splat_f64s(0.0); 2]; SUMS];
    let add = |sum: &mut [S::f64s; 2], sample: S::f64s, weights: [S::f64s; 2]| {
        let sample = simd.sub_f64s(sample, level);
        *sum = [0, 1].map(|part| simd.mul_add_f64s(weights[part], sample, sum[part]));
    };
    let [(re, re_end), (im, im_end)] = weights.map(S::as_simd_f64s);
    let (x, x_end) = S::as_simd_f64s(samples);
    let (x, x_rest) = as_arrays::<SUMS, _>(x);
    let [(re, re_rest), (im, im_rest)] = [re, im].map(as_arrays::<SUMS, _>);
    for ((x, re), im) in zip(zip(x, re), im) {
        (0..SUMS).for_each(|k| add(&mut sums[k], x[k], [re[k], im[k]]));
    }
    for (((sum, x), re), im) in zip(zip(zip(&mut sums, x_rest), re_rest), im_rest) {
        add(sum, *x, [*re, *im]);
    }
    let [x, re, im] = [x_end, re_end, im_end].map(|end| simd.partial_load_f64s(end));
    add(&mut sums[SUMS - 1], x, [re, im]);
    let total = |part: usize| {
        let halves = [0, 2].map(|k| simd.add_f64s(sums[k][part], sums[k + 1][part]));
        simd.reduce_sum_f64s(simd.add_f64s(halves[0], halves[1]))
    };
    Complex64::new(total(0), total(1))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use ndarray::Array1;

    /// Window, kernel and low-pass tap by tap, and the mean of the excerpt taken off every sample.
    fn tap_by_tap([first, last]: [usize; 2], turns: f64, step: usize, x: &[f64]) -> Complex64 {
        let mean = x[first..=last].iter().sum::<f64>() / (last - first + 1) as f64;
        let hann: Vec<f64> = (1..4 * step)
            .map(|k| (PI * k as f64 / (4 * step) as f64).sin().powi(2))
            .collect();
        let (low_pass, reach) = match step {
            1 => (vec![1.0], 0),
            _ => (
                hann.iter().map(|h| h / hann.iter().sum::<f64>()).collect(),
                2 * step - 1,
            ),
        };
        let mut sum = Complex64::ZERO;
        for centre in (first..=last).step_by(step) {
            let place = (centre - first) as f64;
            let window = (PI * place / (last - first) as f64).sin().powi(2);
            let kernel = Complex64::cis(-TAU * turns * place) * window;
            for (tap, gain) in low_pass.iter().enumerate() {
                let sample = (centre + tap).checked_sub(reach).and_then(|k| x.get(k));
                sum += sample.map_or(Complex64::ZERO, |x| kernel * gain * (x - mean));
            }
        }
        sum
    }

    #[test]
    fn weighted_sums_are_those_tap_by_tap_also_at_the_ends_of_a_recording() {
        let x: Vec<f64> = (0..5000)
            .map(|k| 7.0 + (0.01 * f64::from(k)).sin() + f64::from(k * k % 101) * 1e-3)
            .collect();
        for (ends, step) in [
            ([100, 173], 1),
            ([100, 500], 10),
            ([3, 4803], 120),
            ([4000, 4999], 24),
            ([0, 4], 2),
            ([0, 4999], 125),
        ] {
            let turns = 4.0 / (ends[1] - ends[0]) as f64;
            let expected = tap_by_tap(ends, turns, step, &x);
            let mut found = Array1::zeros(2);
            Weights::of(ends, turns, step, x.len()).add_sums(&[&x, &x], found.view_mut());
            assert!(
                (found[0] - expected).norm() < 1e-12 * expected.norm() && found[0] == found[1],
                "{ends:?}: {} instead of {expected}",
                found[0]
            );
        }
    }
}
