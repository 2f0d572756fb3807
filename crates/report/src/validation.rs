//! Validation of a figure's numbers.

use crate::error::ReportError;

/// Refuses a list that is not as long as it must be.
pub(crate) fn length(what: &str, found: usize, needed: usize) -> Result<(), ReportError> {
    if found == needed {
        Ok(())
    } else {
        Err(ReportError::Length {
            what: what.to_owned(),
            found,
            needed,
        })
    }
}

/// Refuses a value that is not finite or not `good`.
pub(crate) fn value(
    what: &str,
    found: f64,
    needed: &'static str,
    good: impl Fn(f64) -> bool,
) -> Result<(), ReportError> {
    if found.is_finite() && good(found) {
        Ok(())
    } else {
        Err(ReportError::Value {
            what: what.to_owned(),
            found,
            needed,
        })
    }
}

/// Refuses values that are not finite or do not rise.
pub(crate) fn rising(what: &str, values: &[f64]) -> Result<(), ReportError> {
    let mut last = f64::NEG_INFINITY;
    for &found in values {
        value(
            &format!("a value of {what}"),
            found,
            "finite and above the one before it",
            |value| value > last,
        )?;
        last = found;
    }
    Ok(())
}

/// Refuses frequencies that a logarithmic axis cannot hold.
pub(crate) fn log_frequencies(
    what: &str,
    frequencies_hz: impl Iterator<Item = f64>,
) -> Result<(), ReportError> {
    for hz in frequencies_hz {
        value(
            what,
            hz,
            "finite and above 0 (the frequency axis is logarithmic)",
            |hz| hz > 0.0,
        )?;
    }
    Ok(())
}
