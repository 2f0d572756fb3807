//! Coulomb friction of one axis, told from a record without a constant velocity, and taken off its torque.
//!
//! The motor's balance is
//!
//! ```text
//! u = J s y + H(s) y + tau_f,    tau_f = F_c sgn(y) while it slips, what holds it (at most F_c) while it sticks
//! ```
//!
//! with H the torque that goes on into the machine. Neither J, H nor F_c is known: they follow from the record by
//! a model of low order with the friction as a second input ([`inverse_model`]), the friction from J, H and F_c
//! by following the motor through the record ([`observer`]), in turn until F_c stays. What is then estimated
//! from `u - tau_f` needs no model. On the paper's joint without noise F_c comes to 0.1 %, the FRF of a chirp to
//! 0.05 dB at worst, where friction otherwise costs 5 dB.
//!
//! Source: ours; instruments after P. C. Young, Recursive estimation and time-series analysis, 2nd ed., 2011, ch. 8.

mod axes;
mod instruments;
mod inverse_model;
mod noise_level;
mod observer;
mod signs;
#[cfg(test)]
mod tests;

pub use axes::run::FrictionSpectra;
pub use axes::{AxisFriction, FrictionOfAxes, find_friction_of_axes};
use frfid_signals::SignalError;
use frfid_signals::checks::positive;
use ndarray::ArrayView1;
pub use signs::mean_signs;

use crate::error::EstimateError;
use crate::friction::inverse_model::{InverseModel, Lines};
use crate::friction::observer::Observer;
use crate::friction::signs::clear_signs;

/// Rounds, at most: each brings F_c four times as near.
const MOST_ROUNDS: usize = 12;
/// Relative change of F_c at which it stays.
const STAYS: f64 = 1e-4;
/// Friction of fewer standard errors is none.
const SIGNIFICANT: f64 = 2.0;

/// The friction of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction {
    /// Its torque, sample by sample, the mean over what follows each.
    pub torque_nm: Vec<f64>,
    /// Coulomb friction F_c.
    pub coulomb_nm: f64,
    /// Its standard error, by what the model does not explain.
    pub standard_error_nm: f64,
    /// What moves with the motor, J.
    pub motor_inertia_kg_m2: f64,
    /// Share of the samples in which it does not slip all the time.
    pub stuck_share: f64,
}

/// The friction of one axis in a record that begins and ends at rest, excited from `low_hz` to `high_hz`.
///
/// # Errors
/// [`SignalError`] for lengths that differ, samples that are not finite, a band that is not there;
/// [`SignalError::Unfit`] where no friction is found that explains the record.
pub fn find_friction(
    torque_nm: ArrayView1<f64>,
    velocity_rad_s: ArrayView1<f64>,
    sample_time_s: f64,
    band_hz: [f64; 2],
) -> Result<Friction, EstimateError> {
    let [low_hz, high_hz] = band_hz;
    positive("sample_time_s", sample_time_s)?;
    positive("low_hz", low_hz)?;
    positive("high_hz - low_hz", high_hz - low_hz)?;
    let lines = Lines::of(torque_nm, velocity_rad_s, sample_time_s, band_hz)?;
    let y = velocity_rad_s.to_vec();
    let observer = Observer {
        torque_nm: torque_nm.to_vec(),
        sample_time_s,
        gain_per_s: lines.middle_rad_s,
        velocity_rad_s: y.clone(),
    };
    let mut shape = clear_signs(&y);
    let mut before = 0.0;
    for _ in 0..MOST_ROUNDS {
        let model = lines.fit(&shape)?.ok_or_else(not_found)?;
        let torque = observer.friction(&model, &shape);
        shape = torque
            .iter()
            .map(|torque| torque / model.coulomb_nm)
            .collect();
        if (model.coulomb_nm - before).abs() <= STAYS * model.coulomb_nm {
            let is_significant = model.coulomb_nm > SIGNIFICANT * model.standard_error_nm;
            let friction = is_significant.then(|| Friction::of(&model, torque));
            return friction.ok_or_else(not_found);
        }
        before = model.coulomb_nm;
    }
    Err(not_found())
}

impl Friction {
    fn of(model: &InverseModel, torque_nm: Vec<f64>) -> Self {
        let whole = model.coulomb_nm * (1.0 - 1e-9);
        let slips = |torque: &&f64| torque.abs() > whole;
        let n_slipping = torque_nm.iter().filter(slips).count();
        Self {
            stuck_share: 1.0 - n_slipping as f64 / torque_nm.len() as f64,
            torque_nm,
            coulomb_nm: model.coulomb_nm,
            standard_error_nm: model.standard_error_nm,
            motor_inertia_kg_m2: model.inertia,
        }
    }
}

fn not_found() -> EstimateError {
    let what = "no Coulomb friction explains the record: needed a single axis that slips most of the time, from rest to \
                rest, with the band that is excited; several axes that move each other are not one";
    SignalError::unfit("friction", what).into()
}
