//! Checks of an estimate from recordings of others.

use frfid_files::Check;
use frfid_signals::Frf;
use frfid_signals::format::{count, significant};

use crate::estimate::others::recording::{Odd, Recording, Unused};
use crate::estimate::others::run::measured::Measured;

/// Whether every recording is used; `None` of a single one.
pub(super) fn all_used(n_used: usize, n_given: usize, unused: &[Unused]) -> Option<Check> {
    (n_given > 1).then(|| Check {
        name: "recordings".into(),
        passed: unused.is_empty(),
        found: format!("{n_used} of {n_given} used"),
        needed: "all of them".into(),
        advice: "see the warnings for why, and estimate what does not belong here by itself".into(),
    })
}

/// Whether there are periods enough for the noise to be known.
pub(super) fn periods(measured: &[Measured], frf: &Frf) -> Check {
    Check {
        name: "periods".into(),
        passed: frf.noise.is_some(),
        found: periods_in_words(measured),
        needed: "2 or more whole ones in each run, for the noise to be known".into(),
        advice: "record more periods back to back".into(),
    }
}

fn periods_in_words(measured: &[Measured]) -> String {
    let sum = |of: fn(&Measured) -> usize| measured.iter().map(of).sum::<usize>();
    let (n_used, n_transient) = (sum(Measured::n_used), sum(|run| run.n_transient));
    let runs = count(measured.len(), "run");
    let lost = match sum(|run| run.n_lost) {
        0 => String::new(),
        n => format!(", {n} lost"),
    };
    let length = measured.first().map_or(String::new(), period_in_words);
    format!("{n_used} of {length} in {runs}, after {n_transient} transient{lost}")
}

fn period_in_words(run: &Measured) -> String {
    let clock = &run.clock;
    let (period_s, samples) = (
        significant(clock.period_s(), 6),
        significant(clock.period, 9),
    );
    format!("{period_s} s ({samples} samples)")
}

/// A check for every signal that may spoil the FRF, or one that none does.
pub(super) fn signals(recordings: &[Recording]) -> Vec<Check> {
    let mut checks: Vec<Check> = Vec::new();
    for recording in recordings {
        for odd in recording.flagged() {
            let name = format!("signal {}", odd.signal);
            if !checks.iter().any(|check| check.name == name) {
                checks.push(odd_signal(name, odd, recording));
            }
        }
    }
    if checks.is_empty() {
        checks.push(sound_signals(recordings.len()));
    }
    checks
}

fn sound_signals(n_recordings: usize) -> Check {
    Check {
        name: "signals".into(),
        passed: true,
        found: format!("nothing odd in {}", count(n_recordings, "recording")),
        needed: "none that is coarse, held, clipped or spoilt by outliers".into(),
        advice: String::new(),
    }
}

fn odd_signal(name: String, odd: &Odd, recording: &Recording) -> Check {
    Check {
        name,
        passed: false,
        found: format!("{}: it {}", recording.name, odd.oddity.found()),
        needed: odd.meaning(),
        advice: odd.oddity.advice(),
    }
}

/// Whether all signals are on one clock.
pub(super) fn one_clock(recordings: &[Recording]) -> Option<Check> {
    let two = recordings.iter().find_map(|recording| {
        let said = recording.log.two_clocks.as_ref()?;
        Some(format!("{}: {said}", recording.name))
    })?;
    Some(Check {
        name: "clock".into(),
        passed: false,
        found: two,
        needed: "inputs and outputs on one clock: the phase is not to be trusted".into(),
        advice: "record both with header stamps of the same machine".into(),
    })
}

/// Whether the runs have settled, line by line, and none of them grows.
pub(super) fn settled(measured: &[Measured]) -> Check {
    let n_periods = measured.iter().map(|run| run.n_periods).min().unwrap_or(0);
    let known = "3 or more, to tell a transient from the steady state";
    let more = "record more periods back to back; until then the first one may be transient";
    let unknown = (count(n_periods, "period"), known, more);
    let is_known = |run: &Measured| run.settling.is_some();
    let found = measured.iter().find_map(unsettled);
    let passed = found.is_none() && measured.iter().all(is_known);
    let (found, needed, advice) = found.unwrap_or(unknown);
    Check {
        name: "settled".into(),
        passed,
        found,
        needed: needed.into(),
        advice: advice.into(),
    }
}

/// In what way a run has not settled: found, needed, advice.
fn unsettled(run: &Measured) -> Option<(String, &'static str, &'static str)> {
    let settled = "all lines settled: the machine still changed from period to period, and no variance tells that";
    let wait =
        "wait longer before the first period that is used (--start), or until the machine is warm";
    if run.never_settles {
        let found = format!(
            "{}: the first half of its periods differs from the rest",
            run.name
        );
        return Some((found, settled, wait));
    }
    let settling = run.settling.as_ref()?;
    if let Some(factor) = settling.growth_per_period {
        let factor = significant(factor, 3);
        return Some((
            format!(
                "{} grows by a factor {factor} from period to period",
                run.name
            ),
            "a stable machine: its periods are alike",
            "lower the gain of the controller, or the excitation",
        ));
    }
    let is_settled = settling.unsettled.is_empty();
    (!is_settled).then(|| (run.unsettled_words(), settled, wait))
}
