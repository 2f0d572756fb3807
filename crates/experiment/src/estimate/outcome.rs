//! Outcome of an estimate: the FRF with its checks, what a careful reader should know besides, and
//! where it came from; the same whether the records came from files, from memory or from Python.

use std::path::PathBuf;

use frfid_estimate::NoiseBias;
use frfid_files::{Cause, Check, ResultFile, sha256_file};
use frfid_signals::format::count;
use frfid_signals::{Frf, Limit};

use crate::error::ExperimentError;
use crate::estimate::estimator::estimated::Estimated;
use crate::estimate::gather::Gathered;
use crate::estimate::unsettled::MOST_UNSETTLED;
use crate::estimate::verdicts::{Evidence, judge};
use crate::estimate::way::way;
use crate::experiment::Experiment;
use crate::run::load::Load;
use crate::run::provenance::Metadata;
use crate::run::strength::Strength;

/// Largest condition number of U that passes the check.
const GOOD_CONDITION: f64 = 20.0;

/// What was estimated, and what a careful reader should know besides.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// FRF, checks and provenance.
    pub result: ResultFile,
    /// Warnings, in words; empty if nothing was lost and nothing was odd.
    pub warnings: Vec<String>,
    /// Whether data was lost: then the estimate holds, but of less than was recorded.
    pub is_lossy: bool,
    /// How the axes were driven and moved; `None` for foreign recordings.
    pub strength: Option<Strength>,
    /// Largest values over all runs without a loss; `None` for foreign recordings.
    pub load: Option<Load>,
}

/// What is known of the records of a plan before they are looked at.
pub(crate) struct Inventory {
    /// Number of records.
    pub n_records: usize,
    /// Number of records of which something was lost.
    pub n_flawed: usize,
    /// What was lost, and what could not be used at all, in words.
    pub losses: Vec<String>,
}

/// What the runs say beside their spectra.
#[derive(Clone, Copy)]
struct Runs<'a> {
    load: Option<&'a Load>,
    strength: Option<&'a Strength>,
    clipped: &'a [f64],
}

impl Runs<'_> {
    fn evidence(&self, estimated: &Estimated) -> Evidence {
        Evidence {
            stuck: self.strength.map_or_else(Vec::new, Strength::stuck_shares),
            unsettled: estimated.unsettled.shares(),
            most_unsettled: MOST_UNSETTLED,
            clipped: self.clipped.to_vec(),
        }
    }
}

impl Experiment {
    /// What follows from gathered records, an outcome for each way of estimating.
    pub(crate) fn conclude(&self, gathered: Gathered, inventory: &Inventory) -> Vec<Outcome> {
        let runs = Runs {
            load: gathered.load.as_ref(),
            strength: gathered.strength.as_ref(),
            clipped: &gathered.clipped,
        };
        let estimated = gathered.estimated.into_iter();
        estimated
            .map(|estimated| self.outcome(estimated, runs, inventory))
            .collect()
    }

    fn outcome(&self, estimated: Estimated, runs: Runs, inventory: &Inventory) -> Outcome {
        let Runs { load, strength, .. } = runs;
        let complete = self.completeness(&estimated, inventory);
        let is_lossy = !complete.passed;
        let torques = load.map_or(&[][..], |load| &load.torque_rms_nm);
        let mut checks = vec![complete, condition_check(&estimated.frf, torques)];
        checks.extend(estimated.unsettled.check());
        checks.extend(left_out_check(estimated.n_left_out));
        checks.extend(noise_bias_check(estimated.noise_bias));
        checks.extend(strength.and_then(Strength::sign_check));
        let warnings = warnings(&estimated, strength, inventory);
        let evidence = runs.evidence(&estimated);
        let mut result = ResultFile {
            flagged: estimated.ripple,
            harmonics: estimated.harmonics,
            distortion: estimated.distortion,
            ..self.result(estimated.frf, load)
        };
        if let Some(response) = estimated.response {
            response.put_into(&mut result, &self.reference_names());
        }
        result.checks = checks;
        let causes = checked(&result.frf);
        judge(&mut result, &self.joint_names, &evidence, &causes);
        Outcome {
            result,
            warnings,
            is_lossy,
            strength: strength.cloned(),
            load: load.cloned(),
        }
    }

    /// Whether every run of the plan is there and whole.
    fn completeness(&self, estimated: &Estimated, inventory: &Inventory) -> Check {
        let &Inventory {
            n_records,
            n_flawed,
            ref losses,
        } = inventory;
        let n_runs = self.plan.n_runs();
        Check {
            name: "runs".into(),
            passed: n_records == n_runs && losses.is_empty() && estimated.missing.is_empty(),
            found: format!("{n_records}, {n_flawed} with losses"),
            needed: format!("{n_runs} whole ones"),
            advice: "do the missing runs (frfid run goes on where it stopped) and estimate again"
                .into(),
        }
    }

    /// An FRF of this experiment as a result: names and units of the joints, and where it came
    /// from, the amplitudes reached included.
    #[must_use]
    pub fn result(&self, frf: Frf, load: Option<&Load>) -> ResultFile {
        let mut provenance = self.provenance();
        provenance.insert("experiment_toml".into(), self.to_toml());
        provenance.extend(load.into_iter().flat_map(reached));
        let moves = self
            .plan
            .velocity_rad_s
            .iter()
            .any(|&velocity| velocity != 0.0);
        provenance.extend(load.filter(|_| moves).into_iter().flat_map(way));
        ResultFile {
            torque_rms_nm: load.map(|load| load.torque_rms_nm.clone()),
            provenance,
            ..self.named(frf)
        }
    }
}

/// The amplitudes reached, as they stand in the provenance.
fn reached(load: &Load) -> [(String, String); 2] {
    [
        ("effort_peak_nm", Limit::Torque),
        ("velocity_peak_rad_s", Limit::Velocity),
    ]
    .map(|(key, limit)| {
        let peaks = load.peaks.get(limit).unwrap_or_default();
        (key.into(), format!("{peaks:?}"))
    })
}

/// What was lost, missing, too weak or disturbed, in this order.
fn warnings(
    estimated: &Estimated,
    strength: Option<&Strength>,
    inventory: &Inventory,
) -> Vec<String> {
    let mut warnings = inventory.losses.clone();
    warnings.extend(missing_warning(estimated.missing.len()));
    warnings.extend(estimated.remarks.iter().cloned());
    let too_weak = strength.iter().flat_map(|strength| &strength.warnings);
    warnings.extend(too_weak.cloned());
    let n_lines = estimated.frf.n_frequencies();
    warnings.extend(ripple_warning(&estimated.disturbed_hz(), n_lines));
    warnings
}

fn missing_warning(n_missing: usize) -> Option<String> {
    (n_missing > 0).then(|| {
        let (periods, are, their) = match n_missing {
            1 => ("1 period".to_owned(), "is", "its"),
            n => (count(n, "period"), "are", "their"),
        };
        format!(
            "{periods} {are} not in the estimate, because not all of {their} experiments are whole"
        )
    })
}

/// Verdicts that have no other check. Where the total variance is known, it holds the ripple.
fn checked(frf: &Frf) -> Vec<Cause> {
    let ripple = frf.total.is_none().then_some(Cause::Ripple);
    let always = [
        Cause::Noise,
        Cause::Distortion,
        Cause::Sticking,
        Cause::Clipping,
    ];
    always.into_iter().chain(ripple).collect()
}

/// A check that fails where lines are left out; `None` where none is.
pub(crate) fn left_out_check(n_left_out: usize) -> Option<Check> {
    (n_left_out > 0).then(|| Check {
        name: "excited lines".into(),
        passed: false,
        found: format!("{n_left_out} without excitation, left out"),
        needed: "every line excited well above what stands beside it and its own noise".into(),
        advice: "leave out the lines that are not excited, or excite them more strongly".into(),
    })
}

/// A check that fails where noise on the input biases the FRF; `None` where it does not.
pub(crate) fn noise_bias_check(bias: Option<NoiseBias>) -> Option<Check> {
    bias.map(|bias| Check {
        name: "noise on the input".into(),
        passed: false,
        found: bias.to_string(),
        needed: "a bias below 0.3 of the standard deviation".into(),
        advice: "estimate through the reference (--indirect), average spectra over more periods \
                 (--average spectra), or excite more strongly"
            .into(),
    })
}

/// Says at which lines the ripple is not cured.
fn ripple_warning(disturbed_hz: &[f64], n_lines: usize) -> Option<String> {
    let (first, last) = (disturbed_hz.first()?, disturbed_hz.last()?);
    Some(format!(
        "what remains of the torque ripple exceeds the noise at {} of {n_lines} lines, the first at \
         {first:.3} Hz and the last at {last:.3} Hz: there the noise variance says too little, trust \
         the total variance",
        disturbed_hz.len()
    ))
}

/// Whether U could be inverted well. Torques of `torque_rms_nm` side by side make the condition
/// number as large as their spread and cost nothing: what counts is what it is beyond that.
pub(crate) fn condition_check(frf: &Frf, torque_rms_nm: &[f64]) -> Check {
    let worst = frf.condition.iter().flatten().copied().fold(1.0, f64::max);
    let limit = largest_condition(torque_rms_nm);
    let spread = spread(torque_rms_nm);
    let share = if spread > 2.0 {
        format!(", {spread:.1} of it from the spread of the torques")
    } else {
        String::new()
    };
    let unknown = frf.response.outer_iter();
    let unknown = unknown.filter(|response| response.iter().any(|value| value.is_nan()));
    let left_out = match unknown.count() {
        0 => String::new(),
        n => format!("; {n} of {} lines left out (NaN)", frf.n_frequencies()),
    };
    Check {
        name: "condition number of U".into(),
        passed: worst <= limit && left_out.is_empty(),
        found: format!("{worst:.2} at worst{share}{left_out}"),
        needed: format!("{limit:.0} or less"),
        advice: "excite the inputs more differently from experiment to experiment, and equally \
                 strongly"
            .into(),
    }
}

/// Largest condition number that is good between torques of `torque_rms_nm`.
pub(crate) fn largest_condition(torque_rms_nm: &[f64]) -> f64 {
    GOOD_CONDITION * spread(torque_rms_nm)
}

/// Largest over smallest of several torques; 1 where one is zero.
fn spread(torque_rms_nm: &[f64]) -> f64 {
    let low = torque_rms_nm.iter().copied().fold(f64::INFINITY, f64::min);
    let high = torque_rms_nm.iter().copied().fold(0.0, f64::max);
    if low > 0.0 && low < high {
        high / low
    } else {
        1.0
    }
}

/// The hash of every log, so that a result can be traced to its data.
pub(crate) fn log_hashes(
    paths: &[PathBuf],
    provenance: &mut Metadata,
) -> Result<(), ExperimentError> {
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        provenance.insert(format!("sha256 of {name}"), sha256_file(path)?);
    }
    Ok(())
}
