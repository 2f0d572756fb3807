//! Pooling of what narrow bands say of one friction: by their variances and what they differ by beyond them.
//!
//! Source: R. DerSimonian, N. Laird, Meta-analysis in clinical trials, Controlled Clinical Trials 7 (1986) 177-188.

use num_complex::Complex64;

use crate::friction::axes::window::Answer;

/// The friction of an axis over all bands.
pub(super) struct Pooled<'a> {
    answers: &'a [Answer],
    delay_s: f64,
    weights: Vec<f64>,
    pub(super) coulomb_nm: f64,
    /// What the bands differ by beyond their noise, as a standard deviation.
    pub(super) between_nm: f64,
}

impl<'a> Pooled<'a> {
    /// Of signs that are so much too late.
    pub(super) fn of(answers: &'a [Answer], delay_s: f64) -> Self {
        let by_noise = answers.iter().map(|answer| answer.variance.recip());
        let mut pooled = Self {
            answers,
            delay_s,
            weights: by_noise.collect(),
            coulomb_nm: 0.0,
            between_nm: 0.0,
        };
        let between = pooled.variance_between();
        let weights = answers.iter().map(|answer| answer.variance + between);
        pooled.weights = weights.map(f64::recip).collect();
        pooled.coulomb_nm = pooled.mean();
        pooled.between_nm = between.sqrt();
        pooled
    }

    /// F without its delay, band by band.
    fn turned(&self) -> impl Iterator<Item = Complex64> {
        let turn = |answer: &Answer| Complex64::cis(-answer.rad_per_s * self.delay_s);
        let answers = self.answers.iter();
        answers.map(move |answer| answer.friction_nm * turn(answer))
    }

    fn total(&self) -> f64 {
        self.weights.iter().sum()
    }

    fn mean(&self) -> f64 {
        let values = self.turned().zip(&self.weights);
        values.map(|(value, weight)| weight * value.re).sum::<f64>() / self.total()
    }

    /// Variance between the bands, by moments, of weights that are one over their own.
    fn variance_between(&self) -> f64 {
        let mean = self.mean();
        let scatter = self.turned().zip(&self.weights);
        let scatter: f64 = scatter
            .map(|(value, weight)| weight * (value.re - mean).powi(2))
            .sum();
        let squares: f64 = self.weights.iter().map(|weight| weight * weight).sum();
        let expected = self.weights.len() as f64 - 1.0;
        ((scatter - expected) / (self.total() - squares / self.total())).max(0.0)
    }

    /// Standard error of the mean, from what the bands differ by.
    pub(super) fn standard_error_nm(&self) -> f64 {
        let squares = self.turned().zip(&self.weights);
        let square =
            |(value, weight): (Complex64, &f64)| (weight * (value.re - self.coulomb_nm)).powi(2);
        squares.map(square).sum::<f64>().sqrt() / self.total()
    }

    /// Right side and factor of the equation for what the delay lacks.
    pub(super) fn delay_equation(&self) -> [f64; 2] {
        let bands = self.turned().zip(self.answers).zip(&self.weights);
        let terms = bands.map(|((value, answer), weight)| {
            let slope = self.coulomb_nm * answer.rad_per_s;
            [weight * slope * value.im, weight * slope * slope]
        });
        terms.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d])
    }
}
