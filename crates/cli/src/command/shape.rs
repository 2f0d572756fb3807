//! `frfid shape`: the reference of a chirp in closed loop, shaped until the motor torque follows
//! what is desired.

use std::path::PathBuf;

use clap::Args;
use frfid_estimate::OctaveError;
use frfid_experiment::{
    Awaited, Experiment, ExperimentError, FilesTestbed, IterationReport, ShapeFolderOptions,
    ShapeReport, shape_to_folder,
};
use frfid_files::{LogMap, path_text};
use frfid_signals::Testbed;
use frfid_signals::format::significant;
use serde_json::json;

use crate::command::design::{warn, with_seed};
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check};
use crate::options::Options;
use crate::player::{PlayerOptions, machine};
use crate::progress::watched;
use crate::text::checks::{checks_as_text, warn_of_failed};
use crate::text::table::{or_dash, row, side_by_side, titled};

/// Shape the reference of a chirp in closed loop until the motor torque is as desired, with an
/// audit trail
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid shape experiment.toml -o shaped          goes on where an interrupted one stopped
  frfid shape experiment.toml -o shaped --player ./play.sh --map map.toml    on a machine
  frfid shape experiment.toml -o shaped --map map.toml    by files: writes what is to be played, goes on with the recordings
  frfid shape experiment.toml -o shaped --json
  frfid export shaped/frf.json --to csv -o frf.csv")]
pub(crate) struct Arguments {
    /// The description, with [controller], [chirp] and [shape]
    #[arg(value_name = "X.toml")]
    experiment: PathBuf,
    /// The folder for every reference, record, FRF and error; made if it does not exist
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// Runs at once; 0: one for each core. The files do not depend on it
    #[arg(long, env = "FRFID_JOBS", default_value_t = 0)]
    jobs: usize,
    /// Another seed than that of the description
    #[arg(long)]
    seed: Option<u64>,
    #[command(flatten)]
    player: PlayerOptions,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    check(&arguments.experiment, Needed::Description)?;
    let experiment = with_seed(Experiment::load(&arguments.experiment)?, arguments.seed)?;
    warn(&experiment, console);
    match arguments.player.map_alone()? {
        Some(map) => by_files(arguments, &experiment, &map, options, console),
        None => at_once(arguments, &experiment, options, console),
    }
}

/// Shapes in simulation, or on a machine behind a command.
fn at_once(
    arguments: &Arguments,
    experiment: &Experiment,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let player = arguments.player.command()?;
    let machine = player
        .as_ref()
        .map(|player| machine(experiment, player, &arguments.output));
    let machine = machine.transpose()?;
    let testbed = machine.as_ref().map(|machine| machine as &dyn Testbed);
    let report = shaped(arguments, experiment, testbed, options, console)?;
    tell(arguments, &report, options, console)?;
    Ok(Exit::flawed_unless(report.is_good()))
}

/// Shapes on a machine that is reached by files: goes as far as there are recordings.
fn by_files(
    arguments: &Arguments,
    experiment: &Experiment,
    map: &LogMap,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let (folder, rate_hz) = (&arguments.output, arguments.player.rate_hz());
    let machine = FilesTestbed::new(experiment, map, rate_hz, folder)?;
    match shaped(arguments, experiment, Some(&machine), options, console) {
        Ok(report) => {
            tell(arguments, &report, options, console)?;
            Ok(Exit::flawed_unless(report.is_good()))
        }
        Err(error) => match Awaited::of(&error) {
            Some(awaited) => {
                await_recordings(awaited, options, console)?;
                Ok(Exit::Done)
            }
            None => Err(error.into()),
        },
    }
}

/// Says what is to be played.
fn await_recordings(
    awaited: &Awaited,
    options: &Options,
    console: &mut Console,
) -> Result<(), Failure> {
    console.warnings(
        awaited
            .refused
            .iter()
            .map(|reason| format!("not used: {reason}")),
    );
    if options.json {
        let Awaited {
            references,
            recordings,
            ..
        } = awaited;
        return console.json(
            &json!({ "references": path_text(references), "recordings": path_text(recordings) }),
        );
    }
    let (references, recordings) = (awaited.references.display(), awaited.recordings.display());
    console.data(&format!(
        "to be played: the references in {references}\nrecordings of them: into {recordings}\n\
         then the same command again\n"
    ))
}

fn shaped(
    arguments: &Arguments,
    experiment: &Experiment,
    testbed: Option<&dyn Testbed>,
    options: &Options,
    console: &mut Console,
) -> Result<ShapeReport, ExperimentError> {
    let settings = ShapeFolderOptions {
        jobs: if testbed.is_some() { 1 } else { arguments.jobs },
        overwrite: options.overwrite(),
    };
    watched(console, "shaping", "runs", |progress| {
        shape_to_folder(experiment, testbed, &arguments.output, &settings, progress)
    })
}

fn tell(
    arguments: &Arguments,
    report: &ShapeReport,
    options: &Options,
    console: &mut Console,
) -> Result<(), Failure> {
    console.warnings(&report.sticking);
    warn_of_failed(&report.checks, console);
    let folder = arguments.output.display();
    if options.json {
        return console.json(&json!({ "output": path_text(&arguments.output), "shape": report }));
    }
    console.data(&format!("{folder}\n{}", as_text(report)))?;
    console.hint(format_args!(
        "frfid export {folder}/frf.json --to csv -o frf.csv, or frfid compare {folder}/frf.json OTHER.json"
    ));
    Ok(())
}

/// The iterations, how they ended, and what was checked.
fn as_text(report: &ShapeReport) -> String {
    let end = match (report.best, &report.stop_reason) {
        (Some(best), Some(reason)) => format!("  the best is iteration {best}; {reason}\n"),
        _ => String::new(),
    };
    let checks = checks_as_text(&report.checks);
    iterations(report) + &notes(report) + &end + &octaves(report) + &checks
}

/// The errors of the best iteration, a row for each octave.
fn octaves(report: &ShapeReport) -> String {
    let best = report
        .iterations
        .iter()
        .find(|iteration| Some(iteration.number) == report.best);
    let octaves = best
        .and_then(|best| best.octave_error.as_deref())
        .unwrap_or_default();
    let percent =
        |octave: &OctaveError| per_axis(octave.axis_error.iter().map(|error| 100.0 * error), 2);
    let mut rows = vec![row(["octave", "error in %"])];
    rows.extend(
        octaves
            .iter()
            .map(|octave| vec![octave.place(), percent(octave)]),
    );
    if octaves.is_empty() {
        String::new()
    } else {
        titled(&rows)
    }
}

/// A row for each iteration; where there are several axes, their values stand beside each other.
fn iterations(report: &ShapeReport) -> String {
    let title = [
        "iteration",
        "error in %",
        "worst octave in %",
        "stuck in %",
        "peak torque in N m",
        "damping",
    ];
    let mut rows = vec![row(title)];
    rows.extend(report.iterations.iter().map(row_of));
    titled(&rows)
}

fn row_of(iteration: &IterationReport) -> Vec<String> {
    let percent = |shares: &[f64]| per_axis(shares.iter().map(|share| 100.0 * share), 2);
    let error = iteration.axis_error.as_deref();
    vec![
        iteration.number.to_string(),
        error.map_or_else(|| "stopped".into(), percent),
        or_dash(iteration.octave_error.as_deref(), |octaves| {
            percent(&OctaveError::worst_of_axes(octaves))
        }),
        percent(&iteration.stuck_share),
        per_axis(iteration.peaks.torque_nm.iter().copied(), 3),
        or_dash(iteration.damping, |damping| significant(damping, 3)),
    ]
}

fn per_axis(values: impl Iterator<Item = f64>, digits: usize) -> String {
    let values = values.map(|value| significant(value, digits));
    side_by_side(&values.collect::<Vec<_>>())
}

fn notes(report: &ShapeReport) -> String {
    let mut text = String::new();
    for IterationReport { number, notes, .. } in &report.iterations {
        text.extend(
            notes
                .iter()
                .map(|note| format!("  iteration {number}: {note}\n")),
        );
    }
    text
}
