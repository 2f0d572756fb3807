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
    /// Whether they are in a unit of the channels' own.
    pub is_of_channels: bool,
    /// Number of inputs.
    pub n_inputs: usize,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Seed of everything random.
    pub seed: u64,
}

impl Target {
    /// The values for the inputs, of the key that the injection asks for among those in N m, in
    /// rad/s and in the channels' own unit: every one in the range of `check`.
    ///
    /// # Errors
    /// [`SignalError::Unfit`] for those of another key, for none and for another number of them;
    /// that of `check`.
    pub(crate) fn of_injection<T: Clone>(
        &self,
        keys: [(&'static str, &Option<Vec<T>>); 3],
        check: impl Fn(&'static str, &T) -> Result<(), SignalError>,
    ) -> Result<Vec<T>, SignalError> {
        let (asked, why) = self.asked();
        let (key, values) = keys[asked];
        let mut others = keys.iter().filter(|(other, _)| *other != key);
        if let Some((other, _)) = others.find(|(_, values)| values.is_some()) {
            let what = format!("{why}; give {key} instead of {other}");
            return Err(SignalError::unfit(other, what));
        }
        let Some(values) = values else {
            let what = format!("{key} is missing ({why})");
            return Err(SignalError::unfit(key, what));
        };
        self.check_number(key, values.len())?;
        values.iter().try_for_each(|value| check(key, value))?;
        Ok(values.clone())
    }

    /// Which key has the values, and why that one.
    fn asked(&self) -> (usize, &'static str) {
        match (self.is_of_channels, self.injection) {
            (true, _) => (2, "the reference is in the unit of its channel"),
            (false, Injection::Torque) => (0, "in open loop the reference is a torque"),
            (false, Injection::Velocity) => (1, "in closed loop the reference is a velocity"),
        }
    }

    /// The amplitudes over frequency, one for each input, of a table with `amplitude_nm`,
    /// `amplitude_rad_s` and `amplitude`.
    ///
    /// # Errors
    /// As [`Target::of_injection`].
    pub(crate) fn profiles(
        &self,
        [nm, rad_s, own]: [&Option<Vec<Amplitude>>; 3],
    ) -> Result<Vec<Profile>, SignalError> {
        let keys = [
            ("amplitude_nm", nm),
            ("amplitude_rad_s", rad_s),
            ("amplitude", own),
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
