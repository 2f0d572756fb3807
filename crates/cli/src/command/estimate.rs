//! `frfid estimate`: from logs to an FRF with its uncertainty and checks.

use std::path::{Path, PathBuf};

use clap::Args;
use frfid_estimate::{Entry, Method, Response};
use frfid_experiment::{
    Average, EstimateOptions, EstimateTable, Outcome, estimate_logs, recordings_among,
};
use frfid_files::{path_text, write_bytes, write_result};
use frfid_report::result_page;
use serde_json::{Value, json};

use crate::command::import::{Import, imported};
use crate::command::report::name;
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check_all};
use crate::interrupt;
use crate::log_map::MapOptions;
use crate::memory::MemoryOption;
use crate::options::{Options, existing_path, named};
use crate::progress::watched;
use crate::text::checks::{checks_as_text, warn_of_failed};
use crate::text::strength::strength_as_text;
use crate::text::summary::{Spread, summary};
use crate::text::table::list;
use crate::text::verdicts::verdicts_as_text;

/// Estimate the FRF from logs, with variances and checks
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid estimate logs -o frf.json --report frf.html
  frfid estimate logs -o frf2.json --average spectra
  frfid estimate robot.mcap -o frf.json --u '/joint_states:effort[elbow]=N m' \\
      --y '/joint_states:velocity[elbow]=rad/s' --r '/joint_commands:effort[elbow]=N m'
  frfid estimate campaign.mcap --plan plan.mcap --map map.toml -o frf.json    a plan that was played elsewhere
  frfid estimate bench.csv -o frf.json --u current=A --y speed=rad/s --time t=s")]
pub(crate) struct Arguments {
    /// Logs, or folders of them; of foreign recordings one for each experiment, in their order
    #[arg(value_name = "LOGS", required = true, value_parser = existing_path())]
    logs: Vec<PathBuf>,
    /// The result to write
    #[arg(long, short, value_name = "RESULT.json")]
    output: PathBuf,
    /// Write a report for the browser, too
    #[arg(long, value_name = "REPORT.html")]
    report: Option<PathBuf>,
    /// Files to read at once; 0: one for each core
    #[arg(long, env = "FRFID_JOBS", default_value_t = 0)]
    jobs: usize,
    /// The plan that was played: its runs are recognised in the recordings and kept beside the result, in
    /// RESULT-logs, as frfid import does
    #[arg(long, value_name = "X.toml|PLAN.mcap", value_parser = existing_path())]
    plan: Option<PathBuf>,
    #[command(flatten)]
    estimator: EstimatorOptions,
    #[command(flatten)]
    memory: MemoryOption,
    #[command(flatten)]
    map: MapOptions,
}

/// Any of these replaces the whole `[estimate]` table of the experiment.
#[derive(Debug, Args)]
#[command(next_help_heading = "Estimator, in place of the experiment's [estimate] table")]
struct EstimatorOptions {
    /// How spectra become an FRF
    #[arg(long, value_parser = named::<Method>(), conflicts_with_all = ["average", "indirect"])]
    method: Option<Method>,
    /// What is averaged over periods
    #[arg(long, value_parser = named::<Average>())]
    average: Option<Average>,
    /// Estimate through the reference, which noise on the input does not bias
    #[arg(long)]
    indirect: bool,
    /// Which response of the loop is estimated
    #[arg(long, value_parser = named::<Response>())]
    response: Option<Response>,
    /// Where the reference enters the loop
    #[arg(long = "loop", value_parser = named::<Entry>())]
    entry: Option<Entry>,
    /// Take Coulomb friction, found in the runs, off their torque: without a constant velocity
    #[arg(long)]
    subtract_friction: bool,
    /// Lines to either side of a frequency that local models look at; chosen frequency by frequency without
    #[arg(long, value_name = "LINES")]
    half_width: Option<usize>,
    /// Number of frequencies at which a chirp, or a recording in which nothing repeats, is evaluated
    #[arg(long, value_name = "N")]
    n_frequencies: Option<usize>,
}

impl EstimatorOptions {
    fn table(&self) -> Option<EstimateTable> {
        let given = self.method.is_some()
            || self.average.is_some()
            || self.indirect
            || self.response.is_some()
            || self.entry.is_some()
            || self.subtract_friction
            || self.half_width.is_some()
            || self.n_frequencies.is_some();
        let default = EstimateTable::default();
        given.then(|| EstimateTable {
            method: self.method,
            average: self.average,
            indirect: self.indirect,
            response: self.response,
            entry: self.entry,
            subtract_friction: self.subtract_friction,
            half_width: self.half_width,
            n_frequencies: self.n_frequencies.unwrap_or(default.n_frequencies),
            ..default
        })
    }
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    arguments.memory.apply();
    check_all(&arguments.logs, Needed::Logs)?;
    check_outputs(arguments, options)?;
    let mut settings = EstimateOptions {
        estimate: arguments.estimator.table(),
        map: arguments.map.log_map()?,
        jobs: arguments.jobs,
    };
    let (mut logs, mut is_complete) = (arguments.logs.clone(), true);
    if let Some(plan) = &arguments.plan {
        let folder = arguments.output.with_extension("").display().to_string() + "-logs";
        let import = Import {
            plan,
            folder: folder.as_ref(),
            rate_hz: None,
        };
        is_complete =
            imported(&arguments.logs, &import, &arguments.map, options, console)?.is_complete();
        (logs, settings.map) = (vec![folder.into()], None);
    }
    interrupt::ends_reading();
    let estimate = watched(console, "reading", "logs", |progress| {
        estimate_logs(&logs, &settings, progress)
    })?;
    interrupt::check()?;
    write_result(&arguments.output, options.overwrite(), &estimate.result)?;
    if let Some(path) = &arguments.report {
        write_report(path, &arguments.output, &estimate, options)?;
    }
    tell(arguments, &estimate, options, console)?;
    let passed = estimate.result.checks.iter().all(|check| check.passed);
    Ok(Exit::flawed_unless(
        passed && !estimate.is_lossy && is_complete,
    ))
}

/// Refuses outputs that exist, or that are read.
fn check_outputs(arguments: &Arguments, options: &Options) -> Result<(), Failure> {
    let logs = recordings_among(&arguments.logs)?;
    for output in std::iter::once(&arguments.output).chain(&arguments.report) {
        let others = arguments.plan.iter().chain(arguments.map.file());
        options.check_output(output, logs.iter().chain(others))?;
    }
    Ok(())
}

/// Writes the report, under the name of the result.
fn write_report(
    path: &Path,
    result: &Path,
    estimate: &Outcome,
    options: &Options,
) -> Result<(), Failure> {
    let page = result_page(&name(result), &estimate.result, estimate.warnings.clone())?;
    Ok(write_bytes(path, options.overwrite(), page.as_bytes())?)
}

fn tell(
    arguments: &Arguments,
    estimate: &Outcome,
    options: &Options,
    console: &mut Console,
) -> Result<(), Failure> {
    console.warnings(&estimate.warnings);
    warn_of_failed(&estimate.result.checks, console);
    let output = arguments.output.display();
    if options.json {
        return console.json(&as_json(arguments, estimate));
    }
    let strength = strength_as_text(estimate.strength.as_ref());
    let verdicts = verdicts_as_text(&estimate.result.verdicts);
    let checks = checks_as_text(&estimate.result.checks);
    console.data(&format!(
        "{output}\n{}{strength}{verdicts}\n{checks}",
        list(&summary(&estimate.result))
    ))?;
    if let Some(report) = &arguments.report {
        console.note(format_args!("report in {}", report.display()));
    }
    console.hint(format_args!(
        "frfid export {output} --to csv -o frf.csv, or frfid compare {output} OTHER.json"
    ));
    Ok(())
}

fn as_json(arguments: &Arguments, estimate: &Outcome) -> Value {
    let (result, frf) = (&estimate.result, &estimate.result.frf);
    let [noise, total] = Spread::noise_and_total(frf);
    json!({
        "output": path_text(&arguments.output),
        "report": arguments.report.as_ref().map(path_text),
        "inputs": result.input_names,
        "outputs": result.output_names,
        "n_frequencies": frf.n_frequencies(),
        "low_hz": frf.frequency_hz.first(),
        "high_hz": frf.frequency_hz.last(),
        "noise": noise,
        "total": total,
        "distortion": result.distortion,
        "verdicts": result.verdicts,
        "checks": result.checks,
        "strength": estimate.strength,
        "warnings": estimate.warnings,
        "is_lossy": estimate.is_lossy,
    })
}
