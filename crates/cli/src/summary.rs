//! What a plan is and costs, and what it will ask of the robot: for people and as JSON.

use frfid_experiment::{AxisReport, Cost, Excess, LimitsTable, Peaks, Strength};
use frfid_files::Check;
use frfid_signals::{Excitation, Plan, SignalError};
use serde_json::{Value, json};

use crate::console::Console;
use crate::table::{bytes, count, duration, list, significant, table};

/// Excitation, runs and cost of a plan.
pub(crate) fn plan_as_text(plan: &Plan) -> Result<String, SignalError> {
    let cost = Cost::of(plan)?;
    let period_s = plan.period_samples()? as f64 * plan.sample_time_s;
    let (low_hz, high_hz) = band_hz(plan);
    let band = format!(
        "{} to {} Hz",
        significant(low_hz, 5),
        significant(high_hz, 5)
    );
    let mut entries = match &plan.excitation {
        Excitation::Multisine { signal, .. } => vec![
            (
                "multisine",
                format!("{}, {band}", count(signal.grid.excited.len(), "line")),
            ),
            ("period T", format!("{} s", significant(period_s, 6))),
            (
                "line spacing f0",
                format!("{} Hz", significant(1.0 / period_s, 4)),
            ),
        ],
        Excitation::Chirp(chirp) => {
            vec![(
                "chirp",
                format!(
                    "{band} in {} s, {} s with its tail",
                    chirp.duration_s,
                    significant(period_s, 6)
                ),
            )]
        }
    };
    let lead_in_s = plan.lead_in_samples as f64 * plan.sample_time_s;
    entries.push((
        "each run",
        format!(
            "lead-in {} s, {}",
            significant(lead_in_s, 6),
            count(plan.n_periods, "period")
        ),
    ));
    entries.push(("runs", format!("{}: {}", cost.n_runs, runs(plan))));
    entries.push(("time on the robot", duration(cost.robot_time_s)));
    entries.push(("memory for each job", bytes(cost.memory_bytes)));
    entries.push(("disk space at most", bytes(cost.disk_bytes)));
    Ok(list(&entries))
}

/// The same as [`plan_as_text`] for machines.
pub(crate) fn plan_as_json(plan: &Plan) -> Result<Value, SignalError> {
    let cost = Cost::of(plan)?;
    let period_s = plan.period_samples()? as f64 * plan.sample_time_s;
    let (low_hz, high_hz) = band_hz(plan);
    let mut value = json!({
        "seed": plan.seed,
        "sample_time_s": plan.sample_time_s,
        "n_inputs": plan.n_inputs,
        "low_hz": low_hz,
        "high_hz": high_hz,
        "period_s": period_s,
        "n_realizations": plan.n_realizations,
        "n_experiments": plan.n_experiments(),
        "n_repetitions": plan.n_repetitions,
        "n_periods": plan.n_periods,
        "n_glides": plan.n_glides,
        "lead_in_s": plan.lead_in_samples as f64 * plan.sample_time_s,
        "n_runs": cost.n_runs,
        "run_samples": cost.run_samples,
        "robot_time_s": cost.robot_time_s,
        "memory_bytes": cost.memory_bytes,
        "disk_bytes": cost.disk_bytes,
    });
    match &plan.excitation {
        Excitation::Multisine { signal, .. } => {
            value["excitation"] = "multisine".into();
            value["fundamental_hz"] = (1.0 / period_s).into();
            value["n_lines"] = signal.grid.excited.len().into();
        }
        Excitation::Chirp(chirp) => {
            value["excitation"] = "chirp".into();
            value["duration_s"] = chirp.duration_s.into();
        }
    }
    Ok(value)
}

/// Lowest and highest frequency excited, in Hz.
fn band_hz(plan: &Plan) -> (f64, f64) {
    match &plan.excitation {
        Excitation::Multisine { signal, .. } => {
            let line_hz = 1.0 / signal.grid.period_s();
            let at = |line: Option<&usize>| line.map_or(0.0, |line| *line as f64 * line_hz);
            (
                at(signal.grid.excited.first()),
                at(signal.grid.excited.last()),
            )
        }
        Excitation::Chirp(chirp) => (chirp.low_hz, chirp.high_hz),
    }
}

fn runs(plan: &Plan) -> String {
    let counts = [
        (plan.n_realizations, "realization"),
        (plan.n_experiments(), "experiment"),
        (plan.n_repetitions, "repetition"),
    ];
    let product = counts.map(|(number, noun)| count(number, noun)).join(" x ");
    if plan.n_glides > 0 {
        format!("{product}, and {}", count(plan.n_glides, "glide"))
    } else {
        product
    }
}

/// A quantity that may have a limit: the name of the limit, and its own.
const QUANTITIES: [(&str, &str); 8] = [
    ("max_effort", "torque, peak"),
    ("max_effort_rate", "torque rate"),
    ("max_velocity", "velocity"),
    ("max_acceleration", "acceleration"),
    ("max_jerk", "jerk"),
    ("max_travel", "travel"),
    ("min_position", "lowest position"),
    ("max_position", "highest position"),
];

/// Those that are told also where they have no limit.
const ALWAYS_TOLD: [&str; 4] = [
    "max_effort",
    "max_effort_rate",
    "max_velocity",
    "max_travel",
];

/// Largest values beside their limits, a row for each axis and quantity, and below them `others`:
/// name and value per axis.
pub(crate) fn peaks_as_text(
    title: &str,
    peaks: &Peaks,
    limits: &LimitsTable,
    others: &[(&str, Vec<String>)],
) -> String {
    let mut rows = vec![
        [title, "at most", "limit", "used"]
            .map(str::to_owned)
            .to_vec(),
    ];
    for axis in 0..peaks.effort_nm.len() {
        for (name, quantity) in QUANTITIES {
            let Some(value) = peaks.bounded_by(name).and_then(|values| values.get(axis)) else {
                continue;
            };
            let limit = limits
                .named()
                .find(|(given, _)| *given == name)
                .and_then(|(_, limit)| limit.get(axis));
            let limit = limit.filter(|limit| limit.is_finite());
            if limit.is_none() && !ALWAYS_TOLD.contains(&name) {
                continue;
            }
            let with_unit =
                |value: f64| format!("{} {}", significant(value, 4), LimitsTable::unit(name));
            let used = |limit: &f64| format!("{:.0} %", 100.0 * value / limit);
            let is_size = !name.ends_with("_position");
            rows.push(vec![
                format!("axis {} {quantity}", axis + 1),
                with_unit(*value),
                limit.map_or_else(|| "-".into(), |limit| with_unit(*limit)),
                limit.filter(|_| is_size).map_or_else(String::new, used),
            ]);
        }
        let rms = with_torque_unit(peaks.effort_rms_nm[axis]);
        rows.push(vec![
            format!("axis {} torque, rms", axis + 1),
            rms,
            "-".into(),
            String::new(),
        ]);
        let others = others
            .iter()
            .filter_map(|(name, values)| Some((name, values.get(axis)?)));
        rows.extend(others.map(|(name, value)| {
            vec![
                format!("axis {} {name}", axis + 1),
                value.clone(),
                "-".into(),
            ]
        }));
    }
    table(&rows)
}

fn with_torque_unit(value_nm: f64) -> String {
    format!("{} N m", significant(value_nm, 4))
}

/// A limit that was exceeded, in words.
pub(crate) fn excess_in_words(excess: &Excess) -> String {
    let quantity = QUANTITIES
        .into_iter()
        .find(|(name, _)| *name == excess.limit)
        .map_or(excess.limit, |(_, own)| own);
    let [value, limit] = [excess.found, excess.allowed].map(|number| significant(number, 4));
    let (axis, unit) = (excess.axis + 1, LimitsTable::unit(excess.limit));
    format!("axis {axis} {quantity} reached {value} {unit}, the limit is {limit} {unit}")
}

/// What was checked and whether it holds, a row for each check.
pub(crate) fn checks_as_text(checks: &[Check]) -> String {
    let verdict = |passed: bool| if passed { "passed" } else { "FAILED" };
    let row = |check: &Check| {
        vec![
            format!("{}: {}", check.name, check.found),
            verdict(check.passed).to_owned(),
        ]
    };
    table(&checks.iter().map(row).collect::<Vec<_>>())
}

/// Warns of every check that failed, with what to do.
pub(crate) fn warn_of_failed(checks: &[Check], console: &mut Console) {
    for Check {
        name,
        found,
        needed,
        advice,
        ..
    } in checks.iter().filter(|check| !check.passed)
    {
        console.warning(format_args!("{name}: {found}, needed {needed}; {advice}"));
    }
}

/// How the axes were driven and moved: name and value per axis.
pub(crate) fn strength_rows(strength: Option<&Strength>) -> Vec<(&'static str, Vec<String>)> {
    let Some(Strength { axes, .. }) = strength else {
        return Vec::new();
    };
    let rows = |value: &dyn Fn(&AxisReport) -> Option<String>| {
        axes.iter().filter_map(value).collect::<Vec<_>>()
    };
    let all = [
        (
            "torque, rms / friction",
            rows(&|axis| axis.rms_over_coulomb.map(|ratio| significant(ratio, 3))),
        ),
        (
            "stuck",
            rows(&|axis| Some(format!("{:.1} %", 100.0 * axis.stuck_share))),
        ),
        (
            "slowest velocity",
            rows(&|axis| {
                axis.crosses_zero
                    .map(|_| format!("{} rad/s", significant(axis.slowest_rad_s, 3)))
            }),
        ),
        (
            "velocity changes sign",
            rows(&|axis| {
                axis.crosses_zero
                    .map(|crosses| if crosses { "YES" } else { "no" }.into())
            }),
        ),
    ];
    all.into_iter()
        .filter(|(_, values)| values.len() == axes.len())
        .collect()
}

/// The same with the values of all axes beside each other.
pub(crate) fn strength_as_text(strength: Option<&Strength>) -> String {
    let rows = strength_rows(strength)
        .into_iter()
        .map(|(name, values)| (name, values.join(" | ")));
    list(&rows.collect::<Vec<_>>())
}
