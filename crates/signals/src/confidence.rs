//! Confidence regions of FRF entries: circles in the complex plane.

use crate::frf::Uncertainty;

/// Quantile of the F distribution with 2 numerator and `denominator` degrees of freedom, in closed
/// form: `F_p(2, m) = m/2 ((1 - p)^(-2/m) - 1)`.
pub(crate) fn f_quantile(probability: f64, denominator: f64) -> f64 {
    // expm1 keeps the digits for large m, where the quantile tends to -ln(1 - p)
    0.5 * denominator * (-2.0 / denominator * (-probability).ln_1p()).exp_m1()
}

/// Factor from a variance with so many complex degrees of freedom to the squared radius of the 95 % region of
/// an entry, `F_95(2, 2 dof)`; infinite without any.
#[must_use]
pub fn confidence_factor_95(degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom > 0.0 {
        f_quantile(0.95, 2.0 * degrees_of_freedom)
    } else {
        f64::INFINITY
    }
}

impl Uncertainty {
    /// Factor from a variance to the squared radius of the 95 % region of an entry,
    /// `|dG|^2 <= variance F_95(2, 2 dof)`; infinite without degrees of freedom. They are complex,
    /// hence two real ones each.
    #[must_use]
    pub fn confidence_factor_95(&self) -> f64 {
        confidence_factor_95(self.degrees_of_freedom)
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array3;

    use super::*;

    #[test]
    fn degrees_of_freedom_need_not_be_whole() {
        let factor = |degrees_of_freedom| {
            let covariance = Array3::zeros((1, 1, 1));
            let known = Uncertainty {
                covariance,
                degrees_of_freedom,
            };
            known.confidence_factor_95()
        };
        // scipy 1.17: `scipy.stats.f.ppf(0.95, 2, 5)`
        assert!((factor(2.5) - 5.786135043349963).abs() < 1e-12);
        assert_eq!(factor(0.0), f64::INFINITY);
    }

    /// scipy 1.17: `scipy.stats.f.ppf(p, 2, m)`.
    #[test]
    fn quantiles_are_those_of_scipy() {
        for (probability, denominator, expected) in [
            (0.95, 2.0, 18.999999999999982),
            (0.95, 4.0, 6.944271909999155),
            (0.95, 18.0, 3.554557145661787),
            (0.95, 80.0, 3.110766166080458),
            (0.95, 98.0, 3.0892030130201853),
            (0.99, 5.0, 13.273933612004825),
            (0.5, 1.0, 1.5),
            (0.95, 1000000.0, 2.995741247983768),
        ] {
            let found = f_quantile(probability, denominator);
            assert!(
                (found / expected - 1.0).abs() < 1e-12,
                "F_{probability}(2, {denominator}) = {found}, scipy {expected}"
            );
        }
    }
}
