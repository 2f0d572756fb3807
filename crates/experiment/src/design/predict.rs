//! What the runs will ask of the robot, found by doing them on its model, against the limits.

use std::sync::Mutex;

use frfid_plant::Trajectory;
use frfid_signals::{Plan, Record, Run, RunId, RunKind, Testbed, TestbedError, power};
use ndarray::{Array2, ArrayView1, ArrayView2, s};
use serde::Serialize;

use crate::description::limits::LimitsTable;
use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::parallel::{Progress, run_all};
use crate::run::simulated::Simulator;

/// Largest values of a run or a campaign, one for each axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Peaks {
    /// Motor torque in N m.
    pub effort_nm: Vec<f64>,
    /// Rate of the motor torque from sample to sample in N m/s.
    pub effort_rate_nm_per_s: Vec<f64>,
    /// Motor velocity in rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// Motor acceleration in rad/s^2 from sample to sample of the true velocity; `None` for
    /// recordings, whose noise would be all that is left.
    pub acceleration_rad_s2: Option<Vec<f64>>,
    /// Motor jerk in rad/s^3, likewise.
    pub jerk_rad_s3: Option<Vec<f64>>,
    /// Way of the motor from the pose in rad; `None` where no position is measured.
    pub travel_rad: Option<Vec<f64>>,
    /// Lowest position in rad; `None` where no position is measured.
    pub lowest_rad: Option<Vec<f64>>,
    /// Highest position in rad; `None` where no position is measured.
    pub highest_rad: Option<Vec<f64>>,
    /// Root mean square of the motor torque about its mean in N m: against the Coulomb friction it
    /// tells whether the excitation is strong enough (SK15 footnote 2). What holds a constant
    /// velocity or a weight does not count.
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
    /// What is asked without the excitation: by the constant velocity, friction and gravity alone.
    pub baseline: Peaks,
    /// Crest factor of the motor torque about its mean, peak over rms of the same run, largest over
    /// all runs, one for each axis.
    pub crest_factor: Vec<f64>,
    /// Every limit that is exceeded; empty for a design inside the limits.
    pub excesses: Vec<Excess>,
}

impl Peaks {
    /// Largest values of one record that began `start_rad` from the pose `pose_rad`, one value for
    /// each axis. Where the robot counts its positions from does not matter.
    #[must_use]
    pub fn of(record: &Record, start_rad: &[f64], pose_rad: &[f64]) -> Self {
        let rows = |signal: ArrayView2<f64>, value: &dyn Fn(ArrayView1<f64>) -> f64| {
            signal.rows().into_iter().map(value).collect()
        };
        let way = |extreme: &dyn Fn(f64, f64) -> f64| {
            let position = record.position_rad.as_ref()?;
            let axes = position.rows().into_iter().zip(start_rad);
            Some(
                axes.map(|(row, start)| {
                    start + row.iter().fold(0.0, |way, x| extreme(way, x - row[0]))
                })
                .collect(),
            )
        };
        let (low, high): (Option<Vec<f64>>, Option<Vec<f64>>) = (way(&f64::min), way(&f64::max));
        let about_pose = |way: &Option<Vec<f64>>| {
            Some(
                way.as_ref()?
                    .iter()
                    .zip(pose_rad)
                    .map(|(way, pose)| pose + way)
                    .collect(),
            )
        };
        Self {
            effort_nm: rows(record.u.view(), &largest),
            effort_rate_nm_per_s: rows(record.u.view(), &|row| {
                steepest(row) / record.sample_time_s
            }),
            velocity_rad_s: rows(record.y.view(), &largest),
            acceleration_rad_s2: None,
            jerk_rad_s3: None,
            travel_rad: low
                .iter()
                .zip(&high)
                .map(|(low, high)| farther(low, high))
                .next(),
            lowest_rad: about_pose(&low),
            highest_rad: about_pose(&high),
            effort_rms_nm: rows(record.u.view(), &|row| power::rms(&about_mean(row))),
        }
    }

    /// The same with the acceleration and jerk of the true motion.
    #[must_use]
    pub fn with_motion(self, truth: &Trajectory) -> Self {
        let rows = |signal: &Array2<f64>| signal.rows().into_iter().map(largest).collect();
        let slope = |signal: &Array2<f64>| {
            let samples = signal.ncols().max(1);
            (&signal.slice(s![.., 1..samples]) - &signal.slice(s![.., ..samples - 1]))
                / truth.sample_time_s
        };
        let acceleration = slope(&truth.motor_velocity_rad_s);
        Self {
            acceleration_rad_s2: Some(rows(&acceleration)),
            jerk_rad_s3: Some(rows(&slope(&acceleration))),
            ..self
        }
    }

    /// Enlarges the largest values so far to these.
    pub fn enlarge(largest: &mut Option<Self>, peaks: &Self) {
        *largest = Some(
            largest
                .as_ref()
                .map_or_else(|| peaks.clone(), |before| before.max(peaks)),
        );
    }

    /// The larger of two, axis by axis.
    #[must_use]
    pub fn max(&self, other: &Self) -> Self {
        let both = |a: &Option<Vec<f64>>, b: &Option<Vec<f64>>| {
            a.as_ref().zip(b.as_ref()).map(|(a, b)| larger(a, b))
        };
        let smaller =
            |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(x, y)| x.min(*y)).collect();
        Self {
            effort_nm: larger(&self.effort_nm, &other.effort_nm),
            effort_rate_nm_per_s: larger(&self.effort_rate_nm_per_s, &other.effort_rate_nm_per_s),
            velocity_rad_s: larger(&self.velocity_rad_s, &other.velocity_rad_s),
            acceleration_rad_s2: both(&self.acceleration_rad_s2, &other.acceleration_rad_s2),
            jerk_rad_s3: both(&self.jerk_rad_s3, &other.jerk_rad_s3),
            travel_rad: both(&self.travel_rad, &other.travel_rad),
            lowest_rad: self
                .lowest_rad
                .as_ref()
                .zip(other.lowest_rad.as_ref())
                .map(smaller),
            highest_rad: both(&self.highest_rad, &other.highest_rad),
            effort_rms_nm: larger(&self.effort_rms_nm, &other.effort_rms_nm),
        }
    }

    /// Every limit that the peaks exceed; one that is only touched is kept.
    #[must_use]
    pub fn excesses(&self, limits: &LimitsTable) -> Vec<Excess> {
        const ROUNDING: f64 = 1e-9;
        let all = limits.named().flat_map(|(limit, allowed)| {
            let found = self
                .bounded_by(limit)
                .into_iter()
                .flatten()
                .zip(allowed)
                .enumerate();
            found.map(move |(axis, (&found, &allowed))| Excess {
                axis,
                limit,
                allowed,
                found,
            })
        });
        all.filter(|excess| {
            let margin = ROUNDING * excess.allowed.abs();
            if excess.limit == "min_position" {
                excess.found < excess.allowed - margin
            } else {
                excess.found > excess.allowed + margin
            }
        })
        .collect()
    }

    /// The value that the limit of this name bounds; `None` where it is not known.
    #[must_use]
    pub fn bounded_by(&self, limit: &str) -> Option<&Vec<f64>> {
        match limit {
            "max_effort" => Some(&self.effort_nm),
            "max_effort_rate" => Some(&self.effort_rate_nm_per_s),
            "max_velocity" => Some(&self.velocity_rad_s),
            "max_acceleration" => self.acceleration_rad_s2.as_ref(),
            "max_jerk" => self.jerk_rad_s3.as_ref(),
            "min_position" => self.lowest_rad.as_ref(),
            "max_position" => self.highest_rad.as_ref(),
            _ => self.travel_rad.as_ref(),
        }
    }
}

/// Largest size of a signal.
fn largest(row: ArrayView1<f64>) -> f64 {
    row.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()))
}

/// Largest change of a signal from sample to sample.
fn steepest(row: ArrayView1<f64>) -> f64 {
    row.iter()
        .zip(row.iter().skip(1))
        .map(|(before, after)| (after - before).abs())
        .fold(0.0, f64::max)
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

/// The larger way of one down and one up, axis by axis.
fn farther(low: &[f64], high: &[f64]) -> Vec<f64> {
    low.iter()
        .zip(high)
        .map(|(low, high)| high.max(-low))
        .collect()
}

fn larger(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| x.max(*y)).collect()
}

/// Does every run of the design once on the robot's model, beyond its limits too, and compares the
/// peaks with the limits.
///
/// # Errors
/// [`ExperimentError`]: no model, a run that diverges, or an interruption.
pub fn predict(
    experiment: &Experiment,
    jobs: usize,
    progress: Progress,
) -> Result<Prediction, ExperimentError> {
    let simulator = Watching {
        simulator: experiment.simulator(None)?,
        experiment,
        found: Mutex::new(None),
    };
    let baseline = simulator.baseline()?;
    let ids: Vec<RunId> = experiment
        .plan
        .run_ids()
        .filter(|id| id.repetition == 0)
        .collect();
    run_all(
        &ids,
        &|id| Ok(experiment.plan.run(id)?),
        &simulator,
        jobs,
        progress,
        &|_, _| Ok(()),
    )?;
    let found = simulator
        .found
        .into_inner()
        .expect("no holder of the lock panics");
    let (peaks, crest_factor) = found.ok_or(ExperimentError::Interrupted {
        done: 0,
        total: ids.len(),
    })?;
    let excesses = peaks.excesses(&experiment.limits());
    Ok(Prediction {
        peaks,
        baseline,
        crest_factor,
        excesses,
    })
}

/// The simulator, looking at the true motion of every run: peaks and crest factors of the torque.
struct Watching<'a> {
    simulator: Simulator,
    experiment: &'a Experiment,
    found: Mutex<Option<(Peaks, Vec<f64>)>>,
}

impl Watching<'_> {
    fn peaks(&self, run: &Run) -> Result<(Record, Peaks), TestbedError> {
        let (record, truth) = self.simulator.simulate(run)?;
        let peaks = Peaks::of(
            &record,
            &run.start_rad,
            &self.experiment.config.robot.pose(),
        )
        .with_motion(&truth);
        Ok((record, peaks))
    }

    /// The peaks without the excitation.
    fn baseline(&self) -> Result<Peaks, ExperimentError> {
        let plan = Plan {
            n_glides: 1,
            ..self.experiment.plan.clone()
        };
        let glide = RunId {
            kind: RunKind::Glide,
            realization: 0,
            experiment: 0,
            repetition: 0,
        };
        Ok(self.peaks(&plan.run(glide)?)?.1)
    }
}

impl Testbed for Watching<'_> {
    fn n_inputs(&self) -> usize {
        self.simulator.n_inputs()
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        let (record, peaks) = self.peaks(run)?;
        let crest = crest_factors(&record);
        let mut found = self.found.lock().expect("no holder of the lock panics");
        *found = Some(match found.take() {
            Some((before, crest_before)) => (before.max(&peaks), larger(&crest_before, &crest)),
            None => (peaks, crest),
        });
        Ok(record)
    }
}

impl Prediction {
    /// Factor by which all amplitudes must shrink to keep every limit, from the limit that binds
    /// most: the excitation's part of a peak taken as proportional to the amplitude, which is exact
    /// for torques in open loop and a first guess for other quantities. 0 or less where the limit
    /// is exceeded without any excitation; `None` inside the limits.
    #[must_use]
    pub fn feasible_factor(&self) -> Option<f64> {
        self.excesses
            .iter()
            .map(|excess| self.factor(excess))
            .reduce(f64::min)
    }

    /// The limit that binds most.
    #[must_use]
    pub fn binding(&self) -> Option<&Excess> {
        self.excesses
            .iter()
            .min_by(|a, b| self.factor(a).total_cmp(&self.factor(b)))
    }

    /// What is asked of a limited quantity without the excitation.
    #[must_use]
    pub fn without_excitation(&self, excess: &Excess) -> f64 {
        self.baseline
            .bounded_by(excess.limit)
            .map_or(0.0, |baseline| baseline[excess.axis])
    }

    fn factor(&self, excess: &Excess) -> f64 {
        let baseline = self.without_excitation(excess);
        // without a part of its own the excitation cannot mend it
        if excess.found == baseline {
            0.0
        } else {
            (excess.allowed - baseline) / (excess.found - baseline)
        }
    }
}
