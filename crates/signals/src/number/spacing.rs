//! Spacing of frequencies.

use crate::error::SignalError;
use crate::number::checks::require;

/// `count` frequencies from `low_hz` to `high_hz`, logarithmically spaced, both ends included.
///
/// # Errors
/// [`SignalError::Parameter`] for fewer than two.
pub fn log_spaced(low_hz: f64, high_hz: f64, count: usize) -> Result<Vec<f64>, SignalError> {
    require("n_frequencies", count as f64, count >= 2, "at least 2")?;
    let last = (count - 1) as f64;
    let between = (1..count - 1).map(|index| low_hz * (high_hz / low_hz).powf(index as f64 / last));
    Ok(std::iter::once(low_hz)
        .chain(between)
        .chain(std::iter::once(high_hz))
        .collect())
}
