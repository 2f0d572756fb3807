//! Scatter of the lines of one curve: their variances, and the same pooled over neighbours where
//! few degrees of freedom are behind each.

/// Complex degrees of freedom that a pooled variance should have: weights of that many bias a
/// least-squares fit and its standard errors by a few per cent.
const POOLED: f64 = 40.0;
/// Neighbours on each side at most: noise is level over so few lines.
const REACH: usize = 5;

/// Variances E|dG|^2 of the lines of a curve.
pub(crate) struct Scatter {
    /// Of each line.
    pub(crate) variance: Vec<f64>,
    /// Mean over a line and its neighbours.
    pub(crate) pooled: Vec<f64>,
    /// Complex degrees of freedom of the pooled ones, away from the ends.
    pub(crate) pooled_dof: f64,
}

impl Scatter {
    /// Of variances with `dof` complex degrees of freedom each.
    pub(crate) fn of(variance: Vec<f64>, dof: f64) -> Self {
        let needed = (POOLED / dof.max(1.0)).ceil();
        let reach = (((needed - 1.0) / 2.0).ceil() as usize).min(REACH);
        let mean = |lines: &[f64]| lines.iter().sum::<f64>() / lines.len() as f64;
        let pooled = (0..variance.len()).map(|k| {
            let end = variance.len().min(k + reach + 1);
            mean(&variance[k.saturating_sub(reach)..end])
        });
        Self {
            pooled: pooled.collect(),
            variance,
            pooled_dof: dof * (2 * reach + 1) as f64,
        }
    }

    /// Radius of a region that all lines of the curve keep to at once with `probability`
    /// (Bonferroni), by the larger of a line's own variance and the pooled one:
    /// `|dG|^2 <= variance F(2, 2 dof)`. Infinite where the variance is not known.
    pub(crate) fn radius(&self, k: usize, probability: f64) -> f64 {
        let beyond = (1.0 - probability) / self.variance.len() as f64;
        let factor = self.pooled_dof * (-beyond.ln() / self.pooled_dof).exp_m1();
        let variance = self.variance[k].max(self.pooled[k]);
        let radius = (variance * factor).sqrt();
        if radius.is_nan() || self.variance[k].is_nan() {
            f64::INFINITY
        } else {
            radius
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_of_many_degrees_of_freedom_has_the_radius_of_rayleigh() {
        let scatter = Scatter::of(vec![4.0], 1e6);
        let expected = (4.0 * -(0.05f64.ln())).sqrt();
        assert!((scatter.radius(0, 0.95) / expected - 1.0).abs() < 1e-5);
        let unknown = Scatter::of(vec![1.0, f64::NAN, 1.0], 50.0);
        assert!(unknown.radius(1, 0.95).is_infinite() && unknown.radius(0, 0.95).is_finite());
    }

    #[test]
    fn few_degrees_of_freedom_are_pooled_over_neighbours() {
        let scatter = Scatter::of((0..21).map(f64::from).collect(), 4.0);
        assert!((scatter.pooled[10] - 10.0).abs() < 1e-12 && scatter.pooled_dof >= 40.0);
        assert_eq!(Scatter::of(vec![1.0, 9.0], 40.0).pooled, [1.0, 9.0]);
    }
}
