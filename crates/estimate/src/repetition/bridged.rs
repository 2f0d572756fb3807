//! Recording with holes so long that nothing repeats back to back for long enough, while what is there
//! on either side of them repeats after whole periods.

use crate::correlation::channel::Channel;
use crate::repetition::runs::LIMIT;
use crate::repetition::{Repetition, n_periods};

/// So many periods later a sample is looked for again, at most.
const MOST_LAGS: usize = 16;
/// Fewer pairs than in this part of a period say nothing.
const FEWEST: f64 = 1.0 / 16.0;

/// The recording as one run of a period, from its first sample to its last, if samples of it are lost
/// and all that can be compared of the others, over one period or more, repeats.
pub(super) fn bridged(channels: &[Channel], period: f64) -> Option<Repetition> {
    let n_samples = Channel::n_samples(channels);
    let present = |k: &usize| !Channel::are_lost(channels, *k);
    let (first, last) = (
        (0..n_samples).find(present)?,
        (0..n_samples).rfind(present)?,
    );
    let is_holed = !(first..=last).all(|k| present(&k));
    if !is_holed || n_periods(last + 1 - first, period) < 2 {
        return None;
    }
    let lags = (1..=MOST_LAGS).map(|count| (count as f64 * period).round() as usize);
    let mut compared: Vec<Compared> = lags.map(|lag| Compared::of(channels, lag)).collect();
    compared.retain(|compared| compared.n_pairs as f64 > FEWEST * period);
    let n_pairs: usize = compared.iter().map(|compared| compared.n_pairs).sum();
    let residual = compared.iter().map(Compared::residual).fold(0.0, f64::max);
    (n_pairs as f64 >= period && residual <= LIMIT).then(|| Repetition {
        period,
        runs: std::iter::once(first..last + 1).collect(),
        rests: Vec::new(),
        residual,
    })
}

/// Samples and those so much later, where both are there.
#[derive(Default)]
struct Compared {
    n_pairs: usize,
    difference: f64,
    power: f64,
}

impl Compared {
    fn of(channels: &[Channel], lag: usize) -> Self {
        let mut compared = Self::default();
        let n_pairs = Channel::n_samples(channels).saturating_sub(lag);
        for k in 0..n_pairs {
            compared.take(channels, k, k + lag);
        }
        compared
    }

    fn take(&mut self, channels: &[Channel], k: usize, later: usize) {
        let pairs = channels.iter().map(Channel::values);
        let pairs = pairs.map(|values| (values[k], values[later]));
        let mut present = pairs.filter(|(a, b)| !a.is_nan() && !b.is_nan()).peekable();
        self.n_pairs += usize::from(present.peek().is_some());
        for (a, b) in present {
            self.difference += (a - b).powi(2);
            self.power += a * a + b * b;
        }
    }

    /// Share of the power that does not repeat.
    fn residual(&self) -> f64 {
        self.difference / self.power
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use crate::repetition::find_repetition;

    /// Five periods of 250 samples, of which a stretch is lost.
    fn holed(lost: std::ops::Range<usize>, wave: fn(usize) -> f64) -> Array2<f64> {
        Array2::from_shape_fn((1, 1250), |(_, k)| match lost.contains(&k) {
            true => f64::NAN,
            false => wave(k),
        })
    }

    /// A periodic mixture, and one without a period.
    fn mixture(k: usize) -> f64 {
        let phase = std::f64::consts::TAU * k as f64 / 250.0;
        (1..30)
            .map(|line| (f64::from(line) * phase + f64::from(line * line)).cos())
            .sum()
    }

    fn endless(k: usize) -> f64 {
        let phase = std::f64::consts::TAU * k as f64 / 250.0;
        (1..30)
            .map(|line| (f64::from(line).powf(1.37) * phase + f64::from(line * line)).cos())
            .sum()
    }

    #[test]
    fn whole_periods_on_both_sides_of_a_hole_are_one_run() {
        for (lost, period) in [
            (220..741, None),
            (515..822, Some(250.0)),
            (120..620, Some(250.0)),
        ] {
            let found = find_repetition(holed(lost, mixture).view(), period).expect("it repeats");
            assert!((found.period - 250.0).abs() < 1e-6, "{}", found.period);
            assert_eq!(found.runs, std::slice::from_ref(&(0..1250)));
        }
        for period in [None, Some(250.0)] {
            assert!(find_repetition(holed(220..741, endless).view(), period).is_err());
        }
        assert!(find_repetition(holed(220..741, mixture).view(), Some(240.0)).is_err());
    }

    #[test]
    fn a_refusal_does_not_contradict_itself() {
        let short = holed(0..0, mixture);
        let short = short.slice(ndarray::s![.., ..300]);
        for signal in [short, holed(220..741, endless).view()] {
            let Err(error) = find_repetition(signal, Some(250.0)) else {
                continue;
            };
            let told = error.to_string();
            assert!(!told.contains("leaves 0.0e0"), "{told}");
        }
    }
}
