//! Plan clock: the clock of a player, as a recording brings it back.

use ndarray::{Array2, Axis, s};

use crate::error::FileError;
use crate::log::map::{LogMap, Signal};
use crate::log::units::signal_to_si;

/// Unit of a count.
const COUNT: &str = "1";

/// The clock of the player, sample by sample of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanClock {
    /// The player's count of samples, or its time in s; NaN where it was not recorded.
    pub values: Vec<f64>,
    /// Whether samples are counted.
    pub counts_samples: bool,
}

impl PlanClock {
    /// The parts of the clock added up, from the values of all signals in SI; `None` where the map names none.
    pub(super) fn of(map: &LogMap, values: &Array2<f64>) -> Option<Self> {
        let first = map.plan_clock.first()?;
        let [.., places, _] = map.places();
        let sum = values.slice(s![places, ..]).sum_axis(Axis(0));
        Some(Self {
            values: sum.to_vec(),
            counts_samples: first.unit == COUNT,
        })
    }

    /// Refuses parts that are neither a count nor times.
    pub(super) fn check(parts: &[Signal]) -> Result<(), FileError> {
        let is_time = |part: &Signal| matches!(signal_to_si(part), Ok((_, "s")));
        let is_count = matches!(parts, [part] if part.unit == COUNT);
        match is_count || parts.iter().all(is_time) {
            true => Ok(()),
            false => Err(no_clock(parts)),
        }
    }
}

fn no_clock(parts: &[Signal]) -> FileError {
    let units: Vec<_> = parts.iter().map(|part| part.unit.as_str()).collect();
    FileError::shape(
        "plan_clock in the log map",
        format!("in {}", units.join(" and ")),
        "one count of samples, unit 1, or times in s, ms, us or ns, which are added up",
    )
}
