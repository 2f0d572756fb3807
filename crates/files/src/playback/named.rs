//! Names of what is played: each repetition by its run, and what is said on `/frfid/events` when it begins.

use frfid_signals::{Playback, RunId};
use serde_json::json;

use crate::playback::PlaybackFile;

/// A playback of a file with the repetition that it is, and its first sample in the file.
pub(crate) struct NamedPlayback<'a> {
    pub(crate) id: RunId,
    pub(crate) first_k: usize,
    pub(crate) playback: &'a Playback,
}

impl PlaybackFile {
    /// Every playback with its name.
    pub(crate) fn named(&self) -> Vec<NamedPlayback<'_>> {
        let mut all: Vec<NamedPlayback> = Vec::new();
        let mut first_k = 0;
        for playback in &self.playbacks {
            let id = id_after(all.last(), playback);
            all.push(NamedPlayback {
                id,
                first_k,
                playback,
            });
            first_k += playback.n_samples();
        }
        all
    }

    /// What is said when a run begins, as JSON.
    pub(crate) fn told(&self, run: &NamedPlayback) -> String {
        let (name, plan_id) = (run.id.to_string(), self.plan_id);
        json!({ "event": "playback-start", "run": name, "plan_id": plan_id, "k": run.first_k })
            .to_string()
    }
}

/// The name of a playback behind another: the next repetition, if it is the same again.
fn id_after(before: Option<&NamedPlayback>, playback: &Playback) -> RunId {
    match before {
        Some(before) if before.playback.id == playback.id => {
            let repetition = before.id.repetition + 1;
            RunId {
                repetition,
                ..playback.id
            }
        }
        _ => playback.id,
    }
}
