//! Summary of a plan: excitation, runs and cost, for people and as JSON.

use frfid_experiment::Cost;
use frfid_signals::{Excitation, Plan, SignalError};
use serde_json::{Value, json};

use crate::text::table::{bytes, count, duration, list, significant};

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
