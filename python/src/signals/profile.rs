//! Amplitudes as Python gives them: a number, a profile over frequency, or a list of these per
//! channel.

use frfid_signals::Profile;
use frfid_signals::room::possible_inputs;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error;
use crate::size::check_length;

#[derive(FromPyObject)]
enum Amplitude {
    Constant(f64),
    Points(Vec<[f64; 2]>),
}

#[derive(FromPyObject)]
enum Amplitudes {
    Common(Amplitude),
    PerChannel(Vec<Amplitude>),
}

impl From<Amplitude> for Profile {
    fn from(amplitude: Amplitude) -> Self {
        match amplitude {
            Amplitude::Constant(value) => Self::constant(value),
            Amplitude::Points(points) => Self {
                points: points.into_iter().map(|[hz, value]| (hz, value)).collect(),
            },
        }
    }
}

/// One profile for all channels, or one for each.
pub(crate) fn profiles(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<Profile>> {
    check_length(value)?;
    match value.extract() {
        Ok(Amplitudes::Common(amplitude)) => Ok(vec![amplitude.into()]),
        Ok(Amplitudes::PerChannel(amplitudes)) => {
            Ok(amplitudes.into_iter().map(Profile::from).collect())
        }
        Err(_) => Err(PyValueError::new_err(format!(
            "{argument} is {}, needed a number, a profile [(hz, value), ...], or a list of these per channel",
            value.repr()?
        ))),
    }
}

/// One profile, the same for all channels.
pub(crate) fn profile(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Profile> {
    check_length(value)?;
    value
        .extract::<Amplitude>()
        .map(Profile::from)
        .map_err(|_| {
            PyValueError::new_err(format!(
                "{argument} is {value}, needed a number or a profile [(hz, value), ...]"
            ))
        })
}

/// A number for every channel: one of them stands for all.
pub(crate) fn per_channel(
    argument: &str,
    value: &Bound<'_, PyAny>,
    n_channels: usize,
) -> PyResult<Vec<f64>> {
    possible_inputs(n_channels).map_err(error::signal)?;
    check_length(value)?;
    if let Ok(common) = value.extract::<f64>() {
        return Ok(vec![common; n_channels]);
    }
    match value.extract::<Vec<f64>>() {
        Ok(values) if values.len() == n_channels => Ok(values),
        _ => Err(PyValueError::new_err(format!(
            "{argument} is {value}, needed a number, or one number for each of the {n_channels} channels"
        ))),
    }
}

/// The profile as Python writes it.
pub(crate) fn points(profile: &Profile) -> Vec<(f64, f64)> {
    profile.points.clone()
}
