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
        let mut provenance = metadata([
            ("frfid_version", env!("CARGO_PKG_VERSION").to_owned()),
            ("log_map", json(map)),
            (
                "method",
                json(&options.method().with_reference(!map.r.is_empty())),
            ),
            ("recordings_used", self.n_recordings_used().to_string()),
            ("duration_s", significant(self.duration_s(), 9)),
        ]);
        provenance.extend(counts(&estimated.runs));
        provenance.extend(estimated.runs.first().into_iter().flat_map(clock));
        provenance
    }

    /// Length of all recordings in s.
    fn duration_s(&self) -> f64 {
        let recordings = self.recordings.iter();
        recordings.map(|recording| recording.log.duration_s).sum()
    }

    /// Number of recordings of which a run is used.
    pub(super) fn n_recordings_used(&self) -> usize {
        let mut used: Vec<usize> = self.runs.iter().map(|run| run.recording).collect();
        used.sort_unstable();
        used.dedup();
        used.len()
    }
}

/// The clock of a run.
fn clock(run: &Measured) -> [(String, String); 3] {
    let (step_s, period_s) = (run.clock.sample_time_s, run.clock.period_s());
    [
        ("sample_time_s", step_s),
        ("period_s", period_s),
        ("period_samples", run.clock.period),
    ]
    .map(|(name, value)| (name.into(), value.to_string()))
}

/// What was used of the runs.
fn counts(runs: &[Measured]) -> Metadata {
    let sum = |of: fn(&Measured) -> usize| runs.iter().map(of).sum::<usize>().to_string();
    let levels: Vec<String> = runs.iter().map(levels).collect();
    metadata([
        ("runs_used", runs.len().to_string()),
        ("periods_used", sum(Measured::n_used)),
        ("periods_lost", sum(|run| run.n_lost)),
        ("transient_periods_dropped", sum(|run| run.n_transient)),
        ("u_rms", levels.join("; ")),
    ])
}

/// Rms of the inputs of a run.
fn levels(run: &Measured) -> String {
    let levels = run.u_rms.iter().map(|rms| significant(*rms, 4));
    levels.collect::<Vec<_>>().join(", ")
}

fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).expect("names and finite numbers")
}
