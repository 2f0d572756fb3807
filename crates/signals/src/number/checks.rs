//! Ranges that parameters must lie in; every crate of the house checks its parameters with these.

use crate::error::SignalError;

/// Longest signal in samples that a design may ask for: 2^26 doubles are half a gigabyte per
/// channel.
pub(crate) const LONGEST_SIGNAL: f64 = (1u64 << 26) as f64;

/// A parameter that must be a finite number above zero.
///
/// # Errors
/// [`SignalError::Parameter`] with the name and the value found.
pub fn positive(key: &'static str, found: f64) -> Result<(), SignalError> {
    require(key, found, found > 0.0, "a finite number above 0")
}

/// A parameter that must be a finite number, zero or above.
///
/// # Errors
/// [`SignalError::Parameter`] with the name and the value found.
pub fn not_negative(key: &'static str, found: f64) -> Result<(), SignalError> {
    require(key, found, found >= 0.0, "a finite number, 0 or above")
}

/// A parameter that must be a finite number.
///
/// # Errors
/// [`SignalError::Parameter`] with the name and the value found.
pub fn finite(key: &'static str, found: f64) -> Result<(), SignalError> {
    require(key, found, true, "a finite number")
}

/// Parameters of which there must be one for each axis, every one in a range; nothing to check
/// where there are none.
///
/// # Errors
/// [`SignalError::Shape`] for another number of axes; that of `check`, e.g. [`positive`], for the
/// first one out of range.
pub fn one_per_axis(
    key: &'static str,
    values: Option<&[f64]>,
    n_axes: usize,
    check: fn(&'static str, f64) -> Result<(), SignalError>,
) -> Result<(), SignalError> {
    let Some(values) = values else { return Ok(()) };
    if values.len() != n_axes {
        return Err(SignalError::Shape {
            name: key,
            found: vec![values.len()],
            needed: format!("({n_axes})"),
        });
    }
    values.iter().try_for_each(|&value| check(key, value))
}

/// The values, if there is one for each axis.
///
/// # Errors
/// [`SignalError::Shape`] for another number of axes.
pub fn of_axes<'a, T>(
    key: &'static str,
    values: &'a [T],
    n_axes: usize,
) -> Result<&'a [T], SignalError> {
    if values.len() == n_axes {
        return Ok(values);
    }
    let (found, needed) = (vec![values.len()], format!("({n_axes})"));
    Err(SignalError::Shape {
        name: key,
        found,
        needed,
    })
}

/// The values as an array, if there is exactly one for each axis.
///
/// # Errors
/// [`SignalError::Shape`] for another number of axes.
pub fn channels<T: Copy, const A: usize>(
    key: &'static str,
    values: &[T],
) -> Result<[T; A], SignalError> {
    values.try_into().map_err(|_| {
        let (found, needed) = (vec![values.len()], format!("({A})"));
        SignalError::Shape {
            name: key,
            found,
            needed,
        }
    })
}

/// A count, or a product of counts, that must not exceed `most`; it follows from the field `key`.
pub(crate) fn at_most(
    key: &'static str,
    quantity: &'static str,
    found: f64,
    most: f64,
    needed: &'static str,
) -> Result<(), SignalError> {
    if found <= most {
        return Ok(());
    }
    Err(SignalError::Derived {
        key,
        quantity,
        found,
        needed,
    })
}

/// The upper end of a band, which must lie below the Nyquist frequency.
pub(crate) fn below_nyquist(high_hz: f64, sample_time_s: f64) -> Result<(), SignalError> {
    let nyquist_hz = 0.5 / sample_time_s;
    if high_hz < nyquist_hz {
        return Ok(());
    }
    Err(SignalError::AboveNyquist {
        high_hz,
        nyquist_hz,
        sample_time_s,
    })
}

fn require(
    key: &'static str,
    found: f64,
    fits: bool,
    needed: &'static str,
) -> Result<(), SignalError> {
    if fits && found.is_finite() {
        Ok(())
    } else {
        Err(SignalError::Parameter { key, found, needed })
    }
}
