//! Survey of a signal: its part that changes, its range and its rms.

/// A spread below this many roundings of the largest value is none: readings of a sensor that
/// stands still, converted to another unit or shifted.
const ROUNDINGS: f64 = 4.0;

/// Values closer than this part of the range are one, written with another rounding.
const ONE_VALUE: f64 = 1e-6;

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
        let (low, high) = extremes(samples)?;
        let start = last_before_changes(samples)?;
        let moving = &samples[start..=first_after_changes(samples)?];
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

    /// Distance within which values are one.
    pub(super) fn one_value(&self) -> f64 {
        ONE_VALUE * self.range()
    }

    /// The samples of the moving part that are numbers.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> {
        numbers(self.moving)
    }
}

/// Samples that are numbers.
pub(super) fn numbers(samples: &[f64]) -> impl DoubleEndedIterator<Item = f64> {
    samples.iter().copied().filter(|x| x.is_finite())
}

/// Smallest and largest value, if they differ by more than rounding.
fn extremes(samples: &[f64]) -> Option<(f64, f64)> {
    let low = numbers(samples).reduce(f64::min)?;
    let high = numbers(samples).reduce(f64::max)?;
    let rounding = ROUNDINGS * f64::EPSILON * high.abs().max(low.abs());
    (high - low > rounding).then_some((low, high))
}

/// Place of the last number before the first change.
fn last_before_changes(samples: &[f64]) -> Option<usize> {
    let rest = numbers(samples).next()?;
    let first = samples.iter().position(differs_from(rest))?;
    samples[..first].iter().rposition(|x| x.is_finite())
}

/// Place of the first number after the last change.
fn first_after_changes(samples: &[f64]) -> Option<usize> {
    let rest = numbers(samples).next_back()?;
    let last = samples.iter().rposition(differs_from(rest))?;
    (last + 1..samples.len()).find(|&k| samples[k].is_finite())
}

/// Whether a sample is a number, and another one.
fn differs_from(rest: f64) -> impl Fn(&f64) -> bool {
    move |x| x.is_finite() && *x != rest
}

/// Adds a value to rising ones in its place, if none is there within the tolerance.
pub(super) fn insert(values: &mut Vec<f64>, x: f64, tolerance: f64) {
    let place = values.partition_point(|&value| value < x - tolerance);
    if values.get(place).is_none_or(|&value| value > x + tolerance) {
        values.insert(place, x);
    }
}

/// Rms about the mean, with values counted from `near`, so that a large offset takes no digits.
fn rms_about_mean(samples: &[f64], near: f64) -> f64 {
    let count = numbers(samples).count() as f64;
    let shifted = || numbers(samples).map(|x| x - near);
    let mean = shifted().sum::<f64>() / count;
    let square = shifted().map(|x| x * x).sum::<f64>() / count;
    (square - mean.powi(2)).max(0.0).sqrt()
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
