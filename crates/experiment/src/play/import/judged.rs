//! Judgement of a run that was found in a recording: sure, doubtful, or logged otherwise than the map says.

use frfid_files::{Log, si_unit};
use frfid_signals::format::significant;
use frfid_signals::{Record, Run};

use crate::error::ExperimentError;
use crate::experiment::Experiment;
use crate::play::import::sought::FoundRun;

/// Likeness needed to what the player was told, and to what the machine made of it.
const LIKE_REFERENCE: f64 = 0.85;
const LIKE_MOTION: f64 = 0.6;
/// Share of the samples of a signal that may be missing.
const MOST_LOST: f64 = 0.1;
/// Farthest that a run may begin from where the plan begins it, in rad.
const OFF_PLACE_RAD: f64 = 0.05;
/// Farthest that a run may be from its place by the player's clock, in s.
const FAR_S: f64 = 0.1;
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
    if let Some(delay_s) = found.delay_s.filter(|delay_s| delay_s.abs() > FAR_S) {
        return Some(format!(
            "at {at_s} s like {} by {likeness}, {delay_s:.3} s after the player's clock has it",
            found.id
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

/// Checks that the signals were measured but for a few samples.
///
/// # Errors
/// [`ExperimentError::Logs`] naming the signal.
pub(super) fn check_measured(
    record: &Record,
    joint_names: &[String],
) -> Result<(), ExperimentError> {
    let n = record.n_samples();
    for (name, signal) in [("u", &record.u), ("y", &record.y)] {
        for (row, joint) in signal.rows().into_iter().zip(joint_names) {
            let n_lost = row.iter().filter(|value| !value.is_finite()).count();
            if n_lost as f64 > MOST_LOST * n as f64 {
                return Err(ExperimentError::logs(
                    "recording",
                    format!("{n_lost} of {n} samples of {name} of {joint} without a value"),
                    "at most a tenth",
                    "see whether the sensor or the recorder failed",
                ));
            }
        }
    }
    Ok(())
}

/// Checks that a run began where the plan begins it.
///
/// # Errors
/// [`ExperimentError::Logs`] naming the joint that was elsewhere.
pub(super) fn check_place(
    record: &Record,
    run: &Run,
    experiment: &Experiment,
) -> Result<(), ExperimentError> {
    let Some(position) = record.position_rad.as_ref().filter(|p| p.ncols() > 0) else {
        return Ok(());
    };
    let starts = experiment.pose_rad.iter().zip(&run.start_rad);
    for ((found, (pose, start)), joint) in position
        .column(0)
        .iter()
        .zip(starts)
        .zip(&experiment.joint_names)
    {
        let planned = pose + start;
        if (found - planned).abs() > OFF_PLACE_RAD {
            return Err(ExperimentError::logs(
                "position of the recording",
                format!("{joint} at {found:.4} rad where run {} begins", run.id),
                format!("{planned:.4} rad, within {OFF_PLACE_RAD}"),
                "see joint, sign, unit and zero of position in the map, and where the machine stood",
            ));
        }
    }
    Ok(())
}

/// Whether a unit is the one that recordings are converted to.
fn is_si(unit: &str) -> bool {
    si_unit(unit) == Some(unit)
}

/// Checks that the reference of a recording is the quantity that the plan injects.
///
/// # Errors
/// [`ExperimentError::Logs`] for another.
pub(super) fn check_reference(log: &Log, experiment: &Experiment) -> Result<(), ExperimentError> {
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
