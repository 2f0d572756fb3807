//! Rehearsal of a plan: every reference as a player plays it, held against the limits before anything is written.

use std::sync::Arc;

use frfid_files::Rehearsal;
use frfid_signals::{GoOn, Playback, Player, RunId};

use crate::error::ExperimentError;
use crate::run::parallel::{Progress, Steps, for_each};
use crate::run::planned_runs::PlannedRuns;

impl PlannedRuns {
    /// The first repetition of every reference with their number, in the order in which they are played.
    pub(crate) fn references(&self) -> Vec<(RunId, usize)> {
        let mut references: Vec<(RunId, usize)> = Vec::new();
        for id in self.run_ids() {
            match references.last_mut() {
                Some((first, n)) if is_same_reference(*first, id) => *n += 1,
                _ => references.push((id, 1)),
            }
        }
        references
    }

    /// Every reference as `player` plays it, on `jobs` threads (0: one for each core).
    ///
    /// # Errors
    /// As [`PlannedRuns::playback`]; [`ExperimentError::Interrupted`].
    pub fn rehearse(
        &self,
        player: &Player,
        jobs: usize,
        progress: Progress,
    ) -> Result<Vec<Rehearsal>, ExperimentError> {
        let references = self.references();
        let steps = Steps {
            progress,
            before: 0,
            total: references.len(),
        };
        for_each(&references, jobs, steps, |&reference, go_on| {
            self.rehearse_one(reference, player, go_on)
        })
    }

    fn rehearse_one(
        &self,
        (id, n_repetitions): (RunId, usize),
        player: &Player,
        go_on: GoOn,
    ) -> Result<Rehearsal, ExperimentError> {
        let (playback, predicted) = self
            .experiment
            .rehearsed(&self.run_while(id, go_on)?, player)?;
        Ok(Rehearsal {
            id,
            n_repetitions,
            n_samples: playback.n_samples(),
            first_sample: playback.first_sample,
            run_samples: playback.run_samples,
            duration_s: playback.n_samples() as f64 * playback.sample_time_s,
            commanded: playback.peaks(&player.pose_rad),
            predicted: Some(predicted),
        })
    }

    /// A run that was rehearsed, made anew: signals of a whole plan would take much memory.
    pub(crate) fn rehearsed_again(
        &self,
        run: &Rehearsal,
        player: &Player,
    ) -> Result<Arc<Playback>, ExperimentError> {
        let playback = self.experiment.as_played(&self.run(run.id)?, player)?;
        Ok(Arc::new(playback))
    }
}

fn is_same_reference(first: RunId, id: RunId) -> bool {
    let repetition = first.repetition;
    RunId { repetition, ..id } == first
}
