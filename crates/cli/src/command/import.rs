//! `frfid import`: recordings of a plan that was played elsewhere, as runs of our own.

use std::path::PathBuf;

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
    check(&arguments.plan, Needed::Runs)?;
    check_all(&arguments.recordings, Needed::Logs)?;
    let planned = PlannedRuns::load(&arguments.plan)?;
    let map = needed_map(&arguments.map)?;
    let recordings = recordings_among(&arguments.recordings)?;
    let settings = ImportOptions {
        rate_hz: arguments.rate,
        overwrite: options.overwrite(),
    };
    let summary = watched(console, "importing", "recordings", |progress| {
        import_recordings(
            &planned,
            &recordings,
            &map,
            &arguments.output,
            &settings,
            progress,
        )
    })?;
    tell(arguments, &summary, options, console)?;
    Ok(Exit::flawed_unless(summary.is_complete()))
}

/// The log map, which recordings of others need.
///
/// # Errors
/// [`Failure`] where none is given.
pub(crate) fn needed_map(options: &MapOptions) -> Result<LogMap, Failure> {
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
    console.warnings(summary.told());
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
