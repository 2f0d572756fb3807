//! Summary of a plan: excitation, runs and cost, for people and as JSON.

use frfid_experiment::Cost;
use frfid_signals::format::{count, significant};
use frfid_signals::{Excitation, Phasing, Plan, SignalError};
use serde_json::{Value, json};

use crate::text::table::{bytes, duration, list};

/// Excitation, runs and cost of a plan.
pub(crate) fn plan_as_text(plan: &Plan) -> Result<String, SignalError> {
    let cost = Cost::of(plan)?;
    let mut entries = plan.excitation.waveform().described(plan.sample_time_s);
    let lead_in_s = significant(lead_in_s(plan), 6);
    let periods = count(plan.n_periods, "period");
    let ramps = ramps(plan);
    entries.push((
        "each run",
        format!("lead-in {lead_in_s} s, {periods}{ramps}"),
    ));
    entries.push(("runs", format!("{}: {}", cost.n_runs, runs(plan))));
    entries.push(("time on the robot", duration(cost.robot_time_s)));
    entries.extend(all_at_once(plan)?.map(|time_s| ("  all axes at once", duration(time_s))));
    entries.push(("memory for each job", bytes(cost.memory_bytes)));
    entries.push(("disk space at most", bytes(cost.disk_bytes)));
    Ok(list(&entries))
}

/// Time on the robot in s with one experiment for all inputs, where the excitation can be that.
fn all_at_once(plan: &Plan) -> Result<Option<f64>, SignalError> {
    let is_multisine = matches!(plan.excitation, Excitation::Multisine(_));
    if !is_multisine || plan.n_experiments() == 1 {
        return Ok(None);
    }
    let plan = Plan {
        phasing: Phasing::AllAtOnce,
        ..plan.clone()
    };
    plan.robot_time_s().map(Some)
}

/// The same as [`plan_as_text`] for machines.
pub(crate) fn plan_as_json(plan: &Plan) -> Result<Value, SignalError> {
    let cost = Cost::of(plan)?;
    let period_s = plan.period_samples()? as f64 * plan.sample_time_s;
    let waveform = plan.excitation.waveform();
    let [low_hz, high_hz] = waveform.band_hz();
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
        "lead_in_s": lead_in_s(plan),
        "ramp_s": ramp_s(plan),
        "n_runs": cost.n_runs,
        "run_samples": cost.run_samples,
        "robot_time_s": cost.robot_time_s,
        "robot_time_all_at_once_s": all_at_once(plan)?,
        "memory_bytes": cost.memory_bytes,
        "disk_bytes": cost.disk_bytes,
    });
    value["excitation"] = waveform.name().into();
    for (key, fact) in waveform.facts() {
        value[key] = json!(fact);
    }
    Ok(value)
}

fn lead_in_s(plan: &Plan) -> f64 {
    plan.lead_in_samples as f64 * plan.sample_time_s
}

fn ramp_s(plan: &Plan) -> f64 {
    plan.ramp_samples as f64 * plan.sample_time_s
}

/// The ramps of a run, where it has some.
fn ramps(plan: &Plan) -> String {
    if plan.ramp_samples == 0 {
        return String::new();
    }
    format!(", ramps of {} s", significant(ramp_s(plan), 6))
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
