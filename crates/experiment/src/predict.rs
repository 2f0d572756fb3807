//! What the runs will ask of the robot, found by doing them on its model, against the limits.

use std::sync::Mutex;

use ndarray::{ArrayView1, ArrayView2};
use serde::Serialize;

use frfid_signals::{Record, RunId, power};

use crate::campaign::{Progress, run_all};
use crate::config::LimitsTable;
use crate::{Experiment, ExperimentError};

/// Largest values of a run or a campaign, one for each axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Peaks {
    /// Motor torque in N m.
    pub effort_nm: Vec<f64>,
    /// Rate of the motor torque from sample to sample in N m/s.
    pub effort_rate_nm_per_s: Vec<f64>,
    /// Motor velocity in rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// Way of the motor from the start in rad; `None` where no position is measured.
    pub travel_rad: Option<Vec<f64>>,
    /// Root mean square of the motor torque about its mean in N m: against the Coulomb friction it tells whether the
    /// excitation is strong enough (SK15 footnote 2). What holds a constant velocity or a weight does not count.
    pub effort_rms_nm: Vec<f64>,
}

/// A limit that a peak exceeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Excess {
    /// Axis, from 0.
    pub axis: usize,
    /// Name of the limit.
    pub limit: &'static str,
    /// Its value.
    pub allowed: f64,
    /// The peak.
    pub found: f64,
}

/// What a design will ask of the robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prediction {
    /// Largest values over all realizations and experiments.
    pub peaks: Peaks,
    /// Crest factor of the motor torque about its mean, peak over rms of the same run, largest over all runs, one for each axis.
    pub crest_factor: Vec<f64>,
    /// Every limit that is exceeded; empty for a design inside the limits.
    pub excesses: Vec<Excess>,
}

impl Peaks {
    /// Largest values of one record.
    #[must_use]
    pub fn of(record: &Record) -> Self {
        let rows = |signal: ArrayView2<f64>, value: &dyn Fn(ArrayView1<f64>) -> f64| {
            signal.rows().into_iter().map(value).collect()
        };
        let largest = |row: ArrayView1<f64>| row.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
        let steepest = |row: ArrayView1<f64>| {
            let steps = row.iter().zip(row.iter().skip(1)).map(|(before, after)| (after - before).abs());
            steps.fold(0.0, f64::max) / record.sample_time_s
        };
        let farthest = |row: ArrayView1<f64>| row.iter().fold(0.0, |way: f64, x| way.max((x - row[0]).abs()));
        Self {
            effort_nm: rows(record.u.view(), &largest),
            effort_rate_nm_per_s: rows(record.u.view(), &steepest),
            velocity_rad_s: rows(record.y.view(), &largest),
            travel_rad: record.position_rad.as_ref().map(|position| rows(position.view(), &farthest)),
            effort_rms_nm: rows(record.u.view(), &|row| power::rms(&about_mean(row))),
        }
    }

    /// The larger of two, axis by axis.
    #[must_use]
    pub fn max(&self, other: &Self) -> Self {
        Self {
            effort_nm: larger(&self.effort_nm, &other.effort_nm),
            effort_rate_nm_per_s: larger(&self.effort_rate_nm_per_s, &other.effort_rate_nm_per_s),
            velocity_rad_s: larger(&self.velocity_rad_s, &other.velocity_rad_s),
            travel_rad: self.travel_rad.as_ref().zip(other.travel_rad.as_ref()).map(|(a, b)| larger(a, b)),
            effort_rms_nm: larger(&self.effort_rms_nm, &other.effort_rms_nm),
        }
    }

    /// Every limit that the peaks exceed; one that is only touched is kept.
    #[must_use]
    pub fn excesses(&self, limits: &LimitsTable) -> Vec<Excess> {
        const ROUNDING: f64 = 1e-9;
        let all = limits.named().flat_map(|(limit, allowed)| {
            let found = self.bounded_by(limit).into_iter().flatten().zip(allowed).enumerate();
            found.map(move |(axis, (&found, &allowed))| Excess { axis, limit, allowed, found })
        });
        all.filter(|excess| excess.found > excess.allowed * (1.0 + ROUNDING)).collect()
    }

    /// The value that the limit of this name bounds.
    fn bounded_by(&self, limit: &str) -> Option<&Vec<f64>> {
        match limit {
            "max_effort" => Some(&self.effort_nm),
            "max_effort_rate" => Some(&self.effort_rate_nm_per_s),
            "max_velocity" => Some(&self.velocity_rad_s),
            _ => self.travel_rad.as_ref(),
        }
    }
}

/// A signal without its mean.
fn about_mean(row: ArrayView1<f64>) -> Vec<f64> {
    let mean = row.mean().unwrap_or(0.0);
    row.iter().map(|x| x - mean).collect()
}

/// Crest factor of the torque about its mean, one for each axis.
fn crest_factors(record: &Record) -> Vec<f64> {
    let of = |row: ArrayView1<f64>| {
        let torque = about_mean(row);
        power::crest_factor(power::sample_peak(&torque), power::rms(&torque))
    };
    record.u.rows().into_iter().map(of).collect()
}

fn larger(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| x.max(*y)).collect()
}

/// Does every run of the design once on the robot's model and compares the peaks with the limits.
///
/// # Errors
/// [`ExperimentError`]: no model, a run that diverges, or an interruption.
pub fn predict(experiment: &Experiment, jobs: usize, progress: Progress) -> Result<Prediction, ExperimentError> {
    let testbed = experiment.testbed()?;
    let ids: Vec<RunId> = experiment.plan.run_ids().filter(|id| id.repetition == 0).collect();
    let found: Mutex<Option<(Peaks, Vec<f64>)>> = Mutex::new(None);
    let reference = |id| Ok(experiment.plan.run(id)?);
    run_all(&ids, &reference, &*testbed, jobs, progress, &|_, record| {
        let peaks = Peaks::of(&record);
        let crest = crest_factors(&record);
        let mut found = found.lock().expect("no holder of the lock panics");
        *found = Some(match found.take() {
            Some((before, crest_before)) => (before.max(&peaks), larger(&crest_before, &crest)),
            None => (peaks, crest),
        });
        Ok(())
    })?;
    let found = found.into_inner().expect("no holder of the lock panics");
    let (peaks, crest_factor) = found.ok_or(ExperimentError::Interrupted { done: 0, total: ids.len() })?;
    let excesses = peaks.excesses(&experiment.config.limits);
    Ok(Prediction { peaks, crest_factor, excesses })
}

impl Prediction {
    /// Factor by which all amplitudes must shrink to keep every limit, from the limit that binds most: exact for torques in
    /// open loop, where the torque is the reference, a first guess for the other quantities. `None` inside the limits.
    #[must_use]
    pub fn feasible_factor(&self) -> Option<f64> {
        self.excesses.iter().map(|excess| excess.allowed / excess.found).reduce(f64::min)
    }
}
