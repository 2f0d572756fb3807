//! `frfid inspect`: what is in a file, and what would be made of it.

use std::path::{Path, PathBuf};

use clap::Args;
use frfid_experiment::{
    EstimateOptions, GuessedMap, Inspection, Outcome, Steps, estimate_logs, for_each,
    inspect_recording, recordings_among,
};
use frfid_files::{LogMap, PlanFile, ResultFile, RunLabel, read_result, read_run_label};
use serde_json::{Value, json};

use crate::command::estimate::summary;
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::log_map::MapOptions;
use crate::options::{Options, existing_path};
use crate::progress::watched;
use crate::text::checks::checks_as_text;
use crate::text::inspection::inspection_as_text;
use crate::text::table::list;
use crate::text::verdicts::verdicts_as_text;

/// Look into logs, plans and results: what is in them, a guessed log map, what an estimate would say
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid inspect robot.mcap
  frfid inspect bench.csv --map bench.toml      with the map that you wrote
  frfid inspect logs
  frfid inspect frf.json")]
pub(crate) struct Arguments {
    /// Recordings of any format, folders of them, plans, results
    #[arg(value_name = "FILES", required = true, value_parser = existing_path())]
    files: Vec<PathBuf>,
    #[command(flatten)]
    map: MapOptions,
}

/// What a file is.
enum Looked {
    Result(Box<ResultFile>),
    Plan(Box<PlanFile>),
    OurLog(Box<RunLabel>),
    Recording(Box<Inspection>),
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let stated = arguments.map.log_map()?;
    let files = recordings_among(&arguments.files)?;
    let (looked, estimate) = watched(console, "looking", "files", |progress| {
        let steps = Steps {
            progress,
            before: 0,
            total: files.len(),
        };
        let looked = for_each(&files, 1, steps, |path| Looked::of(path))?;
        let estimate = estimated(&files, &looked, stated.as_ref());
        Ok::<_, Failure>((looked, estimate))
    })?;
    let guessed = looked
        .iter()
        .find_map(Looked::guessed)
        .filter(|_| stated.is_none());
    if options.json {
        console.json(&as_json(&files, &looked, guessed, estimate.as_ref()))?;
        return Ok(Exit::Done);
    }
    for (path, looked) in files.iter().zip(&looked) {
        console.data(&looked.as_text(path))?;
    }
    if let Some(guessed) = guessed {
        console.data(&format!("log map\n{}", indented(&guessed.to_toml())))?;
    }
    if let Some(estimate) = &estimate {
        console.data(&estimate_as_text(estimate))?;
    }
    hint(&files, &looked, guessed.is_some(), console);
    Ok(Exit::Done)
}

/// The estimate that the files would give, or why there would be none; `None` of files that are no logs.
fn estimated(
    files: &[PathBuf],
    looked: &[Looked],
    stated: Option<&LogMap>,
) -> Option<Result<Outcome, String>> {
    let is_ours = looked
        .iter()
        .any(|looked| matches!(looked, Looked::OurLog(_)));
    let guessed = || {
        looked
            .iter()
            .find_map(Looked::guessed)
            .map(|guessed| guessed.map.clone())
    };
    let map = stated.cloned().or_else(guessed).filter(|_| !is_ours);
    let logs = files
        .iter()
        .zip(looked)
        .filter(|(_, looked)| looked.is_log());
    let logs: Vec<PathBuf> = logs.map(|(path, _)| path.clone()).collect();
    let is_possible = !logs.is_empty() && (is_ours || map.is_some());
    let options = EstimateOptions {
        map,
        ..EstimateOptions::default()
    };
    let outcome = || estimate_logs(&logs, &options, &|_, _| true);
    is_possible.then(|| outcome().map_err(|error| Failure::from(error).message))
}

impl Looked {
    fn of(path: &Path) -> Result<Self, frfid_experiment::ExperimentError> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        if ending == "json" {
            return Ok(Self::Result(Box::new(read_result(path)?)));
        }
        if path.is_file() {
            if let Ok(plan) = PlanFile::open(path) {
                return Ok(Self::Plan(Box::new(plan)));
            }
            if let Ok(label) = read_run_label(path) {
                return Ok(Self::OurLog(Box::new(label)));
            }
        }
        Ok(Self::Recording(Box::new(inspect_recording(path)?)))
    }

    fn is_log(&self) -> bool {
        matches!(self, Self::OurLog(_) | Self::Recording(_))
    }

    fn guessed(&self) -> Option<&GuessedMap> {
        match self {
            Self::Recording(inspection) => inspection.map.as_ref(),
            _ => None,
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Result(_) => "result",
            Self::Plan(_) => "plan",
            Self::OurLog(_) => "log",
            Self::Recording(_) => "recording",
        }
    }

    fn as_text(&self, path: &Path) -> String {
        let name = path.display();
        match self {
            Self::Result(result) => {
                let verdicts = verdicts_as_text(&result.verdicts);
                let checks = checks_as_text(&result.checks);
                format!(
                    "{name}: a result\n{}{verdicts}\n{checks}",
                    list(&summary(result))
                )
            }
            Self::Plan(plan) => format!("{name}: a plan\n{}", list(&plan_facts(plan))),
            Self::OurLog(label) => format!("{name}: a log of frfid, run {}\n", label.run),
            Self::Recording(inspection) => format!("{name}: {}", inspection_as_text(inspection)),
        }
    }

    fn as_json(&self, path: &Path) -> Value {
        let facts = match self {
            Self::Result(result) => json!({
                "inputs": result.input_names,
                "outputs": result.output_names,
                "n_frequencies": result.frf.n_frequencies(),
                "verdicts": result.verdicts,
                "checks": result.checks,
                "provenance": result.provenance,
            }),
            Self::Plan(plan) => {
                let facts = plan_facts(plan).into_iter();
                facts
                    .map(|(name, fact)| (name.to_owned(), Value::from(fact)))
                    .collect()
            }
            Self::OurLog(label) => json!({
                "run": label.run.to_string(),
                "sample_time_s": label.sample_time_s,
                "provenance": label.metadata,
            }),
            Self::Recording(inspection) => json!(inspection),
        };
        json!({"file": path, "kind": self.kind(), "found": facts})
    }
}

fn plan_facts(plan: &PlanFile) -> Vec<(&'static str, String)> {
    let head = &plan.head;
    let period_s = head.period_samples as f64 * head.sample_time_s;
    vec![
        ("joints", head.joint_names.join(", ")),
        ("sample time", format!("{} s", head.sample_time_s)),
        ("runs", plan.run_ids().count().to_string()),
        (
            "each run",
            format!("{} periods of {period_s} s", head.n_periods),
        ),
    ]
}

/// What an estimate would say.
fn estimate_as_text(estimate: &Result<Outcome, String>) -> String {
    let outcome = match estimate {
        Ok(outcome) => outcome,
        Err(message) => return format!("an estimate would refuse them\n{}", indented(message)),
    };
    let result = &outcome.result;
    let found = list(
        &found(result)
            .into_iter()
            .chain(summary(result))
            .collect::<Vec<_>>(),
    );
    let warnings: Vec<String> = outcome
        .warnings
        .iter()
        .map(|warning| format!("! {warning}"))
        .collect();
    let warnings = indented(&warnings.join("\n"));
    let verdicts = verdicts_as_text(&result.verdicts);
    let checks = checks_as_text(&result.checks);
    format!("an estimate would find\n{found}{warnings}{verdicts}\n{checks}")
}

/// What was found in recordings of others.
fn found(result: &ResultFile) -> Vec<(&'static str, String)> {
    let fact = |key: &str| result.provenance.get(key).cloned();
    let named = [
        ("runs", fact("runs_used")),
        ("whole periods", fact("periods_used")),
        (
            "period",
            fact("period_s").map(|period| format!("{period} s")),
        ),
        ("rms of inputs", fact("u_rms")),
    ];
    named
        .into_iter()
        .filter_map(|(name, fact)| Some((name, fact?)))
        .collect()
}

/// Every line two blanks in.
fn indented(text: &str) -> String {
    text.lines().map(|line| format!("  {line}\n")).collect()
}

/// The next command.
fn hint(files: &[PathBuf], looked: &[Looked], is_guessed: bool, console: &mut Console) {
    let names: Vec<String> = files
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    let names = if names.len() > 3 {
        format!("{} ...", names[0])
    } else {
        names.join(" ")
    };
    match looked.first() {
        Some(Looked::Recording(_)) if is_guessed => {
            console.hint(format_args!(
                "frfid init map {} -o map.toml, then frfid estimate {names} -o frf.json --map map.toml",
                files[0].display()
            ));
        }
        Some(Looked::Recording(_)) => {
            console.hint(format_args!(
                "frfid estimate {names} -o frf.json --u SIGNAL=UNIT --y SIGNAL=UNIT, with signals of the table above"
            ));
        }
        Some(Looked::OurLog(_)) => console.hint(format_args!("frfid estimate {names} -o frf.json")),
        Some(Looked::Plan(_)) => console.hint(format_args!("frfid run {names} -o logs")),
        Some(Looked::Result(_)) => console.hint(format_args!("frfid export {names} -o frf.csv")),
        None => {}
    }
}

fn as_json(
    files: &[PathBuf],
    looked: &[Looked],
    guessed: Option<&GuessedMap>,
    estimate: Option<&Result<Outcome, String>>,
) -> Value {
    let files = files
        .iter()
        .zip(looked)
        .map(|(path, looked)| looked.as_json(path));
    let estimate = estimate.map(|estimate| match estimate {
        Ok(Outcome {
            result, warnings, ..
        }) => json!({
            "n_frequencies": result.frf.n_frequencies(),
            "low_hz": result.frf.frequency_hz.first(),
            "high_hz": result.frf.frequency_hz.last(),
            "verdicts": result.verdicts,
            "checks": result.checks,
            "provenance": result.provenance,
            "warnings": warnings,
        }),
        Err(message) => json!({"refused": message}),
    });
    json!({
        "files": files.collect::<Vec<_>>(),
        "map": guessed.map(|guessed| &guessed.map),
        "map_toml": guessed.map(GuessedMap::to_toml),
        "estimate": estimate,
    })
}
