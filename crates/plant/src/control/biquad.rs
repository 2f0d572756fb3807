//! Biquad: a digital filter of second order, as low-pass and notch on a torque.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, RowDVector};

use crate::control::controller::LinearController;

/// H(z) = (b0 + b1 z^-1 + b2 z^-2) / (1 + a1 z^-1 + a2 z^-2), with a gain of 1 at z = 1, in the
/// transposed direct form II.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Biquad {
    /// b0, b1, b2.
    b: [f64; 3],
    /// a1, a2.
    a: [f64; 2],
    state: [f64; 2],
}

impl Biquad {
    /// A low-pass w^2 / (s^2 + 2 D w s + w^2) with a corner in Hz and a damping D, by the bilinear
    /// transformation that keeps the corner.
    pub(crate) fn low_pass(corner_hz: f64, damping: f64, sample_time_s: f64) -> Self {
        Self::bilinear([1.0, 0.0, 0.0], damping, corner_hz, sample_time_s)
    }

    /// A notch (s^2 + g B s + w^2) / (s^2 + B s + w^2) at a frequency in Hz, B = 2 pi its width in
    /// Hz, g the gain that is left there, by the bilinear transformation that keeps frequency and
    /// width: with g = 0 that of Orfanidis, Introduction to Signal Processing (1996), eq. (11.3.22).
    pub(crate) fn notch(frequency_hz: f64, width_hz: f64, gain: f64, sample_time_s: f64) -> Self {
        let [half_width, turn] = [width_hz, 2.0 * frequency_hz].map(|hz| PI * hz * sample_time_s);
        let damping = half_width.tan() / turn.sin();
        let numerator = [1.0, 2.0 * gain * damping, 1.0];
        Self::bilinear(numerator, damping, frequency_hz, sample_time_s)
    }

    /// (n0 + n1 p + n2 p^2) / (1 + 2 D p + p^2) in p = s/w, sampled with p = (1 - z^-1) / (k (1 +
    /// z^-1)), k = tan(w T / 2).
    fn bilinear(
        [n0, n1, n2]: [f64; 3],
        damping: f64,
        frequency_hz: f64,
        sample_time_s: f64,
    ) -> Self {
        let k = (PI * frequency_hz * sample_time_s).tan();
        let of = |c0: f64, c1: f64, c2: f64| {
            let (constant, slope) = (c0 * k * k + c2, c1 * k);
            [constant + slope, 2.0 * (c0 * k * k - c2), constant - slope]
        };
        let [a0, a1, a2] = of(1.0, 2.0 * damping, 1.0);
        let b = of(n0, n1, n2).map(|b| b / a0);
        Self {
            b,
            a: [a1 / a0, a2 / a0],
            state: [0.0; 2],
        }
    }

    /// Puts the filter where a constant input has led it.
    pub(crate) fn settle(&mut self, input: f64) {
        let [b0, _, b2] = self.b;
        self.state = [input * (1.0 - b0), input * (b2 - self.a[1])];
    }

    /// The output at this sample.
    pub(crate) fn step(&mut self, input: f64) -> f64 {
        let ([b0, b1, b2], [a1, a2], [first, second]) = (self.b, self.a, self.state);
        let output = b0 * input + first;
        self.state = [b1 * input - a1 * output + second, b2 * input - a2 * output];
        output
    }

    /// The filter behind a controller, as one linear system.
    pub(crate) fn behind(&self, controller: &LinearController) -> LinearController {
        let ([b0, b1, b2], [a1, a2]) = (self.b, self.a);
        // from the controller's torque v to x = (first, second): x' = own x + from v, y = x1 + b0 v
        let own = DMatrix::from_row_slice(2, 2, &[-a1, 1.0, -a2, 0.0]);
        let from = DVector::from_row_slice(&[b1 - a1 * b0, b2 - a2 * b0]);
        let LinearController {
            a,
            b,
            c,
            d,
            delay_samples,
        } = controller;
        let n = a.nrows();
        let mut joined = DMatrix::zeros(n + 2, n + 2);
        joined.view_mut((0, 0), (n, n)).copy_from(a);
        joined.view_mut((n, 0), (2, n)).copy_from(&(&from * c));
        joined.view_mut((n, n), (2, 2)).copy_from(&own);
        LinearController {
            a: joined,
            b: DVector::from_iterator(n + 2, b.iter().copied().chain(from.iter().map(|x| x * d))),
            c: RowDVector::from_iterator(n + 2, c.iter().map(|c| b0 * c).chain([1.0, 0.0])),
            d: b0 * d,
            delay_samples: *delay_samples,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_complex::Complex64;
    use std::f64::consts::{FRAC_1_SQRT_2, TAU};

    const T: f64 = 1e-3;

    fn assert_close(filter: &Biquad, b: [f64; 3], a: [f64; 2]) {
        let found = filter.b.iter().chain(&filter.a);
        for (found, golden) in found.zip(b.iter().chain(&a)) {
            assert!((found - golden).abs() < 1e-14, "{filter:?}");
        }
    }

    fn response(filter: &Biquad, hz: f64) -> Complex64 {
        let back = Complex64::cis(-TAU * hz * T);
        let ([b0, b1, b2], [a1, a2]) = (filter.b, filter.a);
        (b0 + back * (b1 + back * b2)) / (1.0 + back * (a1 + back * a2))
    }

    /// `scipy.signal.butter(2, 120, fs=1000)`, `iirnotch(43, 8, fs=1000)`, and
    /// `bilinear([w**2], [1, 0.8 * w, w**2], 1000)` with w = 2000 tan(0.2 pi), by scipy 1.17.
    #[test]
    fn the_coefficients_are_those_of_scipy() {
        assert_close(
            &Biquad::low_pass(120.0, FRAC_1_SQRT_2, T),
            [
                0.09131490043583196,
                0.18262980087166392,
                0.09131490043583196,
            ],
            [-0.9824057931083952, 0.34766539485172315],
        );
        assert_close(
            &Biquad::notch(43.0, 43.0 / 8.0, 0.0, T),
            [0.9833927913329433, -1.8954378361345283, 0.9833927913329433],
            [-1.8954378361345283, 0.9667855826658867],
        );
        assert_close(
            &Biquad::low_pass(200.0, 0.4, T),
            [0.2502795167082812, 0.5005590334165624, 0.2502795167082812],
            [-0.44771361018840916, 0.448831677021534],
        );
    }

    #[test]
    fn a_notch_leaves_its_gain_at_its_frequency_and_is_as_wide_as_it_says() {
        for gain in [0.0, 0.3, 1.0] {
            let filter = Biquad::notch(60.0, 12.0, gain, T);
            assert!((response(&filter, 60.0) - gain).norm() < 1e-12);
            assert!((response(&filter, 1e-6) - 1.0).norm() < 1e-6);
        }
        let complete = Biquad::notch(60.0, 12.0, 0.0, T);
        let edge = |mut inside: f64, mut outside: f64| {
            for _ in 0..60 {
                let middle = 0.5 * (inside + outside);
                if response(&complete, middle).norm() < FRAC_1_SQRT_2 {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            inside
        };
        assert!((edge(60.0, 100.0) - edge(60.0, 20.0) - 12.0).abs() < 1e-9);
    }

    #[test]
    fn a_settled_filter_stays_where_it_is() {
        for mut filter in [
            Biquad::low_pass(90.0, 0.5, T),
            Biquad::notch(50.0, 9.0, 0.2, T),
        ] {
            filter.settle(7.0);
            assert!((0..20).all(|_| (filter.step(7.0) - 7.0).abs() < 1e-12));
        }
    }
}
