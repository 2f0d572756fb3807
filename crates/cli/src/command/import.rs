//! `frfid import`: recordings of a plan that was played elsewhere, as runs of our own.

use std::path::{Path, PathBuf};

use clap::Args;
use frfid_experiment::{
    ImportOptions, ImportSummary, PlannedRuns, import_recordings, recordings_among,
};
use frfid_files::LogMap;
use frfid_signals::format::count;
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check, check_all};
use crate::log_map::MapOptions;
use crate::options::{Options, existing_path};
use crate::progress::watched;
use crate::text::table::{row, table};

/// Recognise the runs of a plan in recordings of it and write them as logs of our own
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid import campaign.mcap --plan plan.mcap --map map.toml -o logs
  frfid import measured/ --plan plan.mcap --map map.toml -o logs     a folder of CSVs, in any order
  frfid estimate logs -o frf.json                                    as with runs of our own")]
pub(crate) struct Arguments {
    /// Recordings, or folders of them: one of the whole campaign, or one of each run, in any order
    #[arg(value_name = "RECORDING", required = true, value_parser = existing_path())]
    recordings: Vec<PathBuf>,
    /// What was played
    #[arg(long, value_name = "X.toml|PLAN.mcap", value_parser = existing_path())]
    plan: PathBuf,
    /// Folder for the logs, one MCAP each
    #[arg(long, short, value_name = "LOGS")]
    output: PathBuf,
    /// Samples a second of the player, where it was not the plan's
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    #[command(flatten)]
    map: MapOptions,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let import = Import {
        plan: &arguments.plan,
        folder: &arguments.output,
        rate_hz: arguments.rate,
    };
    let summary = imported(
        &arguments.recordings,
        &import,
        &arguments.map,
        options,
        console,
    )?;
    tell(arguments, &summary, options, console)?;
    Ok(Exit::flawed_unless(summary.is_complete()))
}

/// Where to and of what.
pub(crate) struct Import<'a> {
    /// What was played.
    pub(crate) plan: &'a Path,
    /// Folder of the logs.
    pub(crate) folder: &'a Path,
    /// Samples a second of the player; the plan's without it.
    pub(crate) rate_hz: Option<f64>,
}

/// Imports, and warns of what looks wrong.
///
/// # Errors
/// [`Failure`] for input that does not fit, and those of importing.
pub(crate) fn imported(
    recordings: &[PathBuf],
    import: &Import,
    map: &MapOptions,
    options: &Options,
    console: &mut Console,
) -> Result<ImportSummary, Failure> {
    check(import.plan, Needed::Runs)?;
    check_all(recordings, Needed::Logs)?;
    let planned = PlannedRuns::load(import.plan)?;
    let map = needed_map(map)?;
    let recordings = recordings_among(recordings)?;
    let settings = ImportOptions {
        rate_hz: import.rate_hz,
        overwrite: options.overwrite(),
    };
    let folder = import.folder;
    let summary = watched(console, "importing", "recordings", |progress| {
        import_recordings(&planned, &recordings, &map, folder, &settings, progress)
    })?;
    console.warnings(summary.told());
    Ok(summary)
}

/// The log map, which recordings of others need.
///
/// # Errors
/// [`Failure`] where none is given.
fn needed_map(options: &MapOptions) -> Result<LogMap, Failure> {
    let advice = "which signal is which is not said; needed: a log map, --map or --u and --y; \
                  frfid init map RECORDING guesses one";
    options.log_map()?.ok_or_else(|| Failure::usage(advice))
}

fn tell(
    arguments: &Arguments,
    summary: &ImportSummary,
    options: &Options,
    console: &mut Console,
) -> Result<(), Failure> {
    if options.json {
        return console.json(&json!(summary));
    }
    let (imported, folder) = (
        count(summary.imported.len(), "run"),
        arguments.output.display(),
    );
    let n_skipped = summary.n_skipped;
    console.data(&format!(
        "{folder}: {imported} imported, {n_skipped} there already\n{}",
        imported_as_text(summary)
    ))?;
    console.hint(format_args!(
        "frfid estimate {folder} -o frf.json --report frf.html"
    ));
    Ok(())
}

/// A row for each run: where it was found, and how surely.
fn imported_as_text(summary: &ImportSummary) -> String {
    let head = row([
        "run",
        "recording",
        "at s",
        "clock ppm",
        "likeness",
        "next",
        "lost samples",
    ]);
    let of_run = |run: &frfid_experiment::ImportedRun| {
        let recording = run.recording.file_name().unwrap_or_default();
        vec![
            run.run.clone(),
            recording.to_string_lossy().into_owned(),
            format!("{:.4}", run.start_s),
            format!("{:.1}", run.clock_ppm),
            format!("{:.3}", run.likeness),
            format!("{:.3}", run.rival),
            run.n_lost.to_string(),
        ]
    };
    let rows: Vec<_> = [head]
        .into_iter()
        .chain(summary.imported.iter().map(of_run))
        .collect();
    table(&rows)
}
