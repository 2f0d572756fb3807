//! Table of what the signal of a plan without a model reaches, beside the limits of its channels.

use frfid_experiment::{Experiment, SignalPeaks};
use frfid_signals::format::significant;

use crate::text::table::{or_dash, row, table};

/// What is said where nothing can be predicted.
pub(crate) const NO_MODEL: &str = "no model: only the signal is checked against its limits";

/// Peak, change and crest factor of every channel.
pub(crate) fn signal_as_text(experiment: &Experiment, peaks: &SignalPeaks) -> String {
    let mut rows = vec![row(["signal", "at most", "limit", "used"])];
    for (channel, unit) in experiment.reference_units().iter().enumerate() {
        let limited = |what, key, unit: &str, values: &[f64]| {
            limited(experiment, channel, (what, key, unit), values[channel])
        };
        rows.push(limited("peak", "max_input", unit, &peaks.peak));
        let per_s = format!("{unit} per s");
        rows.push(limited("rate", "max_input_rate", &per_s, &peaks.rate));
        let crest = significant(peaks.crest_factor[channel], 4);
        rows.push(row([
            &of_channel(experiment, channel, "crest factor"),
            &crest,
            "-",
        ]));
    }
    table(&rows)
}

fn of_channel(experiment: &Experiment, channel: usize, what: &str) -> String {
    format!("{} {what}", experiment.joint_names()[channel])
}

/// The row of a value that may have a limit.
fn limited(
    experiment: &Experiment,
    channel: usize,
    (what, key, unit): (&str, &str, &str),
    value: f64,
) -> Vec<String> {
    let allowed = allowed(experiment, key, channel);
    let with_unit = |value: f64| format!("{} {unit}", significant(value, 4));
    let used = |allowed: f64| format!("{:.0} %", 100.0 * value / allowed);
    vec![
        of_channel(experiment, channel, what),
        with_unit(value),
        or_dash(allowed, with_unit),
        allowed.map_or_else(String::new, used),
    ]
}

/// The limit of a channel.
fn allowed(experiment: &Experiment, key: &str, channel: usize) -> Option<f64> {
    let mut limits = experiment.signal_limits();
    let (_, values) = limits.find(|(known, _)| *known == key)?;
    values.get(channel).copied()
}
