//! Curve through even samples: cubic pieces with slopes by differences, as cheap as a fit needs it.

/// Samples with their slopes.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    step_s: f64,
    values: Vec<f64>,
    /// Slopes by step.
    slopes: Vec<f64>,
}

impl Curve {
    pub(super) fn through(values: Vec<f64>, step_s: f64) -> Self {
        let last = values.len().saturating_sub(1) as isize;
        let at = |k: isize| values[k.clamp(0, last) as usize];
        let slope = |k: usize| {
            let k = k as isize;
            let by = |reach: isize| at(k + reach) - at(k - reach);
            // exact up to the sixth degree, away from the ends
            (45.0 * by(1) - 9.0 * by(2) + by(3)) / 60.0
        };
        let slopes = (0..values.len()).map(slope).collect();
        Self {
            step_s,
            values,
            slopes,
        }
    }

    /// Value and slope by second at a time in s; held beyond the ends.
    pub(super) fn at(&self, time_s: f64) -> (f64, f64) {
        let last = self.values.len() - 1;
        let place = time_s / self.step_s;
        let before = (place.max(0.0) as usize).min(last.saturating_sub(1));
        let after = (before + 1).min(last);
        let x = (place - before as f64).clamp(0.0, 1.0);
        let (a, b) = (self.values[before], self.values[after]);
        let (p, q) = (self.slopes[before], self.slopes[after]);
        let rise = b - a;
        let (bend, twist) = (3.0 * rise - 2.0 * p - q, p + q - 2.0 * rise);
        let value = a + x * (p + x * (bend + x * twist));
        let slope = p + x * (2.0 * bend + 3.0 * x * twist);
        (value, slope / self.step_s)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn a_sine_of_sixteen_samples_is_kept_to_a_part_in_ten_thousand() {
        let omega = TAU * 62.5;
        let values = (0..200).map(|k| (omega * 1e-3 * f64::from(k)).sin());
        let curve = Curve::through(values.collect(), 1e-3);
        for k in 0..1000 {
            let t = 0.02 + 1.37e-4 * f64::from(k);
            let (value, slope) = curve.at(t);
            assert!((value - (omega * t).sin()).abs() < 1e-4);
            assert!((slope / omega - (omega * t).cos()).abs() < 3e-3);
        }
        assert_eq!(curve.at(-1.0).0, 0.0);
    }
}
