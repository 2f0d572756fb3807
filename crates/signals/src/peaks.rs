//! Peaks: the largest values that a run reached, each beside the limit that bounds it.

use std::collections::BTreeMap;

use ndarray::{Array2, ArrayView1, ArrayView2};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::limit::Limit;
use crate::record::Record;

/// What a run reached at most, in the unit of the limit that bounds it, one value for each axis;
/// what was not measured is not there.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Peaks(BTreeMap<Limit, Vec<f64>>);

impl Peaks {
    /// The peaks of a record that starts `start_rad` from the pose, which lies at `pose_rad`: of
    /// what the sensors say, so that accelerations and jerks are not known.
    #[must_use]
    pub fn of_record(record: &Record, start_rad: &[f64], pose_rad: &[f64]) -> Self {
        let ways = Ways::of(record, start_rad);
        let reached = |limit: Limit| match limit {
            Limit::Torque => Some(by_axis(record.u.view(), largest)),
            Limit::TorqueRate => Some(steepest_by_axis(&record.u, record.sample_time_s)),
            Limit::Velocity => Some(by_axis(record.y.view(), largest)),
            Limit::Acceleration | Limit::Jerk => None,
            Limit::Travel => ways.as_ref().map(Ways::farther),
            Limit::LowestPosition => ways.as_ref().map(|ways| about(pose_rad, &ways.low)),
            Limit::HighestPosition => ways.as_ref().map(|ways| about(pose_rad, &ways.high)),
        };
        let known = |&limit: &Limit| Some((limit, reached(limit)?));
        Limit::ALL.iter().filter_map(known).collect()
    }

    /// The values that a limit bounds; `None` where they are not known.
    #[must_use]
    pub fn get(&self, limit: Limit) -> Option<&[f64]> {
        self.0.get(&limit).map(Vec::as_slice)
    }

    /// Takes what others know, in the place of what was known before.
    pub fn extend(&mut self, others: Self) {
        self.0.extend(others.0);
    }

    /// The farther of two, axis by axis; what is not known of both is not known.
    #[must_use]
    pub fn farther(&self, other: &Self) -> Self {
        let both = |(&limit, ours): (&Limit, &Vec<f64>)| {
            let pairs = ours.iter().zip(other.get(limit)?);
            Some((limit, pairs.map(|(a, b)| limit.farther(*a, *b)).collect()))
        };
        self.0.iter().filter_map(both).collect()
    }
}

impl FromIterator<(Limit, Vec<f64>)> for Peaks {
    fn from_iter<I: IntoIterator<Item = (Limit, Vec<f64>)>>(peaks: I) -> Self {
        Self(peaks.into_iter().collect())
    }
}

/// By the key of each quantity; what is not known is there as nothing.
impl Serialize for Peaks {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(Limit::ALL.len()))?;
        for &limit in Limit::ALL {
            map.serialize_entry(limit.quantity_key(), &self.get(limit))?;
        }
        map.end()
    }
}

/// How far the axes go from the pose, down and up, in rad.
struct Ways {
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Ways {
    /// By how much the position reading changes from where the run starts; `None` without one.
    fn of(record: &Record, start_rad: &[f64]) -> Option<Self> {
        let position = record.position_rad.as_ref()?;
        let extreme = |extreme: fn(f64, f64) -> f64| -> Vec<f64> {
            let axes = position.rows().into_iter().zip(start_rad);
            axes.map(|(row, start)| start + row.iter().fold(0.0, |way, x| extreme(way, x - row[0])))
                .collect()
        };
        Some(Self {
            low: extreme(f64::min),
            high: extreme(f64::max),
        })
    }

    /// The larger way of one down and one up, axis by axis.
    fn farther(&self) -> Vec<f64> {
        self.low
            .iter()
            .zip(&self.high)
            .map(|(low, high)| high.max(-low))
            .collect()
    }
}

/// Positions in rad at ways from a pose.
fn about(pose_rad: &[f64], ways: &[f64]) -> Vec<f64> {
    let axes = ways.iter().zip(pose_rad);
    axes.map(|(way, pose)| pose + way).collect()
}

/// Largest magnitude of every row of a signal `(axis, sample)`.
#[must_use]
pub fn largest_by_axis(signal: &Array2<f64>) -> Vec<f64> {
    by_axis(signal.view(), largest)
}

/// Largest rate of every row of a signal `(axis, sample)`, from sample to sample.
pub(crate) fn steepest_by_axis(signal: &Array2<f64>, sample_time_s: f64) -> Vec<f64> {
    by_axis(signal.view(), |row| steepest(row) / sample_time_s)
}

fn by_axis(signal: ArrayView2<f64>, value: impl Fn(ArrayView1<f64>) -> f64) -> Vec<f64> {
    signal.rows().into_iter().map(value).collect()
}

/// Largest size of a signal.
fn largest(row: ArrayView1<f64>) -> f64 {
    row.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()))
}

/// Largest change of a signal from sample to sample.
pub(crate) fn steepest(row: ArrayView1<f64>) -> f64 {
    let steps = row.iter().zip(row.iter().skip(1));
    steps
        .map(|(before, after)| (after - before).abs())
        .fold(0.0, f64::max)
}
