//! Survey of a signal: its part that changes, its range and its rms.

/// A spread below this many roundings of the largest value is none: readings of a sensor that
/// stands still, converted to another unit or shifted.
const ROUNDINGS: f64 = 4.0;

/// Values closer than this part of the range are one, written with another rounding.
pub(super) const ONE_VALUE: f64 = 1e-6;

/// What all looks at a signal need.
pub(super) struct Survey<'a> {
    /// From the last sample before the first change to the first one after the last change.
    pub(super) moving: &'a [f64],
    /// Place of the first of these in the signal.
    pub(super) start: usize,
    /// Smallest value.
    pub(super) low: f64,
    /// Largest value.
    pub(super) high: f64,
    /// Rms of the moving part about its mean.
    pub(super) rms: f64,
}

impl<'a> Survey<'a> {
    /// `None` for a signal without a change beyond rounding.
    pub(super) fn of(samples: &'a [f64]) -> Option<Self> {
        let numbers = || samples.iter().copied().filter(|x| x.is_finite());
        let (first, last) = (numbers().next()?, numbers().next_back()?);
        let (low, high) =
            numbers().fold((first, first), |(low, high), x| (low.min(x), high.max(x)));
        if high - low <= ROUNDINGS * f64::EPSILON * high.abs().max(low.abs()) {
            return None;
        }
        let differs = |rest: f64| move |x: &f64| x.is_finite() && *x != rest;
        let first_change = samples.iter().position(differs(first))?;
        let last_change = samples.iter().rposition(differs(last))?;
        let before = samples[..first_change].iter().rposition(|x| x.is_finite());
        let after = samples[last_change..]
            .iter()
            .skip(1)
            .position(|x| x.is_finite());
        let start = before.unwrap_or(first_change);
        let end = last_change + after.map_or(0, |after| after + 1);
        let moving = &samples[start..=end];
        Some(Self {
            moving,
            start,
            low,
            high,
            rms: rms_about_mean(moving, low),
        })
    }

    /// Largest less smallest value.
    pub(super) fn range(&self) -> f64 {
        self.high - self.low
    }

    /// The samples of the moving part that are numbers.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.moving.iter().copied().filter(|x| x.is_finite())
    }
}

/// Rms about the mean, with values counted from `near`, so that a large offset takes no digits.
fn rms_about_mean(samples: &[f64], near: f64) -> f64 {
    let numbers = samples.iter().filter(|x| x.is_finite());
    let (count, sum, square) = numbers.fold((0.0, 0.0, 0.0), |(count, sum, square), x| {
        let x = x - near;
        (count + 1.0, sum + x, square + x * x)
    });
    (square / count - (sum / count).powi(2)).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rest_at_either_end_is_left_out_and_lost_samples_are_no_change() {
        let samples = [5.0, f64::NAN, 5.0, 5.0, 6.0, 8.0, f64::NAN, 2.0, 2.0, 2.0];
        let survey = Survey::of(&samples).expect("changes");
        assert_eq!((survey.start, survey.moving.len()), (3, 5));
        assert_eq!((survey.low, survey.high), (2.0, 8.0));
        let mean = (5.0 + 6.0 + 8.0 + 2.0) / 4.0;
        let square = [5.0, 6.0, 8.0, 2.0].map(|x: f64| (x - mean).powi(2));
        assert!((survey.rms - (square.iter().sum::<f64>() / 4.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_differs_by_rounding_does_not_change() {
        for still in [
            vec![],
            vec![1.0],
            vec![f64::NAN; 4],
            vec![0.3; 9],
            vec![0.1 + 0.2, 0.3, 0.3],
        ] {
            assert!(Survey::of(&still).is_none(), "{still:?}");
        }
        assert!(Survey::of(&[0.3, 0.3 + 1e-15, 0.3]).is_some());
    }
}
