//! Words for oddities: what was found, what it does to an FRF, what to do.

use frfid_signals::format::{count, significant};

use crate::look::oddity::{Level, Oddity};

impl Oddity {
    /// What was found, as the end of a sentence that begins with the name of the signal.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            Self::Constant { value } => format!("does not change: it is {value} throughout"),
            Self::FewValues {
                n_values,
                step,
                step_over_rms,
            } => format!(
                "takes {n_values} values only, in steps of {}, {} times its rms about the mean",
                significant(*step, 3),
                significant(*step_over_rms, 2)
            ),
            Self::Held { samples, .. } => format!(
                "changes every {} samples only: it comes at a lower rate and is held",
                significant(*samples, 3)
            ),
            Self::Wrapped { turn, jumps } => format!(
                "wraps: it jumps by a turn of {}, {}",
                significant(*turn, 5),
                count(*jumps, "time")
            ),
            Self::Saturated { low, high } => stands(*low, *high),
            Self::Outliers {
                count: n,
                first_sample,
                size_over_spread,
                ..
            } => format!(
                "has {}, the first at sample {first_sample} (from 0), up to {} times the spread of the signal",
                count(*n, "outlier"),
                significant(*size_over_spread, 2)
            ),
            Self::Lost { share } => format!("has lost {} % of its samples", percent(*share)),
        }
    }

    /// What it does to an FRF.
    #[must_use]
    pub fn meaning(&self) -> String {
        let words = match self {
            Self::Constant { .. } => "there is no motion in it from which an FRF could be had",
            Self::FewValues { .. } => {
                "what lies between the steps is lost; the error is the same in every period, so that no spread over periods shows it"
            }
            Self::Held { .. } => {
                "what is held lags by half of that time and is smaller at high frequencies: so does the FRF, unless the machine was \
                 given just these steps"
            }
            Self::Wrapped { .. } => {
                "the jumps are no motion; unwrapped, nothing is lost, and a ramp remains where the axis turns on"
            }
            Self::Saturated { .. } => {
                "what lies beyond the level is cut off; the distortion falls on the excited lines, too, and is the same in every period"
            }
            Self::Outliers { .. } => "each adds the same error to all frequencies of its period",
            Self::Lost { .. } => "periods with lost samples cannot be used as they are",
        };
        words.into()
    }

    /// What to do.
    #[must_use]
    pub fn advice(&self) -> String {
        let words = match self {
            Self::Constant { .. } => {
                "check that it is the right signal, that its sensor delivers, and that the axis was free to move"
            }
            Self::FewValues { .. } => {
                "excite more strongly, use a finer sensor, or take the position instead of a velocity that is differenced from it; \
                 a command of few levels is what it is"
            }
            Self::Held { .. } => {
                "record at the rate at which the values come, or keep the new samples only if all signals are held alike"
            }
            Self::Wrapped { .. } => "none, it is unwrapped",
            Self::Saturated { .. } => {
                "excite less, or widen the limit; at a level of 0 see whether the axis sticks; a measured torque that is clipped is a \
                 sound input if it is what acted"
            }
            Self::Outliers { .. } => {
                "leave out the periods that hold them, and look for lost or garbled messages"
            }
            Self::Lost { .. } => "record again, or use the whole periods between the gaps",
        };
        words.into()
    }
}

/// The levels at which a signal stands.
fn stands(low: Option<Level>, high: Option<Level>) -> String {
    let low = low.map(|level| format!("lowest {}", words(level)));
    let high = high.map(|level| format!("highest {}", words(level)));
    let levels: Vec<String> = low.into_iter().chain(high).collect();
    let levels = levels.join(" and at its ");
    format!("is saturated: it stands at its {levels}")
}

/// A level, and how long a signal stands at it.
fn words(level: Level) -> String {
    let (value, share) = (significant(level.value, 4), percent(level.share));
    format!("level {value} for {share} % of the time")
}

fn percent(share: f64) -> String {
    significant(100.0 * share, 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_say_numbers() {
        let level = |value| {
            Some(Level {
                value,
                share: 0.1234,
            })
        };
        for (oddity, words) in [
            (
                Oddity::Constant { value: 0.5 },
                "does not change: it is 0.5 throughout",
            ),
            (
                Oddity::Wrapped {
                    turn: std::f64::consts::TAU,
                    jumps: 1,
                },
                "wraps: it jumps by a turn of 6.2832, 1 time",
            ),
            (Oddity::Lost { share: 0.05 }, "has lost 5 % of its samples"),
            (
                Oddity::Saturated {
                    low: level(-2.0),
                    high: level(3.0),
                },
                "is saturated: it stands at its lowest level -2 for 12 % of the time and at its highest level 3 for 12 % of the time",
            ),
            (
                Oddity::Held {
                    samples: 3.3333,
                    phase: None,
                },
                "changes every 3.33 samples only: it comes at a lower rate and is held",
            ),
        ] {
            assert_eq!(oddity.found(), words);
            assert!(!oddity.meaning().is_empty() && !oddity.advice().is_empty());
        }
    }
}
