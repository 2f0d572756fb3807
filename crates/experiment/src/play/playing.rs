//! Playing of planned runs: each as a machine can play it, refused where it would exceed a limit from its
//! first rest to its last.

use frfid_signals::{Excess, Injection, Peaks, Plan, Playback, Played, Player, Run, RunId};
use ndarray::Array2;

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::run::load::Load;
use crate::run::planned_runs::PlannedRuns;
use crate::run::signal::SignalPeaks;

/// Rest before and after every run in s: long enough to be recognised.
const REST_S: f64 = 0.5;

impl Experiment {
    /// The machine that is described as a player of `rate_hz`, of the plan's own rate if `None`.
    #[must_use]
    pub fn player(&self, rate_hz: Option<f64>) -> Player {
        Player {
            rate_hz: rate_hz.unwrap_or(1.0 / self.plan.sample_time_s),
            rest_s: REST_S,
            pose_rad: self.pose_rad.clone(),
            limits: self.limits.clone(),
        }
    }

    /// A run as `player` plays it: neither a sample of the reference nor, on the robot's model, the motion
    /// and its torque exceeds a limit, ramps and moves included.
    ///
    /// # Errors
    /// [`ExperimentError::Exceeds`]; [`ExperimentError::Signal`] for a run that cannot be played.
    pub fn playback(&self, run: &Run, player: &Player) -> Result<Playback, ExperimentError> {
        Ok(self.rehearsed(run, player)?.0)
    }

    /// The same with the peaks that the model predicts.
    ///
    /// # Errors
    /// As [`Experiment::playback`].
    pub(crate) fn rehearsed(
        &self,
        run: &Run,
        player: &Player,
    ) -> Result<(Playback, Peaks), ExperimentError> {
        let playback = self.as_played(run, player)?;
        if self.robot.is_none() {
            if let Played::Torque(signal) = &playback.played {
                let whole = at_rest(run, signal.clone(), playback.sample_time_s);
                self.check_signal(&SignalPeaks::of(&whole, Injection::Torque))?;
            }
            let peaks = playback.peaks(&player.pose_rad);
            return Ok((playback, peaks));
        }
        self.refuse(run.id, "reference", playback.excesses(player))?;
        let peaks = self.predicted_peaks(run, player)?;
        let excesses = player.limits.exceeded(&peaks);
        self.refuse(run.id, "motion that the model predicts", excesses)?;
        Ok((playback, peaks))
    }

    /// The run from rest to rest, not held against limits; of channels a signal with ramps, whatever it stands
    /// for.
    pub(crate) fn as_played(
        &self,
        run: &Run,
        player: &Player,
    ) -> Result<Playback, ExperimentError> {
        let played = match &self.config.channels {
            None => self.plan.playback(run, player),
            Some(_) => self.plan_of_signals().playback(run, player),
        };
        Ok(played?)
    }

    fn plan_of_signals(&self) -> Plan {
        Plan {
            injection: Injection::Torque,
            ..self.plan.clone()
        }
    }

    /// What the model reaches where it is given the whole playback, from rest to rest.
    fn predicted_peaks(&self, run: &Run, player: &Player) -> Result<Peaks, ExperimentError> {
        let whole = self.whole_run(run, player)?;
        let simulated = self.simulator(None)?.simulate(&whole)?;
        let load = Load::of(&simulated.record, &whole.start_rad, &self.pose_rad);
        Ok(load.with_changes(simulated.changes).peaks)
    }

    /// The whole playback as a run at the plan's rate, which begins at rest at the pose.
    fn whole_run(&self, run: &Run, player: &Player) -> Result<Run, ExperimentError> {
        let own_rate = Player {
            rate_hz: 1.0 / self.plan.sample_time_s,
            ..player.clone()
        };
        let reference = match self.plan.playback(run, &own_rate)?.played {
            Played::Motion(motion) => motion.velocity_rad_s,
            Played::Torque(torque) => torque,
        };
        Ok(at_rest(run, reference, self.plan.sample_time_s))
    }

    fn refuse(
        &self,
        run: RunId,
        what: &'static str,
        excesses: Vec<Excess>,
    ) -> Result<(), ExperimentError> {
        let Some(excess) = excesses.into_iter().next() else {
            return Ok(());
        };
        let joint = self.joint_names[excess.axis].clone();
        Err(ExperimentError::Exceeds {
            run,
            what,
            joint,
            excess,
        })
    }
}

/// A run with this reference that begins at rest at the pose.
fn at_rest(run: &Run, reference: Array2<f64>, sample_time_s: f64) -> Run {
    let zeros = vec![0.0; reference.nrows()];
    Run {
        id: run.id,
        sample_time_s,
        reference,
        velocity_rad_s: zeros.clone(),
        start_rad: zeros,
    }
}

impl PlannedRuns {
    /// The run of this name as `player` plays it.
    ///
    /// # Errors
    /// As [`PlannedRuns::run`] and [`Experiment::playback`].
    pub fn playback(&self, id: RunId, player: &Player) -> Result<Playback, ExperimentError> {
        self.experiment.playback(&self.run(id)?, player)
    }
}
