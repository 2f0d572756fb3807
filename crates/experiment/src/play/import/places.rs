//! Places of the runs of a plan by the clock of the player that plays it.

use frfid_signals::{Plan, Player, Run, RunId};
use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::error::ExperimentError;
use crate::run::planned_runs::PlannedRuns;

/// Where each reference begins by the player's clock: in a file of its own, or in one of the campaign.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// Sample time of the player in s.
    pub(super) step_s: f64,
    /// In s, by the first repetition.
    of_run_s: BTreeMap<RunId, Vec<f64>>,
}

impl Places {
    /// The places of every run of a plan.
    pub(super) fn of(planned: &PlannedRuns, player: &Player) -> Result<Self, ExperimentError> {
        let (mut places, mut first_k) = (Self::new(player), 0);
        for (id, n_repetitions) in planned.references() {
            let playback = planned
                .experiment
                .plan
                .playback(&planned.run(id)?, player)?;
            places.add(id, playback.first_sample);
            for _ in 0..n_repetitions {
                places.add(id, first_k + playback.first_sample);
                first_k += playback.n_samples();
            }
        }
        Ok(places)
    }

    /// The place of one run in its file.
    pub(super) fn of_run(plan: &Plan, run: &Run, player: &Player) -> Result<Self, ExperimentError> {
        let mut places = Self::new(player);
        places.add(run.id, plan.playback(run, player)?.first_sample);
        Ok(places)
    }

    fn new(player: &Player) -> Self {
        Self {
            step_s: 1.0 / player.rate_hz,
            ..Self::default()
        }
    }

    fn add(&mut self, id: RunId, k: usize) {
        let place_s = k as f64 * self.step_s;
        self.of_run_s.entry(id).or_default().push(place_s);
    }

    /// How long after the nearest of its places a run begins at this time of the player, in s.
    pub(super) fn delay_s(&self, id: RunId, begin_s: f64) -> Option<f64> {
        let places_s = self.of_run_s.get(&id)?;
        let delays_s = places_s.iter().map(|place_s| begin_s - place_s);
        delays_s.min_by(by_size)
    }
}

fn by_size(a: &f64, b: &f64) -> Ordering {
    a.abs().total_cmp(&b.abs())
}
