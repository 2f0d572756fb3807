//! Design of an excitation: a table of a description, and what it is designed for.

use crate::error::SignalError;
use crate::excitation::phasing::Phasing;
use crate::excitation::profile::{Amplitude, Profile};
use crate::excitation::{Excitation, Injection};

/// The table of a kind of excitation, its amplitudes in the unit of whatever is injected.
pub trait Design {
    /// Phases between channels and experiments.
    fn phasing(&self) -> Phasing;

    /// The excitation.
    ///
    /// # Errors
    /// [`SignalError`] with the key of the value that does not fit.
    fn excitation(&self, target: &Target) -> Result<Excitation, SignalError>;

    /// What of it depends on the constant velocity beneath it in rad/s, one for each input, put in
    /// its place.
    ///
    /// # Errors
    /// [`SignalError`] for velocities that do not fit.
    fn ride(
        &self,
        _excitation: &mut Excitation,
        _velocity_rad_s: &[f64],
    ) -> Result<(), SignalError> {
        Ok(())
    }
}

/// What an excitation is designed for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// What its values stand for.
    pub injection: Injection,
    /// Number of inputs.
    pub n_inputs: usize,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Seed of everything random.
    pub seed: u64,
}

impl Target {
    /// Which of two keys has the values for the inputs, that in N m or that in rad/s, and the values
    /// themselves: every one in the range of `check`.
    ///
    /// # Errors
    /// [`SignalError::Unfit`] for those of the other key, for none and for another number of them;
    /// that of `check`.
    pub(crate) fn of_injection<T: Clone>(
        &self,
        [(torque_key, of_torque), (velocity_key, of_velocity)]: [(&'static str, &Option<Vec<T>>);
            2],
        check: impl Fn(&'static str, &T) -> Result<(), SignalError>,
    ) -> Result<Vec<T>, SignalError> {
        let torque = (torque_key, of_torque);
        let velocity = (velocity_key, of_velocity);
        let ((key, values), (other_key, others), why) = match self.injection {
            Injection::Torque => (torque, velocity, "in open loop the reference is a torque"),
            Injection::Velocity => (
                velocity,
                torque,
                "in closed loop the reference is a velocity",
            ),
        };
        if others.is_some() {
            let what = format!("{why}; give {key} instead of {other_key}");
            return Err(SignalError::unfit(other_key, what));
        }
        let Some(values) = values else {
            let what = format!("{key} is missing ({why})");
            return Err(SignalError::unfit(key, what));
        };
        self.check_number(key, values.len())?;
        values.iter().try_for_each(|value| check(key, value))?;
        Ok(values.clone())
    }

    /// The amplitudes over frequency, one for each input, of a table with `amplitude_nm` and
    /// `amplitude_rad_s`.
    ///
    /// # Errors
    /// As [`Target::of_injection`].
    pub(crate) fn profiles(
        &self,
        amplitude_nm: &Option<Vec<Amplitude>>,
        amplitude_rad_s: &Option<Vec<Amplitude>>,
    ) -> Result<Vec<Profile>, SignalError> {
        let keys = [
            ("amplitude_nm", amplitude_nm),
            ("amplitude_rad_s", amplitude_rad_s),
        ];
        let amplitudes = self.of_injection(keys, Amplitude::check)?;
        Ok(amplitudes.iter().map(Amplitude::profile).collect())
    }

    /// Checks that there is one value for each input.
    fn check_number(&self, key: &'static str, found: usize) -> Result<(), SignalError> {
        let needed = self.n_inputs;
        if found == needed {
            return Ok(());
        }
        let what = format!("{key} has {found} entries, needed: one for each of the {needed} axes");
        Err(SignalError::unfit(key, what))
    }
}
