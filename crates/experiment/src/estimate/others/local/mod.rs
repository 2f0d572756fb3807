//! Recordings in which nothing repeats: the FRF from whole records by local models.

mod band;
mod whole_pieces;

use std::cmp::Reverse;

use frfid_estimate::{LocalEstimate, LocalModel, LocalOptions, Piece, estimate_local};
use frfid_files::{Cause, Check, LogMap, ResultFile};
use frfid_signals::format::significant;

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::others::checks;
use crate::estimate::others::local::band::frequencies;
use crate::estimate::others::local::whole_pieces::{WholePiece, whole_pieces};
use crate::estimate::others::looked::Looked;
use crate::estimate::others::recording::Recording;
use crate::estimate::outcome::{Outcome, left_out_check};
use crate::estimate::verdicts::{Evidence, judge};
use crate::run::provenance::{Metadata, metadata};

/// Sample times of recordings that are estimated together differ by less.
const SAME_RATE: f64 = 1e-5;
/// Pieces that are used at most.
const MOST_PIECES: usize = 16;
/// Verdicts of an FRF without periods.
const CHECKED: [Cause; 2] = [Cause::Noise, Cause::Distortion];

/// Estimates the FRF from recordings that were looked at, each a record from its beginning to its end or to a hole.
///
/// # Errors
/// [`ExperimentError`]: recordings too short or without excitation, inputs that are alike.
pub(super) fn by_local_models(
    mut looked: Looked,
    map: &LogMap,
    options: &EstimateTable,
) -> Result<Outcome, ExperimentError> {
    looked.leave_out_useless();
    looked.leave_out_other_rates();
    let local = looked.local_estimate(options)?;
    Ok(looked.outcome(local, map))
}

/// What came of the pieces.
struct Local {
    estimate: LocalEstimate,
    method: &'static str,
    n_pieces: usize,
    /// Share of the samples that lie in holes, or in pieces too short or too many.
    unused_share: f64,
}

/// The longest pieces: each has a transient of its own, and unknowns for it.
fn longest(mut pieces: Vec<WholePiece>) -> Vec<WholePiece> {
    pieces.sort_by_key(|piece| Reverse(piece.n_samples()));
    pieces.truncate(MOST_PIECES);
    pieces
}

fn nothing_left(looked: &Looked) -> ExperimentError {
    let found = looked
        .unused
        .first()
        .map_or("none".into(), ToString::to_string);
    ExperimentError::logs(
        "recordings",
        found,
        "one whose signals move",
        "see whether the map names the right signals",
    )
}

impl Looked {
    /// Samples of all recordings.
    fn n_samples(&self) -> usize {
        let recordings = self.recordings.iter();
        recordings
            .map(|recording| recording.log.record.n_samples())
            .sum()
    }

    /// The estimate from all pieces.
    fn local_estimate(&self, options: &EstimateTable) -> Result<Local, ExperimentError> {
        let Some(first) = self.recordings.first() else {
            return Err(nothing_left(self));
        };
        let (sample_time_s, complaint) = (first.log.record.sample_time_s, first.complaint());
        let pieces = longest(self.recordings.iter().flat_map(whole_pieces).collect());
        let frequency_hz = frequencies(&pieces, sample_time_s, options.n_frequencies);
        let frequency_hz = frequency_hz.map_err(&complaint)?;
        let parts: Vec<Piece> = pieces.iter().map(WholePiece::view).collect();
        let model = options.method().local_model().unwrap_or_default();
        let fit = LocalOptions {
            model,
            half_width: options.half_width,
            ..LocalOptions::default()
        };
        let found = estimate_local(&parts, sample_time_s, &frequency_hz, &fit);
        let n_used: usize = pieces.iter().map(WholePiece::n_samples).sum();
        Ok(Local {
            estimate: found.map_err(complaint)?,
            method: match model {
                LocalModel::Rational => "local-rational",
                LocalModel::Polynomial => "local-polynomial",
            },
            n_pieces: pieces.len(),
            unused_share: 1.0 - n_used as f64 / self.n_samples().max(1) as f64,
        })
    }

    /// Leaves out recordings with a signal that says nothing.
    fn leave_out_useless(&mut self) {
        self.leave_out(Recording::refusal);
    }

    /// Leaves out recordings of another rate than the first: their lines are of another clock.
    fn leave_out_other_rates(&mut self) {
        let step_s = |recording: &Recording| recording.log.record.sample_time_s;
        let Some(first_s) = self.recordings.first().map(step_s) else {
            return;
        };
        self.leave_out(|recording| {
            let own_s = step_s(recording);
            let is_other = (own_s / first_s - 1.0).abs() > SAME_RATE;
            is_other.then(|| {
                format!("its sample time is {own_s} s, that of the first recording {first_s} s")
            })
        });
    }

    fn leave_out(&mut self, reason: impl Fn(&Recording) -> Option<String>) {
        let (recordings, unused) = (&mut self.recordings, &mut self.unused);
        recordings.retain(|recording| match reason(recording) {
            Some(reason) => {
                unused.push(recording.unused(reason));
                false
            }
            None => true,
        });
    }

    /// The FRF with its checks and warnings.
    fn outcome(self, local: Local, map: &LogMap) -> Outcome {
        let (checks, warnings) = (self.checks(&local), self.warnings(&local));
        let provenance = self.provenance(&local, map);
        let has_losses = |recording: &Recording| !recording.log.losses.is_empty();
        let is_lossy = !self.unused.is_empty() || self.recordings.iter().any(has_losses);
        let first = self.recordings.into_iter().next();
        let log = first.expect("a record was estimated").log;
        let inputs = [log.input_names, log.input_units];
        let outputs = [log.output_names, log.output_units];
        let mut result = ResultFile {
            checks,
            provenance,
            ..ResultFile::between(local.estimate.estimate.frf, inputs, outputs)
        };
        let axes = result.output_names.clone();
        judge(&mut result, &axes, &Evidence::default(), &CHECKED);
        Outcome {
            result,
            warnings,
            is_lossy,
            strength: None,
            load: None,
        }
    }

    fn checks(&self, local: &Local) -> Vec<Check> {
        let n_given = self.n_given;
        let used = checks::all_used(self.recordings.len(), n_given, &self.unused);
        let left_out = left_out_check(local.estimate.estimate.left_out.len());
        let signals = checks::signals(&self.recordings);
        let clock = checks::one_clock(&self.recordings);
        used.into_iter()
            .chain(signals)
            .chain(clock)
            .chain(left_out)
            .collect()
    }

    fn warnings(&self, local: &Local) -> Vec<String> {
        let mut warnings = vec![how(local)];
        warnings.extend(self.recordings.iter().flat_map(Recording::lost));
        warnings.extend(self.unused.iter().map(ToString::to_string));
        warnings.extend(self.recordings.iter().flat_map(Recording::remarks));
        warnings.extend(self.recordings.iter().flat_map(Recording::unit_words));
        warnings.extend(local.estimate.estimate.warnings());
        warnings
    }

    fn provenance(&self, local: &Local, map: &LogMap) -> Metadata {
        let durations = self
            .recordings
            .iter()
            .map(|recording| recording.log.duration_s);
        let [low, high] = half_widths(&local.estimate);
        metadata([
            ("frfid_version", env!("CARGO_PKG_VERSION").to_owned()),
            ("log_map", serde_json::to_string(map).unwrap_or_default()),
            ("method", local.method.to_owned()),
            ("recordings_used", self.recordings.len().to_string()),
            ("pieces", local.n_pieces.to_string()),
            ("half_width_lines", format!("{low} to {high}")),
            ("duration_s", significant(durations.sum(), 9)),
        ])
    }
}

/// The narrowest and the widest half width in lines.
fn half_widths(found: &LocalEstimate) -> [usize; 2] {
    let all = || found.half_widths.iter().copied();
    [all().min().unwrap_or(0), all().max().unwrap_or(0)]
}

fn how(local: &Local) -> String {
    let ([low, high], n) = (
        half_widths(&local.estimate),
        local.estimate.half_widths.len(),
    );
    let parted = match local.n_pieces {
        1 => String::new(),
        n_pieces => format!(
            " in {n_pieces} pieces, {} % of the samples unused,",
            significant(100.0 * local.unused_share, 2)
        ),
    };
    format!(
        "nothing repeats: {n} frequencies from whole records{parted} by local models, {low} to {high} lines to either \
         side; noise and distortion are not told apart"
    )
}
