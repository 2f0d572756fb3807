//! Provenance of an estimate from recordings of others: the map, what was found, what was used.

use frfid_files::LogMap;
use frfid_signals::format::significant;

use crate::description::estimate::EstimateTable;
use crate::estimate::others::estimated::Estimated;
use crate::estimate::others::found::Found;
use crate::estimate::others::run::measured::Measured;
use crate::run::provenance::{Metadata, metadata};

impl Found {
    /// Where a result comes from.
    pub(super) fn provenance(
        &self,
        estimated: &Estimated,
        map: &LogMap,
        options: &EstimateTable,
    ) -> Metadata {
        let runs = &estimated.runs;
        let sum = |of: fn(&Measured) -> usize| runs.iter().map(of).sum::<usize>().to_string();
        let first = runs.first().map(|run| &run.clock);
        let (sample_time_s, period_s) =
            first.map_or((0.0, 0.0), |clock| (clock.sample_time_s, clock.period_s()));
        let duration_s: f64 = (self.recordings.iter())
            .map(|recording| recording.log.duration_s)
            .sum();
        let levels: Vec<String> = runs.iter().map(levels).collect();
        metadata([
            ("frfid_version", env!("CARGO_PKG_VERSION").to_owned()),
            ("log_map", json(map)),
            ("method", json(&options.method())),
            ("sample_time_s", sample_time_s.to_string()),
            ("duration_s", significant(duration_s, 9)),
            ("recordings_used", self.n_recordings_used().to_string()),
            ("runs_used", runs.len().to_string()),
            ("period_s", period_s.to_string()),
            ("period_samples", (period_s / sample_time_s).to_string()),
            ("periods_used", sum(Measured::n_used)),
            ("periods_lost", sum(|run| run.n_lost)),
            ("transient_periods_dropped", sum(|run| run.n_transient)),
            ("u_rms", levels.join("; ")),
        ])
    }

    /// Number of recordings of which a run is used.
    pub(super) fn n_recordings_used(&self) -> usize {
        let mut used: Vec<usize> = self.runs.iter().map(|run| run.recording).collect();
        used.sort_unstable();
        used.dedup();
        used.len()
    }
}

/// Rms of the inputs of a run.
fn levels(run: &Measured) -> String {
    let levels = run.u_rms.iter().map(|rms| significant(*rms, 4));
    levels.collect::<Vec<_>>().join(", ")
}

fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).expect("names and finite numbers")
}
