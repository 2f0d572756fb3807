//! Look at every signal of a group: its clock, its range, and what is odd about it.

use std::path::Path;

use frfid_estimate::{Oddity, look};
use frfid_files::{ClockFit, Log, LogMap, Signal, SignalGroup, read_log};
use ndarray::ArrayView1;
use serde::Serialize;

use crate::inspect::times::times;

/// How a group is sampled and what its signals look like.
#[derive(Debug, Clone, Default, Serialize)]
pub struct GroupLook {
    /// Sample time in s; `None` where the file does not say.
    pub sample_time_s: Option<f64>,
    /// Deviation of the stamps from the even clock, rms in parts of the sample time.
    pub jitter: Option<f64>,
    /// Number of samples on the even grid; 0 of a group that was not read.
    pub n_samples: usize,
    /// Samples of the grid that are not there.
    pub n_lost: usize,
    /// Longest gap in s between two samples; `None` without sample times.
    pub longest_gap_s: Option<f64>,
    /// What a careful reader should know: jitter, duplicates, damage.
    pub told: Vec<String>,
    /// Its signals, in the order of the listing.
    pub signals: Vec<SignalLook>,
    /// Why it could not be read.
    pub failed: Option<String>,
}

/// What a signal looks like.
#[derive(Debug, Clone, Serialize)]
pub struct SignalLook {
    /// Its name in a log map.
    pub source: String,
    /// Its lowest value, in the unit of the file; `None` without a number.
    pub lowest: Option<f64>,
    /// Its highest value.
    pub highest: Option<f64>,
    /// Whether it never changes.
    pub is_constant: bool,
    /// What is odd about it, in words.
    pub odd: Vec<String>,
}

/// Signals that are looked at alone at most: each of them takes the whole file.
const MOST_ALONE: usize = 32;

/// Looks at a group of a recording; without samples there is nothing to look at.
pub(super) fn looked(path: &Path, group: &SignalGroup) -> GroupLook {
    let time = times(group).map(|(time, _)| time);
    let is_time = |source: &str| time.as_ref().is_some_and(|time| time.source == source);
    let numbers =
        (group.signals.iter()).filter(|signal| !signal.is_moment && !is_time(&signal.source));
    let all: Vec<Signal> = numbers
        .map(|signal| Signal::of(&signal.source, "1"))
        .collect();
    let Some(first) = all.first() else {
        return GroupLook::default();
    };
    let has_times = time.is_some() || group.type_name.is_some();
    let map = LogMap {
        // without times the grid is counted, in no unit
        sample_time_s: (!has_times).then_some(1.0),
        time,
        ..LogMap::new(vec![first.clone()], all.clone())
    };
    match read_log(path, &map) {
        Ok(log) => GroupLook::of(&all, &log, has_times),
        Err(error) => GroupLook {
            failed: Some(error.to_string()),
            signals: one_by_one(path, group.type_name.is_some(), &all),
            ..GroupLook::default()
        },
    }
}

/// The signals of a group that cannot be put on one clock, each by itself; those of tables and arrays by their
/// places.
fn one_by_one(path: &Path, has_stamps: bool, all: &[Signal]) -> Vec<SignalLook> {
    let look = |signal: &Signal| {
        let map = LogMap {
            sample_time_s: (!has_stamps).then_some(1.0),
            ..LogMap::new(vec![signal.clone()], vec![signal.clone()])
        };
        let log = read_log(path, &map).ok()?;
        Some(SignalLook::of(&signal.source, log.record.y.row(0)))
    };
    all.iter().take(MOST_ALONE).filter_map(look).collect()
}

impl GroupLook {
    fn of(all: &[Signal], log: &Log, has_times: bool) -> Self {
        let ClockFit {
            sample_time_s,
            jitter,
            n_lost,
            ..
        } = log.clock;
        let rows = log.record.y.rows();
        let signals = all.iter().zip(rows);
        let losses = log.losses.iter().map(ToString::to_string);
        Self {
            sample_time_s: has_times.then_some(sample_time_s),
            jitter: has_times.then_some(jitter),
            n_samples: log.record.n_samples(),
            n_lost,
            longest_gap_s: has_times.then(|| longest_gap(log) as f64 * sample_time_s),
            told: log.warnings.iter().cloned().chain(losses).collect(),
            signals: signals
                .map(|(signal, samples)| SignalLook::of(&signal.source, samples))
                .collect(),
            failed: None,
        }
    }
}

/// Most samples in a row that no signal has, plus one.
fn longest_gap(log: &Log) -> usize {
    let (mut longest, mut running) = (0, 0);
    for sample in log.record.y.columns() {
        running = if is_there(sample) { 0 } else { running + 1 };
        longest = longest.max(running);
    }
    longest + 1
}

/// Whether a sample has a number of any signal.
fn is_there(sample: ArrayView1<f64>) -> bool {
    sample.iter().any(|value| value.is_finite())
}

impl SignalLook {
    fn of(source: &str, samples: ArrayView1<f64>) -> Self {
        let finite = || samples.iter().copied().filter(|value| value.is_finite());
        let (lowest, highest) = (finite().reduce(f64::min), finite().reduce(f64::max));
        let odd = look(samples);
        Self {
            source: source.to_owned(),
            lowest,
            highest,
            is_constant: lowest == highest,
            odd: odd.iter().map(Oddity::found).collect(),
        }
    }
}
