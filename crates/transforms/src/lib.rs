//! Planner of Fourier transforms of real signals.
//!
//! A crate of its own because the planner of [`realfft`] is generic: each crate that names it compiles every transform of
//! rustfft once more, two thirds of what `signals` took and a quarter of `estimate`, in their tests again.

use std::sync::Arc;

use realfft::RealFftPlanner;
pub use realfft::{ComplexToReal, RealToComplex};

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
}
