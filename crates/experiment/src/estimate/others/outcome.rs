//! Outcome of an estimate from recordings of others: the FRF with its checks, and what a careful
//! reader should know besides.

use frfid_estimate::{Consequence, EqualDraws};
use frfid_files::{Cause, Check, LogMap, ResultFile};
use frfid_signals::format::{count, significant};

use crate::description::estimate::EstimateTable;
use crate::estimate::others::checks;
use crate::estimate::others::estimated::Estimated;
use crate::estimate::others::found::Found;
use crate::estimate::others::recording::units::period_words;
use crate::estimate::others::recording::{Odd, Recording};
use crate::estimate::others::run::measured::Measured;
use crate::estimate::outcome::{Outcome, condition_check, left_out_check, noise_bias_check};
use crate::estimate::verdicts::judge;

/// Verdicts that have no other check.
const CHECKED: [Cause; 3] = [Cause::Noise, Cause::Distortion, Cause::Sticking];

/// Levels of one input that differ by more than this are told: a nonlinear machine has another FRF
/// at each.
const LIKE_LEVELS: f64 = 1.5;
/// An input weaker than this share of another run's is not excited in its run.
const QUIET: f64 = 0.1;

impl Found {
    /// The FRF with its checks and warnings.
    pub(super) fn outcome(
        self,
        estimated: Estimated,
        map: &LogMap,
        options: &EstimateTable,
    ) -> Outcome {
        let checks = self.checks(&estimated);
        let evidence = self.evidence(&estimated);
        let warnings = self.warnings(&estimated);
        let provenance = self.provenance(&estimated, map, options);
        let is_lossy = self.is_lossy(&estimated);
        let first = self.recordings.into_iter().next();
        let log = first.expect("runs come from recordings").log;
        let inputs = [log.input_names, log.input_units];
        let outputs = [log.output_names, log.output_units];
        let mut result = ResultFile {
            checks,
            provenance,
            ..ResultFile::between(estimated.estimate.frf, inputs, outputs)
        };
        let axes = result.output_names.clone();
        if let Some(response) = estimated.response {
            let reference = (log.reference_names, log.reference_units);
            response.put_into(&mut result, &reference);
        }
        judge(&mut result, &axes, &evidence, &CHECKED);
        Outcome {
            result,
            warnings,
            is_lossy,
            strength: None,
            load: None,
        }
    }

    fn checks(&self, estimated: &Estimated) -> Vec<Check> {
        let frf = &estimated.estimate.frf;
        let n_left_out = estimated.estimate.left_out.len() + self.not_common.len();
        let of_signals = checks::signals(&self.recordings).into_iter();
        let all = (checks::all_used(self.n_recordings_used(), self.n_given, &self.unused)
            .into_iter())
        .chain(of_signals)
        .chain(checks::one_clock(&self.recordings))
        .chain([
            checks::periods(&estimated.runs, frf),
            checks::settled(&estimated.runs),
        ])
        .chain(left_out_check(n_left_out))
        .chain(noise_bias_check(estimated.estimate.noise_bias))
        .chain([condition_check(frf, &[])]);
        all.collect()
    }

    /// Whether something of what was recorded is not in the estimate.
    fn is_lossy(&self, estimated: &Estimated) -> bool {
        let is_holed = |recording: &Recording| !recording.log.losses.is_empty();
        !self.unused.is_empty()
            || estimated.n_incomplete > 0
            || self.recordings.iter().any(is_holed)
    }

    /// What was lost, left out, mended or odd, in this order.
    fn warnings(&self, estimated: &Estimated) -> Vec<String> {
        let mut warnings: Vec<String> = self.recordings.iter().flat_map(Recording::lost).collect();
        warnings.extend(self.unused.iter().map(ToString::to_string));
        warnings.extend((estimated.n_incomplete > 0).then(|| incomplete(estimated)));
        warnings.extend(self.recordings.iter().flat_map(Recording::remarks));
        warnings.extend(self.recordings.iter().flat_map(Recording::unit_words));
        for run in &estimated.runs {
            warnings.extend(run.trend_words(&self.recordings[run.recording]));
            warnings.extend(run.clock_words());
        }
        let period_s = estimated.runs.first().map(|run| run.clock.period_s());
        warnings.extend(period_s.and_then(period_words));
        warnings.extend(levels(estimated));
        let draws = estimated.equal.iter();
        warnings.extend(draws.map(|draws| same_draw(draws, estimated)));
        warnings.extend(self.lines_left_out());
        warnings.extend(estimated.estimate.warnings());
        warnings
    }

    /// Which lines are left out because some run does not excite them.
    fn lines_left_out(&self) -> Option<String> {
        let first = self.not_common.first()?;
        let n_lines = count(self.not_common.len(), "line");
        Some(format!(
            "{n_lines} that some of the runs do not excite are left out, the first of them line {first}"
        ))
    }
}

/// Says that periods of one experiment have no partner.
fn incomplete(estimated: &Estimated) -> String {
    format!(
        "{} are not in the estimate, because not all of their experiments are whole",
        count(estimated.n_incomplete, "period")
    )
}

/// Says at which inputs the levels of the runs differ.
fn levels(estimated: &Estimated) -> Vec<String> {
    let Some((first, rest)) = estimated.runs.split_first() else {
        return Vec::new();
    };
    let of_input = |input| {
        let level = first.u_rms[input];
        let other = rest
            .iter()
            .find(|run| is_other_level(level, run.u_rms[input]))?;
        Some(other_level(first, other, input))
    };
    (0..first.u_rms.len()).filter_map(of_input).collect()
}

/// Whether two levels differ; an input that is quiet in one of them is not meant.
fn is_other_level(a: f64, b: f64) -> bool {
    let (low, high) = (a.min(b), a.max(b));
    high > LIKE_LEVELS * low && low > QUIET * high
}

fn other_level(first: &Measured, other: &Measured, input: usize) -> String {
    format!(
        "input {} has {} rms in {} and {} in {}: a nonlinear machine has another FRF at each level",
        input + 1,
        significant(other.u_rms[input], 3),
        other.name,
        significant(first.u_rms[input], 3),
        first.name
    )
}

/// Says which runs are one draw of phases.
fn same_draw(draws: &EqualDraws, estimated: &Estimated) -> String {
    let names = draws.realizations.iter();
    let names: Vec<&str> = names
        .map(|&run| estimated.runs[run].name.as_str())
        .collect();
    let lost = match estimated.estimate.frf.total {
        Some(_) => "",
        None => "; distortion is not measured by them: record other phases",
    };
    format!(
        "{}: the same draw of phases (residual {:.2} rad), counted as repetitions{lost}",
        names.join(", "),
        draws.residual_rad
    )
}

impl Recording {
    /// What is odd without failing a check, and what the reader of the file had to say.
    pub(super) fn remarks(&self) -> Vec<String> {
        let told = |odd: &&Odd| matches!(odd.consequence(), Consequence::Told | Consequence::Cured);
        let odd = self.odd.iter().filter(told).map(|odd| {
            let cured = if odd.is_cured { "; mended" } else { "" };
            format!("{}{cured}", odd.words())
        });
        let warnings = self.log.warnings.iter().cloned();
        let all = warnings.chain(odd);
        all.map(|words| format!("{}: {words}", self.name)).collect()
    }
}
