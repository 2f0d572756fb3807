//! Ranges that parameters must lie in; every crate of the house checks its parameters with these.

use crate::error::SignalError;

/// Longest signal in samples that a design may ask for: 2^26 doubles are half a gigabyte per
/// channel.
pub(crate) const LONGEST_SIGNAL: f64 = (1u64 << 26) as f64;

/// A parameter that must be a finite number above zero.
///
/// # Errors
/// [`SignalError::Parameter`] with the name and the value found.
pub fn positive(name: &'static str, found: f64) -> Result<(), SignalError> {
    require(name, found, found > 0.0, "a finite number above 0")
}

/// A parameter that must be a finite number, zero or above.
///
/// # Errors
/// [`SignalError::Parameter`] with the name and the value found.
pub fn not_negative(name: &'static str, found: f64) -> Result<(), SignalError> {
    require(name, found, found >= 0.0, "a finite number, 0 or above")
}

/// A parameter that must be a finite number.
///
/// # Errors
/// [`SignalError::Parameter`] with the name and the value found.
pub fn finite(name: &'static str, found: f64) -> Result<(), SignalError> {
    require(name, found, true, "a finite number")
}

/// Parameters of which there must be one for each axis, every one in a range; nothing to check
/// where there are none.
///
/// # Errors
/// [`SignalError::Shape`] for another number of axes; that of `check`, e.g. [`positive`], for the
/// first one out of range.
pub fn one_per_axis(
    name: &'static str,
    values: Option<&[f64]>,
    n_axes: usize,
    check: fn(&'static str, f64) -> Result<(), SignalError>,
) -> Result<(), SignalError> {
    let Some(values) = values else { return Ok(()) };
    if values.len() != n_axes {
        return Err(SignalError::Shape {
            name,
            found: vec![values.len()],
            needed: format!("({n_axes})"),
        });
    }
    values.iter().try_for_each(|&value| check(name, value))
}

/// A count, or a product of counts, that must not exceed `most`.
pub(crate) fn at_most(
    name: &'static str,
    found: f64,
    most: f64,
    needed: &'static str,
) -> Result<(), SignalError> {
    require(name, found, found <= most, needed)
}

fn require(
    name: &'static str,
    found: f64,
    fits: bool,
    needed: &'static str,
) -> Result<(), SignalError> {
    if fits && found.is_finite() {
        Ok(())
    } else {
        Err(SignalError::Parameter {
            name,
            found,
            needed,
        })
    }
}
