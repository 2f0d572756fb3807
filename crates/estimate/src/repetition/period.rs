//! Period of a recorded reference in whole samples, found from the recording alone.

use ndarray::ArrayView2;

use crate::error::EstimateError;
use crate::repetition::find_repetition;

/// Period in whole samples of a reference `(channel, sample)` that repeats back to back at least
/// twice somewhere: the nearest to that of [`find_repetition`], which also tells where.
///
/// # Errors
/// Those of [`find_repetition`].
pub fn find_period(reference: ArrayView2<f64>) -> Result<usize, EstimateError> {
    find_repetition(reference, None).map(|found| found.period.round() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;
    use frfid_signals::random::{normal, phase, stream};
    use ndarray::Array2;
    use std::f64::consts::TAU;

    /// Two channels of a random-phase multisine of lines up to `highest`, `periods` of them (a part
    /// of one counts).
    fn multisine(
        period: usize,
        highest: usize,
        periods: f64,
        noise: f64,
        seed: u64,
    ) -> Array2<f64> {
        let mut rng = stream(seed, "multisine", &[]);
        let phases: Vec<f64> = (0..2 * highest).map(|_| phase(&mut rng)).collect();
        let cycle = Array2::from_shape_fn((2, period), |(c, k)| {
            (1..=highest)
                .map(|h| (TAU * (h * k) as f64 / period as f64 + phases[c * highest + h - 1]).sin())
                .sum::<f64>()
        });
        let scale = noise * (highest as f64 / 2.0).sqrt();
        Array2::from_shape_fn((2, (periods * period as f64) as usize), |(c, k)| {
            cycle[[c, k % period]] + scale * normal(&mut rng)
        })
    }

    #[test]
    fn any_length_is_found_clean_or_noisy_from_two_periods_on() {
        for (period, highest, periods) in [
            (2500, 60, 4.7),
            (997, 20, 2.0),
            (1983, 5, 3.0),
            (64, 1, 30.0),
        ] {
            for noise in [0.0, 1e-3, 0.1] {
                let found = find_period(multisine(period, highest, periods, noise, 3).view());
                // noise of a tenth hides a difference of one sample in a slow signal: then the
                // neighbours are right too
                let slack = if noise > 0.01 && highest < 10 { 1 } else { 0 };
                assert!(
                    found
                        .as_ref()
                        .is_ok_and(|found| found.abs_diff(period) <= slack),
                    "{found:?} for {period}, noise {noise}"
                );
            }
        }
    }

    /// A running sum over 2e6 samples must not hide that every 500 are alike.
    #[test]
    fn a_long_clean_signal_is_found_at_its_shortest() {
        let period = multisine(500, 200, 1.0, 0.0, 5);
        let long = Array2::from_shape_fn((1, 2_000_000), |(c, k)| period[[c, k % 500]]);
        assert_eq!(find_period(long.view()), Ok(500));
    }

    /// Its correlation is highest before the period, and twice the period explains as much.
    #[test]
    fn a_slow_signal_is_found_once_a_period() {
        for period in [620, 6240] {
            for periods in [2.0, 3.98, 4.0, 5.1, 8.5] {
                let found = find_period(multisine(period, 2, periods, 0.0, 2).view());
                assert_eq!(found, Ok(period), "{periods} periods");
            }
        }
    }

    #[test]
    fn what_does_not_repeat_is_refused() {
        let noise = multisine(100, 1, 30.0, 1e6, 1);
        assert!(
            matches!(find_period(noise.view()), Err(EstimateError::NotPeriodic { residual, .. }) if residual > 0.5)
        );
        let sweep = Array2::from_shape_fn((1, 20_000), |(_, k)| (1e-5 * (k as f64).powi(2)).sin());
        let less_than_two_periods = multisine(2500, 60, 1.9, 0.0, 1);
        for not_periodic in [
            sweep,
            less_than_two_periods,
            Array2::zeros((1, 100)),
            Array2::ones((2, 1)),
        ] {
            assert!(matches!(
                find_period(not_periodic.view()),
                Err(EstimateError::NotPeriodic { .. })
            ));
        }
        let said = refusal(find_period(Array2::zeros((0, 10)).view()));
        assert!(said.starts_with("reference has shape [0, 10]"), "{said}");
        let said = refusal(find_period(Array2::from_elem((1, 9), f64::NAN).view()));
        assert!(said.starts_with("reference: 9 samples are NaN"), "{said}");
    }
}
