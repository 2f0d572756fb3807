//! Waveform, the common face of every kind of excitation.

use ndarray::Array3;
use serde::Serialize;

use crate::error::SignalError;
use crate::excitation::phasing::Phasing;

/// A kind of excitation. Whoever plans, runs, estimates or reports asks this, and never which kind
/// it is.
pub trait Waveform {
    /// Its name, for people and in `--json`.
    fn name(&self) -> &'static str;

    /// Whether its period is repeated back to back: a run may hold several, what comes before the
    /// first is its continuation, and all frequencies are there all the time. Otherwise it is done
    /// once in a run, from rest, and draws no random phases.
    fn is_periodic(&self) -> bool;

    /// Checks every number, for so many inputs.
    ///
    /// # Errors
    /// [`SignalError`] naming the first value out of range.
    fn check_for(&self, n_inputs: usize) -> Result<(), SignalError>;

    /// Samples of one period; of the whole where it is not periodic, its rest at the end included.
    ///
    /// # Errors
    /// [`SignalError`] for an impossible length.
    fn period_samples(&self, sample_time_s: f64) -> Result<usize, SignalError>;

    /// One period of every experiment and input, `(experiment, input, sample)`, as long as `go_on`
    /// says so.
    ///
    /// # Errors
    /// [`SignalError`] if the numbers do not fit together; [`SignalError::Interrupted`].
    fn period(
        &self,
        sample_time_s: f64,
        n_inputs: usize,
        draw: &Draw,
        go_on: GoOn,
    ) -> Result<Array3<f64>, SignalError>;

    /// Lowest and highest frequency excited, in Hz.
    fn band_hz(&self) -> [f64; 2];

    /// Largest value per channel, in the unit of the injected quantity; one value where it is the
    /// same for all.
    fn peaks(&self) -> Vec<f64>;

    /// Lead-in in s where none is asked for, so that transients die out.
    fn default_lead_in_s(&self) -> f64;

    /// Time in s after the start of a period up to which it excites; its rest comes after.
    fn excited_s(&self, sample_time_s: f64) -> f64;

    /// When in a period, in s from its start, its frequency lies between two in Hz, which are within
    /// its band; `None` where all are there all the time.
    fn seconds_in(&self, band_hz: [f64; 2], sample_time_s: f64) -> Option<[f64; 2]>;

    /// What it is in words: labels and texts, the first label its name.
    fn described(&self, sample_time_s: f64) -> Vec<(&'static str, String)>;

    /// Numbers of it that other kinds do not have, for machines, by their keys.
    fn facts(&self) -> Vec<(&'static str, Fact)>;
}

/// Asked between the steps of work that takes a while; `false` ends it.
pub type GoOn<'a> = &'a dyn Fn() -> bool;

/// Whether work goes on.
///
/// # Errors
/// [`SignalError::Interrupted`].
pub(crate) fn check_on(go_on: GoOn) -> Result<(), SignalError> {
    if go_on() {
        return Ok(());
    }
    Err(SignalError::Interrupted)
}

/// Which realization is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draw {
    /// Seed of the plan.
    pub seed: u64,
    /// Number of the realization, from 0: its random phases come from a stream of their own.
    pub realization: usize,
    /// Phases between channels and experiments.
    pub phasing: Phasing,
}

/// A number that describes an excitation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Fact {
    /// How many.
    Count(usize),
    /// How much, in the unit of its key.
    Value(f64),
}
