//! Planner of Fourier transforms of real signals.
//!
//! A crate of its own because the planner of [`realfft`] is generic: each crate that names it compiles every transform of
//! rustfft once more, two thirds of what `signals` took and a quarter of `estimate`, in their tests again.

mod odd_lines;

use std::sync::{Arc, Mutex};

pub use crate::odd_lines::OddLines;
use realfft::RealFftPlanner;
pub use realfft::{ComplexToReal, RealToComplex};
use rustfft::FftPlanner;

/// Samples of the longest transform that is kept: its factors take 14 bytes for each of them.
const LONGEST_KEPT: usize = 1 << 20;

/// The inverse transform that was planned last, and its number of samples.
static LAST: Mutex<Option<(usize, Inverse)>> = Mutex::new(None);

/// An inverse transform.
pub type Inverse = Arc<dyn ComplexToReal<f64>>;

/// As [`TransformPlanner::inverse`] of a planner of its own, for periods that are made one after the other: the last one
/// is kept for all threads, as its factors take as long as many transforms. It waits for no other thread, which a forked
/// child may not have.
pub fn kept_inverse(n_samples: usize) -> Inverse {
    if let Ok(last) = LAST.try_lock()
        && let Some((_, kept)) = last.as_ref().filter(|(length, _)| *length == n_samples)
    {
        return Arc::clone(kept);
    }
    let inverse = TransformPlanner::default().inverse(n_samples);
    if n_samples <= LONGEST_KEPT
        && let Ok(mut last) = LAST.try_lock()
    {
        *last = Some((n_samples, Arc::clone(&inverse)));
    }
    inverse
}

/// Plans transforms, and keeps what they have in common.
#[derive(Default)]
pub struct TransformPlanner(RealFftPlanner<f64>);

impl TransformPlanner {
    /// From `n_samples` real samples to `n_samples / 2 + 1` complex ones, not scaled.
    pub fn forward(&mut self, n_samples: usize) -> Arc<dyn RealToComplex<f64>> {
        self.0.plan_fft_forward(n_samples)
    }

    /// From `n_samples / 2 + 1` complex samples to `n_samples` real ones, not scaled.
    pub fn inverse(&mut self, n_samples: usize) -> Arc<dyn ComplexToReal<f64>> {
        self.0.plan_fft_inverse(n_samples)
    }

    /// From `n_samples` real samples, a multiple of four, to their odd lines.
    ///
    /// # Panics
    /// For another number.
    pub fn odd_lines(&mut self, n_samples: usize) -> OddLines {
        assert_eq!(n_samples % 4, 0, "samples are packed by four");
        OddLines::by(FftPlanner::new().plan_fft_forward(n_samples / 4))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_inverse_is_kept_unless_it_is_long() {
        let first = kept_inverse(64);
        assert!(Arc::ptr_eq(&first, &kept_inverse(64)));
        let long = kept_inverse(LONGEST_KEPT + 2);
        assert_eq!(long.len(), LONGEST_KEPT + 2);
        assert!(Arc::ptr_eq(&first, &kept_inverse(64)));
        assert_eq!(kept_inverse(66).len(), 66);
        assert!(!Arc::ptr_eq(&first, &kept_inverse(64)));
    }
}
