//! The sample clock of a recording, from its stamps. A recording is never resampled: a clock that
//! does not fit is refused.

use crate::run::header::MOST_VALUES;

/// What the stamps of one topic say.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Clock {
    /// Sample time in s: the mean distance of the stamps, gaps counted as what they are.
    pub(crate) sample_time_s: f64,
    /// Sample number of every stamp, the first one being 0.
    pub(crate) slots: Vec<usize>,
    /// Deviation of the stamps from an even grid, standard deviation in parts of the sample time.
    pub(crate) jitter: f64,
    /// The same, largest.
    pub(crate) largest_jitter: f64,
    /// Mean place of sample 0 in ns after the first stamp.
    pub(crate) origin_ns: f64,
}

/// What is wrong with the stamps: found, needed.
pub(crate) type Flaw = (String, String);

pub(crate) fn flaw<T>(found: impl Into<String>, needed: impl Into<String>) -> Result<T, Flaw> {
    Err((found.into(), needed.into()))
}

/// Above this share of the sample time, jitter is worth a warning.
pub(crate) const NOTABLE_JITTER: f64 = 0.01;
/// Above this share, samples cannot be taken as evenly spaced.
pub(crate) const MOST_JITTER: f64 = 0.2;

impl Clock {
    /// Fits an even grid to rising stamps in ns, or says what is wrong: found, needed.
    pub(crate) fn fit(stamps_ns: &[i64]) -> Result<Self, Flaw> {
        if stamps_ns.len() < 2 {
            return flaw(format!("{} samples", stamps_ns.len()), "at least 2");
        }
        let slots = slots(stamps_ns);
        let last = slots.last().copied().unwrap_or(0);
        if last > MOST_VALUES {
            let needed = format!("at most {MOST_VALUES}");
            return flaw(format!("stamps over {last} samples"), needed);
        }
        let clock = Self::of(stamps_ns, slots);
        clock.check_even()?;
        Ok(clock)
    }

    /// The clock that fits best, even or not.
    fn of(stamps_ns: &[i64], slots: Vec<usize>) -> Self {
        let (step, deviations) = straight_line(stamps_ns, &slots);
        let count = deviations.len() as f64;
        let mean = deviations.iter().sum::<f64>() / count;
        let from_mean = || deviations.iter().map(|deviation| deviation - mean);
        let squares = from_mean().map(|deviation| deviation.powi(2));
        Self {
            sample_time_s: step / 1e9,
            jitter: (squares.sum::<f64>() / count).sqrt(),
            largest_jitter: from_mean().map(f64::abs).fold(0.0, f64::max),
            origin_ns: mean * step,
            slots,
        }
    }

    fn check_even(&self) -> Result<(), Flaw> {
        let pairs = self.slots.windows(2);
        let crowded = pairs.filter(|pair| pair[0] == pair[1]).count();
        if self.jitter <= MOST_JITTER && crowded == 0 {
            return Ok(());
        }
        let found = format!(
            "stamps with a jitter of {:.1} % of the sample time {} s (largest {:.1} %), {crowded} closer than half of it",
            100.0 * self.jitter,
            self.sample_time_s,
            100.0 * self.largest_jitter
        );
        let needed = format!(
            "an even clock, jitter below {} %; frfid does not resample",
            100.0 * MOST_JITTER
        );
        flaw(found, needed)
    }

    /// Number of samples of the grid, missing ones included.
    pub(crate) fn n_slots(&self) -> usize {
        self.slots.last().map_or(0, |last| last + 1)
    }
}

/// The sample of the grid that each stamp belongs to, counted by whole typical steps.
fn slots(stamps_ns: &[i64]) -> Vec<usize> {
    let steps: Vec<f64> = stamps_ns
        .windows(2)
        .map(|pair| pair[1].abs_diff(pair[0]) as f64)
        .collect();
    let typical = typical_step(&steps);
    let mut slots = vec![0_usize];
    let mut slot = 0_usize;
    for step in &steps {
        slot = slot.saturating_add((step / typical).round() as usize);
        slots.push(slot);
    }
    slots
}

/// The step without gaps: the mean of those between half and one and a half times the median. Steps
/// that alternate, as when every second message comes late, average out; the median alone would
/// not.
fn typical_step(steps: &[f64]) -> f64 {
    let mut sorted = steps.to_vec();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[(sorted.len() - 1) / 2];
    let near: Vec<f64> = sorted
        .into_iter()
        .filter(|step| (0.5 * median..=1.5 * median).contains(step))
        .collect();
    near.iter().sum::<f64>() / near.len() as f64
}

/// Step in ns of the straight line through the stamps by least squares, and their deviations from
/// it in steps, counted from the first stamp. On an even grid the line through both ends is exact
/// already, and its correction is exactly zero.
fn straight_line(stamps_ns: &[i64], slots: &[usize]) -> (f64, Vec<f64>) {
    let last = slots.len() - 1;
    let length_ns = stamps_ns[last].abs_diff(stamps_ns[0]) as f64;
    let through_ends = length_ns / slots[last].max(1) as f64;
    let ends = deviations(stamps_ns, slots, through_ends);
    let middle = slots.iter().map(|&slot| slot as f64).sum::<f64>() / slots.len() as f64;
    let (mut lean, mut weight) = (0.0, 0.0);
    for (deviation, &slot) in ends.iter().zip(slots) {
        lean += deviation * (slot as f64 - middle);
        weight += (slot as f64 - middle).powi(2);
    }
    let step = through_ends * (1.0 + lean / weight.max(1.0));
    (step, deviations(stamps_ns, slots, step))
}

/// How many steps the stamps lie behind an even grid from the first of them.
fn deviations(stamps_ns: &[i64], slots: &[usize], step: f64) -> Vec<f64> {
    let from_first = |stamp: &i64| stamp.abs_diff(stamps_ns[0]) as f64;
    let pairs = stamps_ns.iter().zip(slots);
    pairs
        .map(|(stamp, &slot)| from_first(stamp) / step - slot as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_clock_is_exact_to_the_last_bit() {
        let stamps: Vec<i64> = (0..50_000)
            .map(|k| 1_400_000_000_000_000_000 + 400_000 * k)
            .collect();
        let clock = Clock::fit(&stamps).expect("even");
        assert_eq!(
            (clock.sample_time_s, clock.jitter, clock.n_slots()),
            (4e-4, 0.0, 50_000)
        );
    }

    #[test]
    fn gaps_are_found_and_jitter_is_measured() {
        let stamps: Vec<i64> = (0..1000)
            .filter(|k| !(400..=410).contains(k) && *k != 700)
            .map(|k| 1_000_000 * k + if k % 2 == 0 { 50_000 } else { -50_000 })
            .collect();
        let clock = Clock::fit(&stamps).expect("5 % of jitter");
        assert!((clock.jitter - 0.05).abs() < 1e-3 && (clock.sample_time_s - 1e-3).abs() < 1e-6);
        assert_eq!(
            (clock.n_slots(), clock.slots.len(), clock.slots[400]),
            (1000, 988, 411)
        );
    }

    proptest::proptest! {
        #[test]
        fn any_rising_stamps(mut stamps in proptest::collection::vec(proptest::num::i64::ANY, 0..20)) {
            stamps.sort_unstable();
            stamps.dedup();
            if let Ok(clock) = Clock::fit(&stamps) {
                assert!(clock.slots.windows(2).all(|pair| pair[0] < pair[1]) && clock.jitter <= MOST_JITTER);
            }
        }
    }

    #[test]
    fn what_is_no_clock_is_refused() {
        let wild: Vec<i64> = (0..100)
            .map(|k| 1_000_000 * k + 300_000 * (2 * (k % 2) - 1))
            .collect();
        for (stamps, found) in [
            (&wild[..], "49 closer than half"),
            (&[5], "1 samples"),
            (&[0, 1_000_000, 1_000_001, 2_000_000], "1 closer than half"),
        ] {
            let (flaw, _) = Clock::fit(stamps).map(drop).expect_err(found);
            assert!(flaw.contains(found), "{flaw}");
        }
    }
}
