//! Report of a shaping, `shape.json` in its folder. No clock and no machine in it: the same runs
//! give the same bytes.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::Path;

use frfid_estimate::{Estimate, Iteration, OctaveError, ShapeOptions, ShapePeaks, Shaped, Target};
use frfid_files::{Check, FileError};
use serde::{Deserialize, Serialize};

use crate::experiment::Experiment;
use crate::shape::in_words::{code, in_words, per_axis};

/// Name of the file in the folder of a shaping.
pub(crate) const FILE: &str = "shape.json";
/// What to do where a folder does not hold what it should.
pub(crate) const ANOTHER_FOLDER: &str =
    "choose another folder, or say that it may be replaced (--force, in Python overwrite=True)";

const FORMAT: &str = "frfid-shape";
const VERSION: u32 = 1;

/// A shaping, finished or under way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShapeReport {
    /// `frfid-shape`.
    pub format: String,
    /// Version of the layout.
    pub version: u32,
    /// Version of frfid that wrote it.
    pub frfid_version: String,
    /// SHA-256 of the description.
    pub config_sha256: String,
    /// Joint of every axis.
    pub joint_names: Vec<String>,
    /// The signal that is to follow the desired one: torque or velocity.
    pub target: String,
    /// Most iterations.
    pub n_iterations: usize,
    /// Relative error that is good enough on every axis.
    pub good_enough: f64,
    /// Largest share of the sweep that an axis may be stuck.
    pub max_stuck_share: f64,
    /// Every iteration that was measured, in order.
    pub iterations: Vec<IterationReport>,
    /// Number of the best iteration, whose FRF is `frf.json`; `None` while the shaping is under
    /// way.
    pub best: Option<usize>,
    /// Why it ended: good-enough, sticking, rose-twice, all-iterations or watcher; `None` while it
    /// is under way.
    pub stop: Option<String>,
    /// The same in words.
    pub stop_reason: Option<String>,
    /// Where axes still stick in the best iteration, in words.
    pub sticking: Vec<String>,
    /// What was checked in the end.
    pub checks: Vec<Check>,
    /// SHA-256 of `frf.json`.
    pub frf_sha256: Option<String>,
}

/// One iteration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IterationReport {
    /// Number, from 1.
    pub number: usize,
    /// Relative error |U - U_des| / |U_des| of the target, rms over the band, over all axes; `None`
    /// if a run was stopped.
    pub error: Option<f64>,
    /// The same for each axis.
    pub axis_error: Option<Vec<f64>>,
    /// The same for each octave of the band; `None` in files of versions that did not tell it, too.
    #[serde(default)]
    pub octave_error: Option<Vec<OctaveError>>,
    /// Share of the sweep that each axis was stuck.
    pub stuck_share: Vec<f64>,
    /// Largest condition number of U; `None` if a run was stopped.
    pub condition: Option<f64>,
    /// Damping of the step that led here.
    pub damping: Option<f64>,
    /// Peaks predicted before the reference was applied.
    pub predicted: Option<ShapePeaks>,
    /// Peaks measured.
    pub peaks: ShapePeaks,
    /// Whether every run kept all limits to its end.
    pub within_limits: bool,
    /// What is worth saying.
    pub notes: Vec<String>,
    /// SHA-256 of every file of the iteration.
    pub files: BTreeMap<String, String>,
}

impl IterationReport {
    /// The numbers of an iteration; its files are added when they are written.
    #[must_use]
    pub fn of(iteration: &Iteration) -> Self {
        let estimate = iteration.estimate.as_ref();
        Self {
            number: iteration.number,
            error: iteration.error(),
            axis_error: estimate.map(|estimate| estimate.channel_error.clone()),
            octave_error: estimate.map(|estimate| estimate.octave_error.clone()),
            stuck_share: iteration.stuck_share.clone(),
            condition: estimate.map(worst_condition),
            damping: iteration.damping,
            predicted: iteration.predicted.as_ref().map(ShapePeaks::from),
            peaks: ShapePeaks::from(&iteration.peaks),
            within_limits: iteration.within_limits,
            notes: iteration.notes.iter().map(ToString::to_string).collect(),
            files: BTreeMap::new(),
        }
    }
}

fn worst_condition(estimate: &Estimate) -> f64 {
    estimate.condition.iter().copied().fold(1.0, f64::max)
}

impl ShapeReport {
    /// A shaping of which nothing has been measured yet.
    pub(crate) fn begun(experiment: &Experiment, options: &ShapeOptions) -> Self {
        Self {
            format: FORMAT.into(),
            version: VERSION,
            frfid_version: env!("CARGO_PKG_VERSION").into(),
            config_sha256: experiment.config_sha256(),
            joint_names: experiment.joint_names.clone(),
            target: match options.target {
                Target::Torque => "torque".into(),
                Target::Velocity => "velocity".into(),
            },
            n_iterations: options.n_iterations,
            good_enough: options.good_enough,
            max_stuck_share: options.max_stuck_share,
            iterations: Vec::new(),
            best: None,
            stop: None,
            stop_reason: None,
            sticking: Vec::new(),
            checks: Vec::new(),
            frf_sha256: None,
        }
    }

    /// Reads `folder/shape.json`; `None` where there is none.
    ///
    /// # Errors
    /// [`FileError::Io`], or [`FileError::Format`] for another kind of file.
    pub fn load(folder: &Path) -> Result<Option<Self>, FileError> {
        let path = folder.join(FILE);
        let Some(text) = read_if_there(&path)? else {
            return Ok(None);
        };
        let report = Self::of_json(&text).map_err(|found| {
            let needed = "a shaping written by frfid (JSON, frfid-shape version 1)";
            FileError::format(&path, found, needed, ANOTHER_FOLDER)
        })?;
        Ok(Some(report))
    }

    /// The report that the file holds, or what it holds instead.
    fn of_json(text: &[u8]) -> Result<Self, String> {
        let report: Self = serde_json::from_slice(text).map_err(|error| error.to_string())?;
        if (report.format.as_str(), report.version) != (FORMAT, VERSION) {
            return Err(format!("{} version {}", report.format, report.version));
        }
        Ok(report)
    }

    /// The report as it stands in the file.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self)
            .expect("a report is structs, lists, texts and numbers");
        text.push('\n');
        text
    }

    /// Whether the desired signal was reached without a flaw.
    #[must_use]
    pub fn is_good(&self) -> bool {
        self.stop.is_some() && self.checks.iter().all(|check| check.passed)
    }

    /// Takes the end of the shaping of a band up to `high_hz`; `condition` is the check of the best
    /// iteration's U.
    pub(crate) fn finish(&mut self, shaped: &Shaped, high_hz: f64, condition: Check) {
        self.best = Some(shaped.best.number);
        self.stop = Some(code(shaped.stop).into());
        self.stop_reason = Some(shaped.stop.to_string());
        let sticking = shaped.sticking.iter();
        self.sticking = sticking.map(|axis| in_words(axis, high_hz)).collect();
        self.checks = vec![
            self.follows(shaped),
            self.moves(shaped),
            self.kept_limits(),
            condition,
        ];
    }

    fn follows(&self, shaped: &Shaped) -> Check {
        let estimate = shaped.best.estimate.as_ref();
        let errors = estimate.map_or(&[][..], |estimate| &estimate.channel_error);
        let octaves = estimate.map_or(&[][..], |estimate| &estimate.octave_error);
        let worst = OctaveError::worst_in_words(octaves);
        let worst = worst.map_or(String::new(), |worst| format!(", {worst}"));
        Check {
            name: format!("{} as desired", self.target),
            passed: !errors.is_empty() && errors.iter().all(|&error| error <= self.good_enough),
            found: format!("off by {}{worst}", per_axis(errors)),
            needed: format!("{} % or less on every axis", 100.0 * self.good_enough),
            advice: "allow more iterations if the error still falls; if not, look at the notes: a limit held the steps back, or friction an axis"
                .into(),
        }
    }

    fn moves(&self, shaped: &Shaped) -> Check {
        Check {
            name: "no axis sticks".into(),
            passed: shaped.sticking.is_empty(),
            found: format!("stuck {} of the sweep", per_axis(&shaped.best.stuck_share)),
            needed: format!("{} % or less, and no band in which an axis mostly sticks", 100.0 * self.max_stuck_share),
            advice:
                "first let the torque become as desired; where it sticks even so, ask for more, well above the friction"
                    .into(),
        }
    }

    /// Numbers of the iterations that exceeded a limit.
    fn outside_limits(&self) -> Vec<String> {
        let iterations = self.iterations.iter();
        iterations
            .filter(|iteration| !iteration.within_limits)
            .map(|iteration| iteration.number.to_string())
            .collect()
    }

    fn kept_limits(&self) -> Check {
        let outside = self.outside_limits();
        Check {
            name: "limits".into(),
            passed: outside.is_empty(),
            found: if outside.is_empty() {
                "kept".into()
            } else {
                format!("exceeded in iteration {}", outside.join(", "))
            },
            needed: "kept by every run to its end".into(),
            advice: "raise the margin on predicted peaks ([shape] margin), or ask for less".into(),
        }
    }
}

/// What a file holds; `None` where there is none.
fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>, FileError> {
    match std::fs::read(path) {
        Ok(text) => Ok(Some(text)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(FileError::cannot("read", path)(error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_iteration_written_before_octaves_were_told_is_read() {
        let text = r#"{"number": 1, "error": 0.5, "axis_error": [0.5], "stuck_share": [0.1], "condition": 1.0,
            "damping": null, "predicted": null, "within_limits": true, "notes": [], "files": {},
            "peaks": {"torque_nm": [1.0], "velocity_rad_s": [1.0], "travel_rad": [1.0]}}"#;
        let before: IterationReport = serde_json::from_str(text).expect("as it was");
        assert_eq!(before.octave_error, None);
    }
}
