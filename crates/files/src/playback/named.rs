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
        for playback in &self.playbacks {
            let after = NamedPlayback::after(all.last(), playback);
            all.push(after);
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

impl<'a> NamedPlayback<'a> {
    /// A playback behind another, or the first one.
    fn after(before: Option<&Self>, playback: &'a Playback) -> Self {
        Self {
            id: before.map_or(playback.id, |before| before.next_id(playback)),
            first_k: before.map_or(0, Self::end_k),
            playback,
        }
    }

    /// The sample after its last.
    fn end_k(&self) -> usize {
        self.first_k + self.playback.n_samples()
    }

    /// The next repetition, if it is the same again.
    fn next_id(&self, playback: &Playback) -> RunId {
        let repetition = if self.playback.id == playback.id {
            self.id.repetition + 1
        } else {
            playback.id.repetition
        };
        RunId {
            repetition,
            ..playback.id
        }
    }
}
