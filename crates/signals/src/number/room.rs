//! Room for arrays: how large they may be asked for, and whether there is memory for them.

use ndarray::Array3;

use crate::error::SignalError;
use crate::number::checks::at_most;

/// Most inputs of a machine: each takes an experiment, a thousand of which nobody does.
const MOST_INPUTS: usize = 1000;

/// Most values that are made at once: 2^28 doubles are two gigabytes.
const MOST_VALUES: f64 = (1u64 << 28) as f64;

/// A number of inputs that a machine may have.
///
/// # Errors
/// [`SignalError::Derived`] for more than 1000.
pub fn possible_inputs(n_inputs: usize) -> Result<(), SignalError> {
    at_most(
        "n_inputs",
        "number of inputs",
        n_inputs as f64,
        MOST_INPUTS as f64,
        "at most 1000",
    )
}

/// Values that are made at once, of an array or of several: the product of `counts`, which follows
/// from the field `key`.
///
/// # Errors
/// [`SignalError::Derived`] for more than 2^28 of them, which are two gigabytes;
/// [`SignalError::Memory`] where the system has no room for them.
pub fn room_for(
    key: &'static str,
    quantity: &'static str,
    counts: &[usize],
) -> Result<(), SignalError> {
    let found = counts.iter().map(|&count| count as f64).product();
    at_most(key, quantity, found, MOST_VALUES, "at most 2^28, 2 GB")?;
    room::<f64>(found as usize).map(drop)
}

/// An array of zeros, which may be asked for in any size.
///
/// # Errors
/// As [`room_for`].
pub(crate) fn zeros(key: &'static str, shape: [usize; 3]) -> Result<Array3<f64>, SignalError> {
    room_for(key, "number of values of the signals", &shape)?;
    let n_values = shape.iter().product();
    let mut values = room(n_values)?;
    values.resize(n_values, 0.0);
    Ok(Array3::from_shape_vec(shape, values).expect("as many values as the shape has places"))
}

/// Memory for so many values.
///
/// # Errors
/// [`SignalError::Memory`].
pub fn room<T>(n_values: usize) -> Result<Vec<T>, SignalError> {
    let mut values = Vec::new();
    match values.try_reserve_exact(n_values) {
        Ok(()) => Ok(values),
        Err(_) => Err(SignalError::Memory { n_values }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_held_is_refused() {
        let refused = |shape| zeros("n_inputs", shape).expect_err("too large");
        assert_eq!(refused([usize::MAX; 3]).path(), ["n_inputs"]);
        assert_eq!(refused([1 << 14, 1 << 14, 2]).path(), ["n_inputs"]);
        let n_values = usize::MAX / 64;
        assert_eq!(room::<f64>(n_values), Err(SignalError::Memory { n_values }));
        assert_eq!(zeros("n_inputs", [2, 3, 4]), Ok(Array3::zeros((2, 3, 4))));
    }
}
