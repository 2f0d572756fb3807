//! Plan of an experiment: which runs are done, and what each of them injects.

mod check;
pub(crate) mod ramp;
pub(crate) mod run;
pub(crate) mod testbed;
#[cfg(test)]
mod tests;

use ndarray::{Array2, Array3, Axis, s};
use serde::{Deserialize, Serialize};

use crate::error::SignalError;
use crate::excitation::{Draw, Excitation, GoOn, Injection, Phasing};
use crate::plan::ramp::Ramp;
use crate::plan::run::{Run, RunId, RunKind};

/// A campaign: realizations x experiments x repetitions, each run a lead-in and one or more periods
/// back to back.
///
/// The plan is a description: [`Plan::run`] makes the signals from the seed when they are needed,
/// so a campaign of any length costs the memory of one realization.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Seed of the random phases.
    pub seed: u64,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Number of inputs of the machine.
    pub n_inputs: usize,
    /// What excites the machine.
    pub excitation: Excitation,
    /// Phases between channels and experiments.
    pub phasing: Phasing,
    /// What the reference stands for.
    pub injection: Injection,
    /// Draws of the random phases, n_p; 1 for a chirp.
    pub n_realizations: usize,
    /// Separate runs of the same reference.
    pub n_repetitions: usize,
    /// Measured periods back to back in each run; 1 for a chirp. The estimator's n_q is
    /// `n_repetitions n_periods`.
    pub n_periods: usize,
    /// Samples before the first measured period: the multisine's own continuation backwards, rest
    /// before a chirp.
    pub lead_in_samples: usize,
    /// Samples over which a multisine rises from 0 at the begin of its lead-in, and falls to 0 after
    /// its last measured period; 0 for none. What happens once has fades of its own.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub ramp_samples: usize,
    /// Constant velocity in rad/s beneath every run, per channel; zeros for none.
    pub velocity_rad_s: Vec<f64>,
    /// Runs of the constant velocity alone; 0 for none.
    pub n_glides: usize,
}

impl Plan {
    /// Experiments per realization: the columns of U, as many as inputs, or one for all.
    #[must_use]
    pub fn n_experiments(&self) -> usize {
        self.phasing.n_experiments(self.n_inputs)
    }

    /// Samples of one period, as [`Waveform::period_samples`](crate::Waveform::period_samples) says.
    ///
    /// # Errors
    /// [`SignalError`] for an impossible length.
    pub fn period_samples(&self) -> Result<usize, SignalError> {
        self.excitation
            .waveform()
            .period_samples(self.sample_time_s)
    }

    /// Samples of one run, lead-in and ramps included.
    ///
    /// # Errors
    /// As [`Plan::period_samples`].
    pub fn run_samples(&self) -> Result<usize, SignalError> {
        Ok(self.lead_in_samples + self.n_periods * self.period_samples()? + self.ramp_samples)
    }

    /// Every run, glides first, then realization by realization.
    pub fn run_ids(&self) -> impl Iterator<Item = RunId> + use<> {
        let (n_experiments, n_repetitions) = (self.n_experiments(), self.n_repetitions);
        let glides = (0..self.n_glides).map(RunId::glide);
        let runs = (0..self.n_realizations).flat_map(move |realization| {
            (0..n_experiments).flat_map(move |experiment| {
                (0..n_repetitions)
                    .map(move |repetition| RunId::excitation(realization, experiment, repetition))
            })
        });
        glides.chain(runs)
    }

    /// Number of runs, glides included.
    #[must_use]
    pub fn n_runs(&self) -> usize {
        self.n_glides + self.n_realizations * self.n_experiments() * self.n_repetitions
    }

    /// Time on the robot in s: all runs, without the way back to the start.
    ///
    /// # Errors
    /// As [`Plan::period_samples`].
    pub fn robot_time_s(&self) -> Result<f64, SignalError> {
        Ok(self.n_runs() as f64 * self.run_samples()? as f64 * self.sample_time_s)
    }

    /// One period of every experiment of a realization, `(experiment, input, sample)`, without the
    /// constant velocity.
    ///
    /// # Errors
    /// [`SignalError`] if the plan's numbers do not fit together.
    pub fn period(&self, realization: usize) -> Result<Array3<f64>, SignalError> {
        self.period_while(realization, &|| true)
    }

    /// The same as long as `go_on` says so.
    pub(crate) fn period_while(
        &self,
        realization: usize,
        go_on: GoOn,
    ) -> Result<Array3<f64>, SignalError> {
        self.check()?;
        let draw = Draw {
            seed: self.seed,
            realization,
            phasing: self.phasing,
        };
        self.excitation
            .waveform()
            .period(self.sample_time_s, self.n_inputs, &draw, go_on)
    }

    /// The run of this name, with its reference from lead-in to end.
    ///
    /// # Errors
    /// [`SignalError::NoSuchRun`], or [`SignalError`] if the plan's numbers do not fit together.
    pub fn run(&self, id: RunId) -> Result<Run, SignalError> {
        self.run_while(id, &|| true)
    }

    /// The same as long as `go_on` says so: phases for a low crest factor take a while.
    ///
    /// # Errors
    /// As [`Plan::run`]; [`SignalError::Interrupted`].
    pub fn run_while(&self, id: RunId, go_on: GoOn) -> Result<Run, SignalError> {
        let count = match id.kind {
            RunKind::Excitation => [
                self.n_realizations,
                self.n_experiments(),
                self.n_repetitions,
            ],
            RunKind::Glide => [1, 1, self.n_glides],
        };
        if id.realization >= count[0] || id.experiment >= count[1] || id.repetition >= count[2] {
            return Err(self.no_such_run(id));
        }
        let reference = match id.kind {
            RunKind::Excitation => {
                let experiments = self.period_while(id.realization, go_on)?;
                self.extended(&experiments.index_axis_move(Axis(0), id.experiment))
            }
            RunKind::Glide => Array2::zeros((self.n_inputs, self.run_samples()?)),
        };
        Ok(self.on_constant_velocity(id, reference))
    }

    /// Lead-in, periods and ramps from one period.
    fn extended(&self, period: &Array2<f64>) -> Array2<f64> {
        let n = period.ncols();
        let lead_in = self.lead_in_samples;
        let end = lead_in + self.n_periods * n;
        let mut reference = Array2::zeros((self.n_inputs, end + self.ramp_samples));
        let periodic = self.excitation.waveform().is_periodic();
        for (k, mut column) in reference.axis_iter_mut(Axis(1)).enumerate() {
            if periodic || k >= lead_in {
                // backwards from the first measured period: sample lead_in is sample 0 of the
                // period
                column.assign(&period.slice(s![.., (k + n - lead_in % n) % n]));
            }
        }
        self.fade(&mut reference, end);
        reference
    }

    /// Lets a reference rise over its first samples and fall over those from `end` on.
    fn fade(&self, reference: &mut Array2<f64>, end: usize) {
        let duration_s = self.ramp_samples as f64 * self.sample_time_s;
        let risen = |k: usize| Ramp { duration_s }.at(k as f64 * self.sample_time_s)[0];
        for k in 0..self.ramp_samples {
            reference.column_mut(k).mapv_inplace(|x| risen(k) * x);
            let fallen = 1.0 - risen(k + 1);
            reference.column_mut(end + k).mapv_inplace(|x| fallen * x);
        }
    }

    /// The run of a reference, on the constant velocity beneath it.
    fn on_constant_velocity(&self, id: RunId, mut reference: Array2<f64>) -> Run {
        if self.injection == Injection::Velocity {
            for (mut row, velocity) in reference.rows_mut().into_iter().zip(&self.velocity_rad_s) {
                row += *velocity;
            }
        }
        let start_rad = self.start_before(reference.ncols());
        let velocity_rad_s = self.velocity_rad_s.clone();
        Run {
            id,
            sample_time_s: self.sample_time_s,
            reference,
            velocity_rad_s,
            start_rad,
        }
    }

    /// Where every run starts, in rad from the pose, one for each channel.
    ///
    /// # Errors
    /// As [`Plan::period_samples`].
    pub fn start_rad(&self) -> Result<Vec<f64>, SignalError> {
        Ok(self.start_before(self.run_samples()?))
    }

    /// The way of a run lies symmetrically about the pose, so that it stays as near to it as it
    /// can.
    fn start_before(&self, run_samples: usize) -> Vec<f64> {
        let half_way_s = 0.5 * run_samples as f64 * self.sample_time_s;
        self.velocity_rad_s
            .iter()
            .map(|velocity| 0.0 - velocity * half_way_s)
            .collect()
    }

    fn no_such_run(&self, id: RunId) -> SignalError {
        SignalError::NoSuchRun {
            id: id.to_string(),
            n_realizations: self.n_realizations,
            n_experiments: self.n_experiments(),
            n_repetitions: self.n_repetitions,
            glides: if self.n_glides > 0 {
                " and glides"
            } else {
                ", no glides"
            },
        }
    }
}

/// What is left out of a description.
fn is_zero(samples: &usize) -> bool {
    *samples == 0
}
