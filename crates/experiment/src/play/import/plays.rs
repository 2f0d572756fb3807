//! Plays: stretches of a recording over which the clock of the player, logged with it, runs on.

use frfid_files::PlanClock;
use frfid_signals::median;
use std::ops::Range;

/// A play is no shorter, in samples.
const FEWEST: usize = 100;
/// Samples farther from the line than this times what is typical are stamped late, and not used for it.
const LATE: f64 = 4.0;

/// A stretch over which the player's clock runs on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Play {
    /// Its samples.
    pub(super) samples: Range<usize>,
    /// What the recorder's clock shows, or would have shown, where that of the player is at 0, in s.
    pub(super) origin_s: f64,
    /// Seconds of the recorder in a second of the player, to a small part of a sample of the recorder over the
    /// length of the play: a count is seen to go on at the recorder's own instants.
    pub(super) ratio: f64,
}

/// A sample at which the player's clock went on.
#[derive(Debug, Clone, Copy)]
struct Tick {
    sample: usize,
    /// By the player's clock in s.
    player_s: f64,
    /// By the recorder's.
    recorder_s: f64,
}

impl Tick {
    fn was_recorded(&self) -> bool {
        self.player_s.is_finite()
    }

    fn is_before(&self, next: &Self) -> bool {
        self.player_s < next.player_s
    }

    /// How far it is off a line, in s.
    fn off_s(&self, (origin_s, ratio): (f64, f64)) -> f64 {
        (self.recorder_s - origin_s - ratio * self.player_s).abs()
    }
}

impl Play {
    /// A time of the recorder by the clock of the player, in s.
    pub(super) fn player_s(&self, recorder_s: f64) -> f64 {
        (recorder_s - self.origin_s) / self.ratio
    }

    /// The play of ticks; `None` of too few.
    fn of(ticks: &[Tick]) -> Option<Self> {
        let (first, last) = (ticks.first()?, ticks.last()?);
        if ticks.len() < FEWEST {
            return None;
        }
        let (origin_s, ratio) = line(&in_time(ticks));
        Some(Self {
            samples: first.sample..last.sample + 1,
            origin_s,
            ratio,
        })
    }
}

/// The plays of a recording with samples at `times_s`; a player counts samples of `step_s`.
pub(super) fn plays(clock: &PlanClock, times_s: &[f64], step_s: f64) -> Vec<Play> {
    let ticks = ticks(clock, times_s, step_s);
    ticks
        .chunk_by(Tick::is_before)
        .filter_map(Play::of)
        .collect()
}

/// Where the player's clock shows another time than before: while it stands nothing is played.
fn ticks(clock: &PlanClock, times_s: &[f64], step_s: f64) -> Vec<Tick> {
    let unit_s = if clock.counts_samples { step_s } else { 1.0 };
    let tick = |sample: usize| Tick {
        sample,
        player_s: clock.values[sample] * unit_s,
        recorder_s: times_s[sample],
    };
    let all = (0..times_s.len()).map(tick);
    let mut ticks: Vec<Tick> = all.filter(Tick::was_recorded).collect();
    ticks.dedup_by_key(|tick| tick.player_s);
    ticks
}

/// The ticks that are not stamped late.
fn in_time(ticks: &[Tick]) -> Vec<Tick> {
    let line = line(ticks);
    let offs_s = ticks.iter().map(|tick| tick.off_s(line));
    let most_s = median(offs_s.collect()).map_or(0.0, |typical_s| LATE * typical_s);
    let mut in_time = ticks.to_vec();
    in_time.retain(|tick| tick.off_s(line) <= most_s);
    in_time
}

/// The line of least squares: the recorder's time where the player's is 0, and how it grows with it.
fn line(ticks: &[Tick]) -> (f64, f64) {
    let n = ticks.len() as f64;
    let mean = |of: fn(&Tick) -> f64| ticks.iter().map(of).sum::<f64>() / n;
    let (player_s, recorder_s) = (mean(|tick| tick.player_s), mean(|tick| tick.recorder_s));
    let (mut square, mut product) = (0.0, 0.0);
    for tick in ticks {
        let about_s = tick.player_s - player_s;
        square += about_s * about_s;
        product += about_s * (tick.recorder_s - recorder_s);
    }
    let ratio = product / square;
    (recorder_s - ratio * player_s, ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(values: impl IntoIterator<Item = f64>) -> PlanClock {
        PlanClock {
            values: values.into_iter().collect(),
            counts_samples: true,
        }
    }

    #[test]
    fn each_file_is_a_play_on_its_own_line_whatever_was_late() {
        // 500 Hz player, 100 ppm fast, recorded at 800 Hz: rests at 0, two files of 4 s, the last value stands
        let times_s: Vec<f64> = (0..12_000).map(|sample| sample as f64 / 800.0).collect();
        let counter = |time_s: f64| {
            let k = |begin_s: f64| ((time_s - begin_s) * 500.0 * 1.0001).floor();
            match k(if time_s < 7.0 { 1.0 } else { 8.0 }) {
                k if k < 0.0 => {
                    if time_s < 7.0 {
                        0.0
                    } else {
                        1999.0
                    }
                }
                k => k.min(1999.0),
            }
        };
        let clock = counted(times_s.iter().map(|time_s| counter(*time_s)));
        let mut late_s = times_s.clone();
        (3..12_000)
            .step_by(97)
            .for_each(|sample| late_s[sample] += 1e-3);
        let found = plays(&clock, &late_s, 2e-3);
        assert_eq!(found.len(), 2, "{found:?}");
        for (play, begin_s) in found.iter().zip([1.0, 8.0]) {
            // 1.25 ms in 4 s would be 300 ppm
            assert!((play.ratio * 1.0001 - 1.0).abs() < 30e-6, "{play:?}");
            assert!(
                (play.origin_s - begin_s).abs() < 1.25e-3,
                "within a sample of the recorder"
            );
            assert!((play.player_s(begin_s + 2.0) - 2.0002).abs() < 1.5e-3);
        }
    }

    #[test]
    fn a_clock_that_stands_or_was_not_recorded_is_no_play() {
        let times_s: Vec<f64> = (0..1000).map(|sample| sample as f64 * 1e-3).collect();
        assert_eq!(plays(&counted(vec![0.0; 1000]), &times_s, 1e-3), []);
        assert_eq!(plays(&counted(vec![f64::NAN; 1000]), &times_s, 1e-3), []);
        assert_eq!(
            plays(&counted((0..50).map(f64::from)), &times_s[..50], 1e-3),
            []
        );
    }
}
