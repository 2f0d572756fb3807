//! Notes on an iteration: limits exceeded or ahead, runs stopped, errors that rose.

use std::fmt;

use frfid_signals::{Excess, Limit};
use serde::{Serialize, Serializer};

/// Something about an iteration that its reader should know.
#[derive(Debug, Clone, PartialEq)]
pub enum Note {
    /// Every axis was stuck: the response is that of the controller alone.
    AllStuck,
    /// A limit was exceeded; the iteration cannot be the best, the next step is smaller.
    Exceeded(Excess),
    /// A run was stopped before its end.
    Stopped {
        /// Experiment, from 0.
        experiment: usize,
        /// Time in s that it lasted.
        time_s: f64,
        /// Why, as the record says.
        reason: String,
    },
    /// The error is larger than that of the best iteration.
    Rose {
        /// This error.
        found: f64,
        /// That of the best iteration.
        best: f64,
    },
    /// The next reference of an axis grows by the largest allowed factor, less than its step asked
    /// for.
    ChangeLimited {
        /// Axis, from 0.
        axis: usize,
        /// Share of the step that is taken.
        share: f64,
    },
    /// A predicted peak shortens the next step of all axes, around one moment or altogether.
    LimitAhead {
        /// Axis, from 0.
        axis: usize,
        /// Which limit would be exceeded.
        limit: Limit,
        /// Time in s at which it would.
        time_s: f64,
        /// Share of the step that is taken there.
        share: f64,
    },
}

/// In words.
impl Serialize for Note {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// In words, axes and experiments from 1.
impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AllStuck => write!(
                f,
                "every axis was stuck: the response is that of the controller alone"
            ),
            Self::Exceeded(excess) => write_excess(f, excess),
            Self::Stopped {
                experiment,
                time_s,
                reason,
            } => {
                let experiment = experiment + 1;
                write!(
                    f,
                    "experiment {experiment} was stopped after {time_s:.3} s: {reason}"
                )
            }
            Self::Rose { found, best } => {
                let [found, best] = [found, best].map(|error| 100.0 * error);
                write!(f, "the error rose to {found:.1} %, the best is {best:.1} %")
            }
            Self::ChangeLimited { axis, share } => {
                let (axis, percent) = (axis + 1, 100.0 * share);
                write!(
                    f,
                    "axis {axis}: the reference grows by the largest factor allowed, {percent:.0} % of the step"
                )
            }
            Self::LimitAhead {
                axis,
                limit,
                time_s,
                share,
            } => write_limit_ahead(f, axis + 1, *limit, *time_s, 100.0 * share),
        }
    }
}

fn write_excess(f: &mut fmt::Formatter<'_>, excess: &Excess) -> fmt::Result {
    write!(
        f,
        "axis {}: {} in {} reached {:.4}, the limit is {:.4}",
        excess.axis + 1,
        excess.limit.quantity(),
        excess.limit.unit(),
        excess.found,
        excess.allowed
    )
}

fn write_limit_ahead(
    f: &mut fmt::Formatter<'_>,
    axis: usize,
    limit: Limit,
    time_s: f64,
    percent: f64,
) -> fmt::Result {
    let (quantity, unit) = (limit.quantity(), limit.unit());
    write!(
        f,
        "axis {axis}: its predicted {quantity} in {unit} at {time_s:.2} s shortens the step to {percent:.0} %"
    )
}
