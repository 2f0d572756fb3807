//! Ranges that parameters must lie in; every crate of the house checks its parameters with these.

use std::fmt;

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

/// The largest value of a signal, in any unit: its powers and sums of them stay numbers.
const LARGEST_AMPLITUDE: f64 = 1e12;

/// A largest value of a signal, which must be a finite number above zero that can be squared and
/// summed.
///
/// # Errors
/// [`SignalError::Parameter`] with the name and the value found.
pub fn amplitude(key: &'static str, found: f64) -> Result<(), SignalError> {
    positive(key, found)?;
    at_most_largest(key, found)
}

/// A value of a signal, which must not be beyond all signals.
pub(crate) fn at_most_largest(key: &'static str, found: f64) -> Result<(), SignalError> {
    let fits = found <= LARGEST_AMPLITUDE;
    require(key, found, fits, "at most 1e12")
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
    of_axes(key, values, n_axes)?
        .iter()
        .try_for_each(|&value| check(key, value))
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
    let fits = values.len() == n_axes;
    require_shape(key, &[values.len()], fits, format_args!("({n_axes})"))?;
    Ok(values)
}

/// The values as an array, if there is exactly one for each axis.
///
/// # Errors
/// [`SignalError::Shape`] for another number of axes.
pub fn channels<T: Copy, const A: usize>(
    key: &'static str,
    values: &[T],
) -> Result<[T; A], SignalError> {
    let refused = |_| SignalError::shape(key, &[values.len()], format!("({A})"));
    values.try_into().map_err(refused)
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
    Err(SignalError::derived(key, quantity, found, needed))
}

/// The upper end of a band, which must lie below the Nyquist frequency.
///
/// # Errors
/// [`SignalError::AboveNyquist`].
pub fn below_nyquist(high_hz: f64, sample_time_s: f64) -> Result<(), SignalError> {
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

/// A parameter that must be a finite number and fit as `needed` says.
///
/// # Errors
/// [`SignalError::Parameter`] with the name and the value found.
pub fn require(
    key: &'static str,
    found: f64,
    fits: bool,
    needed: &'static str,
) -> Result<(), SignalError> {
    if fits && found.is_finite() {
        Ok(())
    } else {
        Err(SignalError::parameter(key, found, needed))
    }
}

/// An array or a list whose shape must fit as `needed` says.
///
/// # Errors
/// [`SignalError::Shape`] with the name and the shape found.
pub fn require_shape(
    name: &'static str,
    found: &[usize],
    fits: bool,
    needed: impl fmt::Display,
) -> Result<(), SignalError> {
    if fits {
        Ok(())
    } else {
        Err(SignalError::shape(name, found, needed.to_string()))
    }
}

/// Values that must all be finite, by the places `(channel, sample)` of those that are not.
///
/// # Errors
/// [`SignalError::NotFinite`] with their number and the first one.
pub fn all_finite(
    name: &'static str,
    mut bad: impl Iterator<Item = (usize, usize)>,
) -> Result<(), SignalError> {
    let Some((channel, sample)) = bad.next() else {
        return Ok(());
    };
    Err(SignalError::NotFinite {
        name,
        count: 1 + bad.count(),
        channel,
        sample,
    })
}
