//! Section 6 of the paper: the academic example, every experiment of figures 4 and 5 and the claims
//! drawn from them.

pub(crate) mod claims;
pub(crate) mod figures;
pub(crate) mod variant;

use frfid_experiment::{ExperimentError, Progress};
use frfid_signals::{Frf, log_spaced, power};
use ndarray::Array3;

use crate::against_truth::Measured;
use crate::section6::variant::{FAST_RAD_S, FRICTION, LINEAR, SLOW_RAD_S, STIFFENING, Variant};

/// A multisine's and a chirp's FRF of the same joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// Best linear approximation from 30 realizations of an odd random multisine.
    pub multisine: Measured,
    /// Excerpts of a 20 s chirp.
    pub chirp: Measured,
}

/// Everything section 6 shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Section6 {
    /// The exact FRF of the linear joint with k1, on a grid dense enough to be drawn.
    pub truth: Frf,
    /// No friction, k2 = k1.
    pub linear: Pair,
    /// F_c = 50 N m, k2 = k1: figure 4.
    pub friction: Pair,
    /// F_c = 50 N m on a constant velocity of 0.25 rad/s.
    pub gliding: Pair,
    /// The chirp on the same constant velocity without friction: what the one with friction should
    /// equal.
    pub gliding_frictionless: Measured,
    /// F_c = 50 N m on a constant velocity of 0.011 rad/s, which is too slow.
    pub slow: Pair,
    /// The chirp at 0.011 rad/s without friction.
    pub slow_frictionless: Measured,
    /// No friction, k2 = 1.7 k1: figure 5.
    pub stiffening: Pair,
    /// Power of multisines over that of the chirp at equal peak, for 1000 realizations, rising.
    pub power_share: Vec<f64>,
}

impl Section6 {
    /// Runs every experiment in simulation.
    ///
    /// # Errors
    /// [`ExperimentError::Interrupted`]; any other would be a fault of this library.
    pub fn run(jobs: usize, progress: Progress) -> Result<Self, ExperimentError> {
        let mut series = Series {
            jobs,
            progress,
            n_done: 0,
        };
        Ok(Self {
            truth: LINEAR.truth(&log_spaced(1.0, 60.0, 600)?)?,
            linear: series.pair(LINEAR)?,
            friction: series.pair(FRICTION)?,
            gliding: series.pair(FRICTION.gliding_at(FAST_RAD_S))?,
            slow: series.pair(FRICTION.gliding_at(SLOW_RAD_S))?,
            stiffening: series.pair(STIFFENING)?,
            gliding_frictionless: series.measure("chirp", LINEAR.gliding_at(FAST_RAD_S))?,
            slow_frictionless: series.measure("chirp", LINEAR.gliding_at(SLOW_RAD_S))?,
            power_share: power_share()?,
        })
    }
}

/// Number of experiments of section 6.
const N_EXPERIMENTS: usize = 12;
/// Steps as which every experiment is reported, whatever the number of its runs.
const STEPS_EACH: usize = 1000;

/// Experiments done one after the other, their progress reported as that of one.
struct Series<'a> {
    jobs: usize,
    progress: Progress<'a>,
    n_done: usize,
}

impl Series<'_> {
    /// A variant of the joint measured by multisine and chirp.
    fn pair(&mut self, variant: Variant) -> Result<Pair, ExperimentError> {
        Ok(Pair {
            multisine: self.measure("multisine", variant)?,
            chirp: self.measure("chirp", variant)?,
        })
    }

    /// One experiment of the template `kind`.
    fn measure(&mut self, kind: &str, variant: Variant) -> Result<Measured, ExperimentError> {
        let step = |done: usize, total: usize| {
            (self.progress)(
                STEPS_EACH * self.n_done + STEPS_EACH * done / total.max(1),
                STEPS_EACH * N_EXPERIMENTS,
            )
        };
        let measured = variant.measure(kind, self.jobs, &step);
        self.n_done += 1;
        measured
    }
}

/// Mean power of multisines over that of the chirp of equal peak, for 1000 realizations, sorted
/// (SK15 section 6.1).
fn power_share() -> Result<Vec<f64>, ExperimentError> {
    let chirp_power = mean_power(&LINEAR.experiment("chirp")?.plan().period(0)?);
    let multisine = LINEAR.experiment("multisine")?;
    let share = |realization| {
        let drawn = multisine.plan().period(realization)?;
        Ok(mean_power(&drawn) / chirp_power)
    };
    let mut shares = (0..1000)
        .map(share)
        .collect::<Result<Vec<f64>, ExperimentError>>()?;
    shares.sort_by(f64::total_cmp);
    Ok(shares)
}

/// Mean power of one period of a signal.
fn mean_power(period: &Array3<f64>) -> f64 {
    power::mean_power(period.as_slice().unwrap_or_default())
}
