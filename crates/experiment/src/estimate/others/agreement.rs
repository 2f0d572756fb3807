//! Agreement of runs: sample time, period and lines of each against those of the others.

use std::collections::BTreeSet;

use frfid_signals::format::significant;

use crate::error::ExperimentError;
use crate::estimate::majority::majority;
use crate::estimate::others::recording::{Recording, Unused};
use crate::estimate::others::run::Run;

/// Sample times and periods that differ by less than this are those of one machine, as several
/// clocks tell them: quartzes differ by 1e-4, slewed host clocks by 5e-4.
const SAME_CLOCK: f64 = 2e-3;
/// Share of the lines that two runs must have in common to be runs of one experiment.
const MOST_LINES: f64 = 0.5;

/// What runs must have in common.
struct Traits<'a> {
    sample_time_s: f64,
    period_s: f64,
    lines: &'a [usize],
}

/// Keeps the runs that agree with most, on the lines that they all excite; the others are named.
///
/// # Errors
/// [`ExperimentError::Logs`] where no more than half of them agree.
pub(super) fn agreeing(
    recordings: &[Recording],
    runs: Vec<Run>,
    unused: &mut Vec<Unused>,
) -> Result<Vec<Run>, ExperimentError> {
    let differences = differences(recordings, &runs)?;
    let mut agreeing = Vec::new();
    for (run, difference) in runs.into_iter().zip(differences) {
        match difference {
            None => agreeing.push(run),
            Some(difference) => unused.push(recordings[run.recording].unused(difference)),
        }
    }
    Ok(agreeing)
}

/// In what each run differs from most of them.
fn differences(
    recordings: &[Recording],
    runs: &[Run],
) -> Result<Vec<Option<String>>, ExperimentError> {
    let traits: Vec<Traits> = runs.iter().map(|run| Traits::of(recordings, run)).collect();
    let agree = |a: &Traits, b: &Traits| a.difference(b).is_none();
    let Some(kept) = majority(&traits, agree) else {
        return Err(disagreement(recordings, runs, &traits));
    };
    let kept = &traits[kept];
    Ok(traits.iter().map(|run| run.difference(kept)).collect())
}

/// Keeps the lines that every run excites; returns those that some do not.
pub(super) fn keep_common_lines(runs: &mut [Run]) -> Vec<usize> {
    let sets = || {
        runs.iter()
            .map(|run| BTreeSet::from_iter(run.lines.iter().copied()))
    };
    let common = sets().reduce(|a, b| &a & &b).unwrap_or_default();
    let all = sets().reduce(|a, b| &a | &b).unwrap_or_default();
    let others = all.difference(&common).copied().collect();
    for run in runs {
        run.lines = common.iter().copied().collect();
    }
    others
}

impl<'a> Traits<'a> {
    fn of(recordings: &[Recording], run: &'a Run) -> Self {
        let sample_time_s = recordings[run.recording].log.record.sample_time_s;
        Self {
            sample_time_s,
            period_s: run.period * sample_time_s,
            lines: &run.lines,
        }
    }

    /// In what a run differs from another one, in words; `None` where it does not.
    fn difference(&self, other: &Self) -> Option<String> {
        if !is_same(self.sample_time_s, other.sample_time_s) {
            let [found, needed] = [self, other].map(|of| significant(of.sample_time_s, 6));
            return Some(format!(
                "sampled every {found} s, the others every {needed} s"
            ));
        }
        if !is_same(self.period_s, other.period_s) {
            return Some(self.other_period(other));
        }
        self.other_lines(other)
    }

    /// That it excites other lines, if less than half of them are the same.
    fn other_lines(&self, other: &Self) -> Option<String> {
        let mine: BTreeSet<usize> = self.lines.iter().copied().collect();
        let n_common = other
            .lines
            .iter()
            .filter(|line| mine.contains(line))
            .count();
        let most = self.lines.len().max(other.lines.len());
        let [found, needed] = [self, other].map(Traits::lines_in_words);
        ((n_common as f64) < MOST_LINES * most as f64).then(|| {
            format!(
                "it excites other lines, {found}, than the others, {needed}: {n_common} in common"
            )
        })
    }

    /// That its period is another one; a whole part of it is that of other lines.
    fn other_period(&self, other: &Self) -> String {
        let [found, needed] = [self, other].map(|of| significant(of.period_s, 6));
        let ratio = self.period_s.max(other.period_s) / self.period_s.min(other.period_s);
        let other_lines = match is_same(ratio, ratio.round()) {
            true => ", so that it excites other lines",
            false => "",
        };
        format!("its period is {found} s, that of the others {needed} s{other_lines}")
    }

    fn lines_in_words(&self) -> String {
        let hz = |line: Option<&usize>| {
            significant(line.map_or(0.0, |&line| line as f64 / self.period_s), 5)
        };
        let (low, high) = (hz(self.lines.first()), hz(self.lines.last()));
        format!("{} from {low} to {high} Hz", self.lines.len())
    }
}

fn is_same(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() <= SAME_CLOCK
}

/// The first two runs that do not agree.
fn disagreement(recordings: &[Recording], runs: &[Run], traits: &[Traits]) -> ExperimentError {
    let others = traits.iter().zip(runs).skip(1);
    let mut different = others.filter_map(|(of, run)| Some((run, of.difference(&traits[0])?)));
    let Some((run, difference)) = different.next() else {
        return ExperimentError::logs("recordings", "none", "at least one", "name recordings");
    };
    let [first, other] = [&runs[0], run].map(|run| recordings[run.recording].name.as_str());
    ExperimentError::logs(
        "recordings",
        format!("{other} unlike {first}: {difference}"),
        "recordings of one experiment, or more than half of them alike",
        "estimate those that belong together",
    )
}
