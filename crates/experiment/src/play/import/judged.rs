//! Judgement of a run that was found in a recording: sure, doubtful, or logged otherwise than the map says.

use frfid_files::{Log, si_unit};
use frfid_signals::format::significant;

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::play::import::sought::FoundRun;

/// Likeness needed to what the player was told, and to what the machine made of it.
const LIKE_REFERENCE: f64 = 0.85;
const LIKE_MOTION: f64 = 0.6;
/// How much more likely than the next reference.
const AHEAD: f64 = 0.1;
/// Logged over planned reference, beyond which unit or side is another one.
const GAIN: [f64; 2] = [0.7, 1.4];

/// Why a run cannot be told; `None` if it is sure.
pub(super) fn doubt(found: &FoundRun, log: &Log) -> Option<String> {
    let occurrence = &found.occurrence;
    let needed = if log.record.r.is_some() {
        LIKE_REFERENCE
    } else {
        LIKE_MOTION
    };
    let at_s = significant(occurrence.alignment.start_s, 5);
    let (likeness, rival) = (
        significant(occurrence.likeness, 3),
        significant(occurrence.rival, 3),
    );
    if occurrence.likeness < needed {
        let id = found.id;
        return Some(format!(
            "at {at_s} s like {id} by {likeness}, needed {needed}"
        ));
    }
    (occurrence.likeness - occurrence.rival < AHEAD).then(|| {
        format!(
            "at {at_s} s like {} by {likeness}, like another run by {rival}",
            found.id
        )
    })
}

/// Checks that the logged reference is that of the plan in unit, side and sign.
///
/// # Errors
/// [`ExperimentError::Logs`] with what is logged of it.
pub(super) fn check_gains(
    found: &FoundRun,
    log: &Log,
    experiment: &Experiment,
) -> Result<(), ExperimentError> {
    let is_comparable = experiment.reference_units().iter().all(|unit| is_si(unit));
    if log.record.r.is_none() || !is_comparable {
        return Ok(());
    }
    let gains = found
        .occurrence
        .alignment
        .gains
        .iter()
        .zip(&experiment.joint_names);
    let mut known = gains.filter_map(|(gain, joint)| Some(((*gain)?, joint)));
    let Some((gain, joint)) = known.find(|(gain, _)| !(GAIN[0]..=GAIN[1]).contains(gain)) else {
        return Ok(());
    };
    let gain = significant(gain, 4);
    Err(ExperimentError::logs(
        "reference of the recording",
        format!(
            "{gain} times that of the plan on {joint}, in run {}",
            found.id
        ),
        "that of the plan on the joint side",
        "see unit, sign and gear ratio (scale) of r in the map",
    ))
}

/// Whether a unit is the one that recordings are converted to.
fn is_si(unit: &str) -> bool {
    si_unit(unit) == Some(unit)
}

/// Checks that a recording has the channels of a plan.
///
/// # Errors
/// [`ExperimentError::Logs`] for other numbers, or a reference in another quantity.
pub(super) fn check_channels(log: &Log, experiment: &Experiment) -> Result<(), ExperimentError> {
    let n = experiment.plan.n_inputs;
    let found = (log.record.u.nrows(), log.record.y.nrows());
    if found != (n, n) {
        return Err(ExperimentError::logs(
            "log map",
            format!("{} inputs and {} outputs", found.0, found.1),
            format!("{n} of each, as the plan has"),
            "name one u and one y for each joint, in the order of the plan's joints",
        ));
    }
    let needed = experiment.reference_units();
    let mut pairs = log.reference_units.iter().zip(&needed);
    match pairs.find(|(found, needed)| is_si(needed) && found != needed) {
        None => Ok(()),
        Some((found, needed)) => Err(ExperimentError::logs(
            "reference in the log map",
            format!("in {found}"),
            format!("in {needed} (or a unit of the same quantity), as the plan injects"),
            "name the reference that the player followed, or none",
        )),
    }
}
