//! Evidence of recordings of others for the verdicts: standstill, settling and clipping of every output.

use frfid_estimate::standing_share;
use frfid_signals::Record;
use ndarray::{Array1, s};

use crate::estimate::others::estimated::Estimated;
use crate::estimate::others::found::Found;
use crate::estimate::others::recording::{Recording, Role};
use crate::estimate::others::run::Run;
use crate::estimate::others::run::measured::Measured;
use crate::estimate::verdicts::Evidence;

/// SI units of a velocity.
const VELOCITIES: [&str; 2] = ["rad/s", "m/s"];

impl Found {
    /// What the recordings say beside the FRF.
    pub(super) fn evidence(&self, estimated: &Estimated) -> Evidence {
        let outputs = 0..estimated.estimate.frf.n_outputs();
        let stuck = outputs.clone().map(|output| self.stuck_share(output));
        let unsettled = outputs
            .clone()
            .map(|output| unsettled_share(&estimated.runs, output));
        Evidence {
            stuck: stuck.collect(),
            unsettled: unsettled.collect(),
            most_unsettled: 0.0,
            clipped: outputs.map(|output| self.clipped_share(output)).collect(),
        }
    }

    /// Share of the samples of the runs in which an output that is a velocity stood; `None` for any other.
    fn stuck_share(&self, output: usize) -> Option<f64> {
        let unit = self.recordings.first()?.log.output_units.get(output)?;
        if !VELOCITIES.contains(&unit.as_str()) {
            return None;
        }
        let shares = self
            .runs
            .iter()
            .map(|run| stuck_in(self.recording_of(run), run, output));
        let shares: Vec<f64> = shares.collect::<Option<_>>()?;
        (!shares.is_empty()).then(|| shares.iter().sum::<f64>() / shares.len() as f64)
    }

    /// Largest share of the samples of an output, or of the inputs that act on it, at the ends of the signal.
    fn clipped_share(&self, output: usize) -> f64 {
        let of_recording = |recording: &Recording| {
            let matters = |role: Role, channel: usize| {
                let record = &recording.log.record;
                role == Role::Output && channel == output
                    || role == Role::Input && acts_on(record, channel, output)
            };
            let odd = recording
                .odd
                .iter()
                .filter(|odd| matters(odd.role, odd.channel));
            odd.map(|odd| odd.oddity.clipped_share())
                .fold(0.0, f64::max)
        };
        self.recordings.iter().map(of_recording).fold(0.0, f64::max)
    }
}

/// Whether an input belongs to an output: that of the same axis, or every one where there is no axis.
fn acts_on(record: &Record, input: usize, output: usize) -> bool {
    input == output || record.u.nrows() != record.y.nrows()
}

fn stuck_in(recording: &Recording, run: &Run, output: usize) -> Option<f64> {
    let velocity = recording.log.record.y.row(output);
    let run = velocity.slice(s![run.samples.clone()]);
    let present = run.iter().copied().filter(|sample| sample.is_finite());
    standing_share(Array1::from_iter(present).view())
}

/// Share of the runs in which an output had not settled; `None` where one does not tell.
fn unsettled_share(runs: &[Measured], output: usize) -> Option<f64> {
    let is_unsettled = |run: &Measured| {
        let lines = run.settling.as_ref().map(|settling| &settling.unsettled);
        let of_output = lines.map(|lines| lines.iter().any(|line| line.channel == output));
        of_output.or(run.never_settles.then_some(true))
    };
    let unsettled: Vec<bool> = runs.iter().map(is_unsettled).collect::<Option<_>>()?;
    let n_unsettled = unsettled.iter().filter(|is| **is).count();
    (!unsettled.is_empty()).then(|| n_unsettled as f64 / unsettled.len() as f64)
}
