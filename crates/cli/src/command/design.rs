//! `frfid design`: the excitation of every run, inside the limits, as a plan file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use frfid_experiment::{
    ConfigError, Experiment, ExperimentError, PlannedRuns, Prediction, fading_advice, predict,
};
use frfid_signals::format::significant;
use frfid_signals::{Excess, Limit, Limits, Plan};
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check};
use crate::options::Options;
use crate::progress::watched;
use crate::text::load::load_as_text;
use crate::text::plan::{plan_as_json, plan_as_text};
use crate::text::signal::{NO_MODEL, signal_as_text};

/// Design the excitation of every run inside the limits, and write it as a plan
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid design experiment.toml -o plan.mcap
  frfid design experiment.toml --dry-run         what it would ask of the robot; nothing is written
  frfid design experiment.toml -o plan7.mcap --seed 7")]
pub(crate) struct Arguments {
    /// The description
    #[arg(value_name = "X.toml")]
    experiment: PathBuf,
    /// The plan to write
    #[arg(
        long,
        short,
        value_name = "PLAN.mcap",
        required_unless_present = "dry_run"
    )]
    output: Option<PathBuf>,
    /// Another seed than that of the description
    #[arg(long)]
    seed: Option<u64>,
    /// Only tell what would be asked of the robot
    #[arg(long)]
    dry_run: bool,
    /// Runs to simulate at once for the prediction; 0: one for each core
    #[arg(long, env = "FRFID_JOBS", default_value_t = 0)]
    jobs: usize,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    check(&arguments.experiment, Needed::Description)?;
    let experiment = with_seed(Experiment::load(&arguments.experiment)?, arguments.seed)?;
    warn(&experiment, console);
    let output = arguments.output.as_ref().filter(|_| !arguments.dry_run);
    output.map_or(Ok(()), |path| check_name(path, options))?;
    let exit = foretell(&experiment, arguments.jobs, options, console)?;
    if let Some(path) = output {
        write(&experiment, path, options, console)?;
    }
    Ok(exit)
}

/// Tells what the design asks of the robot or, without a model, what its signal is, and refuses what
/// exceeds a limit.
fn foretell(
    experiment: &Experiment,
    jobs: usize,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    if experiment.robot().is_none() {
        return foretell_signal(experiment, jobs, options, console);
    }
    let prediction = predicted(experiment, jobs, console)?;
    tell(experiment, &prediction, options, console)?;
    if let Some(error) = outside(experiment, &prediction) {
        return Err(error.into());
    }
    let doubts = doubts(&prediction);
    console.warnings(&doubts);
    Ok(Exit::flawed_unless(doubts.is_empty()))
}

/// The same without a model.
fn foretell_signal(
    experiment: &Experiment,
    jobs: usize,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let planned = PlannedRuns::of(experiment.clone());
    let peaks = watched(console, "designing", "runs", |progress| {
        planned.signal_peaks(jobs, progress)
    })?;
    console.note(NO_MODEL);
    if options.json {
        let limits: BTreeMap<_, _> = experiment.signal_limits().collect();
        let plan = plan_as_json(experiment.plan())?;
        console.json(&json!({ "plan": plan, "signal": peaks, "limits": limits }))?;
    } else {
        let (plan, signal) = (
            plan_as_text(experiment.plan())?,
            signal_as_text(experiment, &peaks),
        );
        console.data(&format!("{plan}\n{signal}"))?;
    }
    experiment.check_signal(&peaks)?;
    Ok(Exit::Done)
}

/// Refuses an output that exists, or whose name says something else than what is written.
fn check_name(path: &Path, options: &Options) -> Result<(), Failure> {
    if path.extension().is_some_and(|ending| ending == "mcap") {
        return Ok(options.check_free(path)?);
    }
    let path = path.display();
    Err(Failure::usage(format!(
        "{path}: a plan is an MCAP, needed a name that ends in .mcap"
    )))
}

/// What the plan will ask of the robot, run by run.
pub(crate) fn predicted(
    experiment: &Experiment,
    jobs: usize,
    console: &mut Console,
) -> Result<Prediction, ExperimentError> {
    watched(console, "predicting", "runs", |progress| {
        predict(experiment, jobs, progress)
    })
}

fn write(
    experiment: &Experiment,
    path: &Path,
    options: &Options,
    console: &mut Console,
) -> Result<(), Failure> {
    watched(console, "writing", "runs", |progress| {
        PlannedRuns::of(experiment.clone()).write(path, options.overwrite(), progress)
    })?;
    console.wrote(path);
    if experiment.robot().is_some() {
        console.hint(format_args!("frfid run {} -o logs", path.display()));
    }
    Ok(())
}

/// The experiment with another seed, where one is given.
pub(crate) fn with_seed(
    experiment: Experiment,
    seed: Option<u64>,
) -> Result<Experiment, ConfigError> {
    match seed {
        Some(seed) => experiment.with(|config| config.seed = seed),
        None => Ok(experiment),
    }
}

/// Tells what looks like a mistake in the description.
pub(crate) fn warn(experiment: &Experiment, console: &mut Console) {
    console.warnings(experiment.warnings());
}

/// Tells what the design is and what it will ask of the robot.
pub(crate) fn tell(
    experiment: &Experiment,
    prediction: &Prediction,
    options: &Options,
    console: &mut Console,
) -> Result<(), Failure> {
    let (plan, limits) = (experiment.plan(), experiment.limits());
    if options.json {
        let (plan, limits) = (plan_as_json(plan)?, by_key(limits));
        return console.json(&json!({ "plan": plan, "prediction": prediction, "limits": limits }));
    }
    let crest = prediction.crest_factor.iter();
    let crest = crest.map(|crest| significant(*crest, 4)).collect();
    let others = [("torque, crest factor", crest)];
    let peaks = load_as_text("predicted", &prediction.load, limits, &others);
    console.data(&format!("{}\n{peaks}", plan_as_text(plan)?))
}

/// Every limit by its key, those that are not given as nothing.
fn by_key(limits: &Limits) -> BTreeMap<&'static str, Option<&[f64]>> {
    Limit::ALL
        .iter()
        .map(|&limit| (limit.key(), limits.get(limit)))
        .collect()
}

/// The limit that binds most, if any is exceeded, at its place in the description.
fn outside(experiment: &Experiment, prediction: &Prediction) -> Option<ConfigError> {
    let worst = prediction.binding()?;
    let (axis, unit) = (worst.axis + 1, worst.limit.unit());
    let (found, allowed) = (significant(worst.found, 4), significant(worst.allowed, 4));
    let owner = experiment.limit_owner(worst);
    let advice = advice(experiment, prediction, worst);
    let message =
        format!("axis {axis} would reach {found} {unit}, {owner} is {allowed} {unit}; {advice}");
    Some(experiment.error_at_limit(worst, message))
}

/// What the plan will fail by: a velocity that turns round, and friction with it; a reference that a machine
/// cannot play from rest.
fn doubts(prediction: &Prediction) -> Vec<String> {
    let axes = prediction
        .strength
        .iter()
        .flat_map(|strength| &strength.axes);
    let turns = axes
        .enumerate()
        .filter(|(_, axis)| axis.crosses_zero == Some(true));
    let turning = turns.map(|(axis, _)| {
        format!(
            "the velocity of axis {} changes its sign, and its friction with it: raise the constant velocity, \
             or lower the excitation",
            axis + 1
        )
    });
    let played = prediction.played.iter().map(|excess| {
        format!(
            "played from rest to rest, {excess}: no machine is sent such a run; shorten the way or raise the limit"
        )
    });
    turning.chain(played).collect()
}

/// What to do about the limit that binds most.
fn advice(experiment: &Experiment, prediction: &Prediction, worst: &Excess) -> String {
    // rounded down, so that the advice is inside the limit
    let factor = (prediction.feasible_factor().unwrap_or(1.0) * 1000.0).floor() / 1000.0;
    if factor > 0.0 {
        let plan = experiment.plan();
        let smaller = smaller_amplitudes(plan, factor);
        let fading = fading_advice(plan, worst.limit).map(|advice| format!("; {advice}"));
        return smaller + &fading.unwrap_or_default();
    }
    let without = significant(prediction.without_excitation(worst), 4);
    let slower = if glides(experiment.plan()) {
        "lower the constant velocity, shorten lead-in or periods, "
    } else {
        "choose another pose, "
    };
    format!(
        "no amplitude is left: without any excitation it is {without} already; {slower}or raise the limit"
    )
}

/// Whether an axis moves at a constant velocity.
fn glides(plan: &Plan) -> bool {
    plan.velocity_rad_s.iter().any(|velocity| *velocity != 0.0)
}

fn smaller_amplitudes(plan: &Plan, factor: f64) -> String {
    let peaks = plan.excitation.waveform().peaks();
    let smaller = peaks.iter().map(|peak| significant(factor * peak, 3));
    let smaller = smaller.collect::<Vec<_>>().join(", ");
    let (factor, unit) = (significant(factor, 3), plan.injection.unit());
    format!("multiply the amplitudes by {factor} or less (to {smaller} {unit}), or raise the limit")
}
