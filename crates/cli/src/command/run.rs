//! `frfid run`: the runs of a description or a plan in simulation or on a machine, one MCAP each.

use std::path::{Path, PathBuf};

use clap::Args;
use frfid_experiment::{
    Experiment, Load, PlannedRuns, PlayerCommand, RunOptions, RunSummary, Strength, run_to_folder,
};
use frfid_signals::format::{count, significant};
use frfid_signals::{Event, EventKind, Limits};
use serde_json::json;

use crate::command::design::{predicted, tell, warn, with_seed};
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check};
use crate::options::{Options, existing_path};
use crate::player::{PlayerOptions, machine};
use crate::progress::watched;
use crate::text::load::{excess_in_words, load_as_text};
use crate::text::strength::{share_as_text, strength_rows};

/// Do the runs of a description or a plan in simulation, one MCAP each; runs that are there already
/// are skipped
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid run plan.mcap -o logs
  frfid run experiment.toml -o logs --jobs 4            the same without a plan file
  frfid run plan.mcap -o logs --index $SLURM_ARRAY_TASK_ID    one run of a job array
  frfid run plan.mcap -o logs --player ./play.sh --map map.toml        on a machine, run by run
  frfid run plan.mcap --dry-run                         what it would ask of the robot; nothing is written")]
pub(crate) struct Arguments {
    /// A description, or a plan made from one
    #[arg(value_name = "X.toml|PLAN.mcap", value_parser = existing_path())]
    order: PathBuf,
    /// The folder for the logs; made if it does not exist
    #[arg(long, short, value_name = "LOGS", required_unless_present = "dry_run")]
    output: Option<PathBuf>,
    /// Runs at once; 0: one for each core. The logs do not depend on it
    #[arg(long, env = "FRFID_JOBS", default_value_t = 0)]
    jobs: usize,
    /// Only this run, from 0
    #[arg(long)]
    index: Option<usize>,
    /// Another seed than that of the description
    #[arg(long)]
    seed: Option<u64>,
    /// Only tell what would be asked of the robot
    #[arg(long)]
    dry_run: bool,
    #[command(flatten)]
    player: PlayerOptions,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    check(&arguments.order, Needed::Runs)?;
    let planned = planned_runs(&arguments.order, arguments.seed)?;
    warn(&planned.experiment, console);
    check_index(arguments.index, planned.run_ids().len())?;
    let Some(folder) = arguments.output.as_ref().filter(|_| !arguments.dry_run) else {
        let prediction = predicted(&planned.experiment, arguments.jobs, console)?;
        tell(&planned.experiment, &prediction, options, console)?;
        return Ok(Exit::Done);
    };
    let summary = done(arguments, &planned, folder, options, console)?;
    // a machine behind a player may be another than the model
    let is_simulated = arguments.player.command()?.is_none();
    let is_unstable = is_simulated && planned.experiment.instability().is_some();
    match report(&planned.experiment, &summary, folder, options, console)? {
        Exit::Done => Ok(Exit::flawed_unless(!is_unstable)),
        flawed => Ok(flawed),
    }
}

/// Does the runs, on a machine behind a command or in simulation.
fn done(
    arguments: &Arguments,
    planned: &PlannedRuns,
    folder: &Path,
    options: &Options,
    console: &mut Console,
) -> Result<RunSummary, Failure> {
    let settings = RunOptions {
        jobs: arguments.jobs,
        index: arguments.index,
        overwrite: options.overwrite(),
    };
    let Some(player) = arguments.player.command()? else {
        arguments.player.check_alone()?;
        planned.experiment.model()?;
        return Ok(watched(console, "simulating", "runs", |progress| {
            run_to_folder(planned, None, folder, &settings, progress)
        })?);
    };
    rehearse(planned, &player, arguments.jobs, console)?;
    let machine = machine(&planned.experiment, &player, folder)?;
    let one_by_one = RunOptions {
        jobs: 1,
        ..settings
    };
    Ok(watched(console, "playing", "runs", |progress| {
        run_to_folder(planned, Some(&machine), folder, &one_by_one, progress)
    })?)
}

/// Holds every reference against the limits before the first is sent.
fn rehearse(
    planned: &PlannedRuns,
    player: &PlayerCommand,
    jobs: usize,
    console: &mut Console,
) -> Result<(), Failure> {
    let player = planned.experiment.player(player.rate_hz);
    watched(console, "rehearsing", "references", |progress| {
        planned.rehearse(&player, jobs, progress)
    })?;
    Ok(())
}

/// The runs, with another seed where one is given; the references of a plan are drawn already.
fn planned_runs(path: &Path, seed: Option<u64>) -> Result<PlannedRuns, Failure> {
    let is_toml = path
        .extension()
        .is_some_and(|extension| extension == "toml");
    match seed {
        None => Ok(PlannedRuns::load(path)?),
        Some(_) if is_toml => Ok(PlannedRuns::of(with_seed(Experiment::load(path)?, seed)?)),
        Some(_) => Err(Failure::usage(format!(
            "--seed does not go with the plan {}: its references are drawn already; give --seed to frfid design",
            path.display()
        ))),
    }
}

fn check_index(index: Option<usize>, n_runs: usize) -> Result<(), Failure> {
    match index {
        Some(index) if index >= n_runs => Err(Failure::usage(format!(
            "--index is {index}, needed: 0 to {}, one of {}",
            n_runs - 1,
            count(n_runs, "run")
        ))),
        _ => Ok(()),
    }
}

/// Tells what the runs asked of the robot; a limit that was reached or a run that was stopped makes
/// them flawed.
fn report(
    experiment: &Experiment,
    summary: &RunSummary,
    folder: &Path,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let load = Load::largest(summary.written.iter().map(|run| run.load.clone()));
    let flaws = flaws(summary, load.as_ref(), experiment.limits());
    let strength = summary.strength.as_ref();
    let too_weak = strength.iter().flat_map(|strength| &strength.warnings);
    console.warnings(flaws.iter().chain(too_weak));
    if options.json {
        console.json(&json!(summary))?;
    } else {
        let table = load.map(|load| reached(summary, &load, experiment.limits()));
        tell_written(summary, folder, &table.unwrap_or_default(), console)?;
    }
    let crosses_zero = strength.is_some_and(Strength::crosses_zero);
    Ok(Exit::flawed_unless(flaws.is_empty() && !crosses_zero))
}

fn tell_written(
    summary: &RunSummary,
    folder: &Path,
    table: &str,
    console: &mut Console,
) -> Result<(), Failure> {
    let (written, skipped) = (count(summary.written.len(), "run"), summary.n_skipped);
    let folder = folder.display();
    console.data(&format!(
        "{folder}: {written} written, {skipped} there already\n{table}"
    ))?;
    console.hint(format_args!(
        "frfid estimate {folder} -o frf.json --report frf.html"
    ));
    Ok(())
}

/// Limits that were reached and runs that were stopped, now or before.
fn flaws(summary: &RunSummary, load: Option<&Load>, limits: &Limits) -> Vec<String> {
    let mut flaws = Vec::new();
    for run in &summary.written {
        let path = run.path.display();
        let events = run.events.iter();
        flaws.extend(events.map(|event| format!("{path}: {}", told(event))));
    }
    if let Some(load) = load {
        flaws.extend(limits.exceeded(&load.peaks).iter().map(excess_in_words));
    }
    flaws.extend(summary.stopped_before.iter().map(|path| stopped(path)));
    flaws
}

/// What is said of a run that an earlier command stopped.
fn stopped(path: &Path) -> String {
    let path = path.display();
    format!("{path}: was stopped before its end when it was done; --force does it again")
}

/// Table of what was reached beside the limits.
fn reached(summary: &RunSummary, load: &Load, limits: &Limits) -> String {
    let mut others = vec![("standing still", standing_still(summary))];
    others.extend(strength_rows(summary.strength.as_ref()));
    load_as_text("reached", load, limits, &others)
}

/// Share of the time in which friction held the joint, the largest of all runs that know it, one for
/// each axis.
fn standing_still(summary: &RunSummary) -> Vec<String> {
    let runs = &summary.written;
    let n_axes = runs.first().map_or(0, |run| run.standing_share.len());
    let share = |axis: usize| {
        let shares = runs.iter().filter_map(|run| *run.standing_share.get(axis)?);
        shares.reduce(f64::max)
    };
    (0..n_axes).map(|axis| share_as_text(share(axis))).collect()
}

/// An event in words.
fn told(event: &Event) -> String {
    let what = match &event.kind {
        EventKind::PeriodStart { period } => format!("period {period} begins"),
        EventKind::Limit {
            channel,
            limit,
            value,
            allowed,
        } => {
            let [value, allowed] = [value, allowed].map(|number| significant(*number, 4));
            let (axis, quantity, unit) = (channel + 1, limit.quantity(), limit.unit());
            format!("axis {axis} reached its limit: {quantity} {value} {unit}, allowed {allowed}")
        }
        EventKind::Stopped { reason, .. } => format!("stopped: {reason}"),
    };
    format!("at {} s {what}", significant(event.time_s, 5))
}
