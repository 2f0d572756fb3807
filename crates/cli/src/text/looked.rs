//! File that was looked into: a result, a plan, a log of ours or a recording, as text and as JSON.

use std::path::Path;

use frfid_experiment::{ExperimentError, GuessedMap, Inspection, Outcome, inspect_recording};
use frfid_files::{
    FileError, FileKind, PlanFile, ResultFile, RunLabel, path_text, read_result, read_run_label,
};
use serde_json::{Value, json};

use crate::text::checks::checks_as_text;
use crate::text::inspection::inspection_as_text;
use crate::text::summary::summary;
use crate::text::table::{indented, list};
use crate::text::verdicts::verdicts_as_text;

/// What a file is.
pub(crate) enum Looked {
    Result(Box<ResultFile>),
    Plan(Box<PlanFile>),
    OurLog(Box<RunLabel>),
    Recording(Box<Inspection>),
}

impl Looked {
    /// Looks into a file.
    ///
    /// # Errors
    /// [`ExperimentError`] of what can be none of these.
    pub(crate) fn of(path: &Path) -> Result<Self, ExperimentError> {
        let looked = match FileKind::of(path).map_err(FileError::cannot("open", path))? {
            FileKind::Result => Self::Result(Box::new(read_result(path)?)),
            FileKind::Plan => Self::Plan(Box::new(PlanFile::open(path)?)),
            FileKind::Run => Self::OurLog(Box::new(read_run_label(path)?)),
            _ => Self::Recording(Box::new(inspect_recording(path)?)),
        };
        Ok(looked)
    }

    pub(crate) fn is_log(&self) -> bool {
        matches!(self, Self::OurLog(_) | Self::Recording(_))
    }

    pub(crate) fn guessed(&self) -> Option<&GuessedMap> {
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

    pub(crate) fn as_text(&self, path: &Path) -> String {
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

    pub(crate) fn as_json(&self, path: &Path) -> Value {
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
        json!({"file": path_text(path), "kind": self.kind(), "found": facts})
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
pub(crate) fn estimate_as_text(estimate: &Result<Outcome, String>) -> String {
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
