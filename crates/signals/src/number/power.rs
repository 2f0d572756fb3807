//! Power, rms and crest factor of sampled signals.

use ndarray::ArrayView1;

/// Mean power `mean x^2` of the samples; 0 of none.
#[must_use]
pub fn mean_power(samples: &[f64]) -> f64 {
    samples.iter().map(|x| x * x).sum::<f64>() / samples.len().max(1) as f64
}

/// Root mean square `sqrt(mean x^2)` of the samples, in their unit.
#[must_use]
pub fn rms(samples: &[f64]) -> f64 {
    mean_power(samples).sqrt()
}

/// Largest magnitude among the samples, in their unit. The true peak of a multisine lies between
/// samples: [`crate::Realization::peak`] holds that one.
#[must_use]
pub fn sample_peak(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()))
}

/// A signal without its mean.
#[must_use]
pub fn about_mean(signal: ArrayView1<f64>) -> Vec<f64> {
    let mean = signal.mean().unwrap_or(0.0);
    signal.iter().map(|x| x - mean).collect()
}

/// Crest factor `peak / rms`, as everywhere in frfid (SK15 calls the ratio of the *powers* by that
/// name: its square).
#[must_use]
pub fn crest_factor(peak: f64, rms: f64) -> f64 {
    peak / rms
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_has_crest_factor_root_two() {
        let sine: Vec<f64> = (0..1000)
            .map(|k| 3.0 * (std::f64::consts::TAU * (k as f64 + 0.5) / 1000.0 * 25.0).sin())
            .collect();
        assert!((mean_power(&sine) - 4.5).abs() < 1e-12);
        assert!((crest_factor(3.0, rms(&sine)) - 2.0f64.sqrt()).abs() < 1e-12);
        assert!(sample_peak(&sine) <= 3.0 && sample_peak(&sine) > 2.98);
    }
}
