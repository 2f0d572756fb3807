//! `frfid estimate`: from logs to an FRF with its uncertainty and checks.

use std::path::{Path, PathBuf};

use clap::Args;
use frfid_estimate::Method;
use frfid_experiment::{Average, EstimateOptions, EstimateTable, Outcome, estimate_logs};
use frfid_files::{ResultFile, write_bytes, write_result};
use frfid_report::result_page;
use frfid_signals::format::significant;
use frfid_signals::{Frf, Uncertainty};
use ndarray::Array3;
use serde_json::{Value, json};

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::log_map::MapOptions;
use crate::options::{Options, existing_path, named};
use crate::progress::watched;
use crate::text::checks::{checks_as_text, warn_of_failed};
use crate::text::strength::strength_as_text;
use crate::text::table::list;

/// Estimate the FRF from logs, with variances and checks
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid estimate logs -o frf.json --report frf.html
  frfid estimate logs -o frf2.json --average spectra
  frfid estimate robot.mcap -o frf.json --u '/joint_states:effort[elbow]=N m' \\
      --y '/joint_states:velocity[elbow]=rad/s' --r '/joint_commands:effort[elbow]=N m'
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
    #[command(flatten)]
    estimator: EstimatorOptions,
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
    /// Number of frequencies at which a chirp is evaluated
    #[arg(long, value_name = "N")]
    n_frequencies: Option<usize>,
}

impl EstimatorOptions {
    fn table(&self) -> Option<EstimateTable> {
        let given = self.method.is_some()
            || self.average.is_some()
            || self.indirect
            || self.n_frequencies.is_some();
        let default = EstimateTable::default();
        given.then(|| EstimateTable {
            method: self.method,
            average: self.average.unwrap_or(default.average),
            indirect: self.indirect,
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
    for output in [Some(&arguments.output), arguments.report.as_ref()]
        .into_iter()
        .flatten()
    {
        options.check_free(output)?;
    }
    let settings = EstimateOptions {
        estimate: arguments.estimator.table(),
        map: arguments.map.log_map()?,
        jobs: arguments.jobs,
    };
    let estimate = watched(console, "reading", "logs", |progress| {
        estimate_logs(&arguments.logs, &settings, progress)
    })?;
    write_result(&arguments.output, options.overwrite(), &estimate.result)?;
    if let Some(path) = &arguments.report {
        write_report(path, &arguments.output, &estimate, options)?;
    }
    tell(arguments, &estimate, options, console)?;
    let passed = estimate.result.checks.iter().all(|check| check.passed);
    Ok(Exit::flawed_unless(passed && !estimate.is_lossy))
}

/// Writes the report, under the name of the result.
fn write_report(
    path: &Path,
    result: &Path,
    estimate: &Outcome,
    options: &Options,
) -> Result<(), Failure> {
    let title = result.file_stem().unwrap_or_default().to_string_lossy();
    let page = result_page(&title, &estimate.result, estimate.warnings.clone())?;
    Ok(write_bytes(path, options.overwrite(), page.as_bytes())?)
}

fn tell(
    arguments: &Arguments,
    estimate: &Outcome,
    options: &Options,
    console: &mut Console,
) -> Result<(), Failure> {
    for warning in &estimate.warnings {
        console.warning(warning);
    }
    warn_of_failed(&estimate.result.checks, console);
    let output = arguments.output.display();
    if options.json {
        return console.json(&as_json(arguments, estimate));
    }
    let strength = strength_as_text(estimate.strength.as_ref());
    let checks = checks_as_text(&estimate.result.checks);
    console.data(&format!(
        "{output}\n{}{strength}\n{checks}",
        summary(&estimate.result)
    ))?;
    if let Some(report) = &arguments.report {
        console.note(format_args!("report in {}", report.display()));
    }
    console.hint(format_args!(
        "frfid export {output} --to csv -o frf.csv, or frfid compare {output} OTHER.json"
    ));
    Ok(())
}

fn summary(result: &ResultFile) -> String {
    let frf = &result.frf;
    let noise = known(
        result,
        frf.noise.as_ref(),
        frf.noise_variance(),
        "two periods",
    );
    let total = known(
        result,
        frf.total.as_ref(),
        frf.total_variance(),
        "two realizations",
    );
    list(&[
        (
            "inputs",
            with_units(&result.input_names, &result.input_units),
        ),
        (
            "outputs",
            with_units(&result.output_names, &result.output_units),
        ),
        ("frequencies", frequencies(frf)),
        ("noise", noise),
        ("noise and nonlinear", total),
    ])
}

/// Names with their units.
fn with_units(names: &[String], units: &[String]) -> String {
    let named = names.iter().zip(units);
    let named: Vec<String> = named
        .map(|(name, unit)| format!("{name} ({unit})"))
        .collect();
    named.join(", ")
}

/// How many frequencies there are, and from where to where.
fn frequencies(frf: &Frf) -> String {
    let n = frf.n_frequencies();
    match (frf.frequency_hz.first(), frf.frequency_hz.last()) {
        (Some(low), Some(high)) => {
            let (low, high) = (significant(*low, 5), significant(*high, 5));
            format!("{n}, {low} to {high} Hz")
        }
        _ => n.to_string(),
    }
}

/// The median relative standard deviation of the averaged FRF, or what it takes to know it.
fn known(
    result: &ResultFile,
    uncertainty: Option<&Uncertainty>,
    variance: Option<Array3<f64>>,
    needed: &str,
) -> String {
    let (Some(uncertainty), Some(variance)) = (uncertainty, variance) else {
        return format!("not available: it takes at least {needed}");
    };
    let degrees = uncertainty.degrees_of_freedom;
    match relative_deviation(result, &variance) {
        Some(deviation) => {
            format!(
                "{} % of |G| (median), {degrees} degrees of freedom",
                significant(100.0 * deviation, 2)
            )
        }
        None => format!("not a number, {degrees} degrees of freedom"),
    }
}

/// Median of standard deviation over magnitude, over all entries and frequencies.
fn relative_deviation(result: &ResultFile, variance: &Array3<f64>) -> Option<f64> {
    let both = variance.iter().zip(&result.frf.response);
    let mut ratios: Vec<f64> = both
        .map(|(variance, g)| variance.sqrt() / g.norm())
        .filter(|x| x.is_finite())
        .collect();
    ratios.sort_by(f64::total_cmp);
    ratios.get(ratios.len() / 2).copied()
}

fn as_json(arguments: &Arguments, estimate: &Outcome) -> Value {
    let (result, frf) = (&estimate.result, &estimate.result.frf);
    json!({
        "output": arguments.output,
        "report": arguments.report,
        "inputs": result.input_names,
        "outputs": result.output_names,
        "n_frequencies": frf.n_frequencies(),
        "low_hz": frf.frequency_hz.first(),
        "high_hz": frf.frequency_hz.last(),
        "noise": known_as_json(result, frf.noise.as_ref(), frf.noise_variance()),
        "total": known_as_json(result, frf.total.as_ref(), frf.total_variance()),
        "checks": result.checks,
        "strength": estimate.strength,
        "warnings": estimate.warnings,
        "is_lossy": estimate.is_lossy,
    })
}

fn known_as_json(
    result: &ResultFile,
    uncertainty: Option<&Uncertainty>,
    variance: Option<Array3<f64>>,
) -> Option<Value> {
    let (uncertainty, variance) = (uncertainty?, variance?);
    Some(json!({
        "degrees_of_freedom": uncertainty.degrees_of_freedom,
        "median_relative_deviation": relative_deviation(result, &variance),
    }))
}
