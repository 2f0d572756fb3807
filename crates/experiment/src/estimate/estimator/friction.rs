//! Friction of the runs of a plan: found in each of them, taken off its torque.

use std::borrow::Cow;

use frfid_estimate::{EstimateError, Friction, find_friction};
use frfid_signals::format::significant;
use frfid_signals::{Plan, Record, SignalError, median};

use crate::description::estimate::EstimateTable;
use crate::error::ExperimentError;
use crate::estimate::estimator::friction_of_axes::{FrictionSigns, MOST_STUCK, STICKS};

/// Friction that differs by more than this from run to run is not Coulomb's alone.
const MOST_SPREAD: f64 = 0.1;

/// What the runs of a plan show of friction.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrictionOfRuns {
    band_hz: [f64; 2],
    /// Several axes, whose runs tell it together.
    is_of_several: bool,
}

/// Friction that was taken off a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Subtracted {
    coulomb_nm: f64,
    standard_error_nm: f64,
    stuck_share: f64,
}

impl FrictionOfRuns {
    /// Where it is asked for.
    ///
    /// # Errors
    /// [`SignalError::Unfit`] for a constant velocity, beneath which friction does not turn.
    pub(super) fn of_plan(
        plan: &Plan,
        options: &EstimateTable,
    ) -> Result<Option<Self>, SignalError> {
        if !options.subtract_friction {
            return Ok(None);
        }
        if plan.velocity_rad_s.iter().any(|velocity| *velocity != 0.0) {
            let what = "a constant velocity keeps friction constant, and the glides take it off: leave this out";
            return Err(SignalError::unfit("subtract_friction", what));
        }
        Ok(Some(Self {
            band_hz: plan.excitation.waveform().band_hz(),
            is_of_several: plan.n_inputs > 1,
        }))
    }

    /// What a run of several axes says; `None` of one axis.
    ///
    /// # Errors
    /// [`EstimateError`] for a record that says nothing.
    pub(super) fn signs(&self, record: &Record) -> Result<Option<FrictionSigns>, EstimateError> {
        let of_several = self.is_of_several.then_some(record);
        let signs = |record| FrictionSigns::of(record, self.band_hz);
        of_several.map(signs).transpose()
    }

    /// The record without its friction, and what that was.
    ///
    /// # Errors
    /// [`EstimateError`] where no friction explains the record.
    pub(super) fn subtracted(
        &self,
        record: &Record,
    ) -> Result<(Record, Subtracted), EstimateError> {
        let (u, y) = (record.u.row(0), record.y.row(0));
        let Friction {
            torque_nm,
            coulomb_nm,
            standard_error_nm,
            stuck_share,
            ..
        } = find_friction(u, y, record.sample_time_s, self.band_hz)?;
        let mut free = record.clone();
        let samples = free.u.iter_mut().zip(torque_nm);
        samples.for_each(|(u, friction)| *u -= friction);
        let subtracted = Subtracted {
            coulomb_nm,
            standard_error_nm,
            stuck_share,
        };
        Ok((free, subtracted))
    }
}

/// A record, without its friction where that is asked for of one axis.
///
/// # Errors
/// As [`FrictionOfRuns::subtracted`].
pub(super) fn without_friction<'r>(
    friction: Option<&FrictionOfRuns>,
    record: &'r Record,
) -> Result<(Cow<'r, Record>, Option<Subtracted>), ExperimentError> {
    match friction.filter(|friction| !friction.is_of_several) {
        None => Ok((Cow::Borrowed(record), None)),
        Some(friction) => {
            let (free, subtracted) = friction.subtracted(record)?;
            Ok((Cow::Owned(free), Some(subtracted)))
        }
    }
}

/// How much friction was taken off, how sure that is, and why not to trust it; `None` without any.
pub(super) fn remark(runs: &[Subtracted]) -> Option<String> {
    let coulomb_nm = || runs.iter().map(|run| run.coulomb_nm);
    let median_nm = median(coulomb_nm().collect())?;
    let spread_nm = coulomb_nm().fold(f64::MIN, f64::max) - coulomb_nm().fold(f64::MAX, f64::min);
    let stuck = runs.iter().map(|run| run.stuck_share).fold(0.0, f64::max);
    let doubt = if stuck > MOST_STUCK {
        STICKS
    } else if spread_nm > MOST_SPREAD * median_nm {
        "; runs differ too much in it for that to be trusted"
    } else {
        ""
    };
    let error_nm = runs
        .iter()
        .map(|run| run.standard_error_nm)
        .fold(0.0, f64::max);
    let spread = format!(", from run to run within {} N m", significant(spread_nm, 2));
    Some(format!(
        "Coulomb friction of {} N m was taken off the torque, its standard error {} N m{}; the axis does not slip in {} % of \
         the time{doubt}",
        significant(median_nm, 4),
        significant(error_nm, 2),
        if runs.len() > 1 { &spread } else { "" },
        significant(100.0 * stuck, 2),
    ))
}
