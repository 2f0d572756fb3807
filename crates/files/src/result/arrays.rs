//! Arrays of a result by name, as numpy and MATLAB get them.

use frfid_signals::{Frf, Uncertainty};
use ndarray::{Array3, ArrayD, aview1};
use num_complex::Complex64;

use crate::result::result_file::ResultFile;

/// An array of a result.
pub(crate) enum NamedArray {
    Real(ArrayD<f64>),
    Complex(ArrayD<Complex64>),
    Count(usize),
    Flags(Vec<bool>),
    Texts(Vec<String>),
}

impl NamedArray {
    fn list(values: &[f64]) -> Self {
        Self::Real(aview1(values).into_dyn().to_owned())
    }
}

/// The arrays of a result with their names: `frequency_hz`, `response` (frequency, output, input)
/// and, where known, `noise_variance`, `noise_covariance`, `noise_degrees_of_freedom`, the same for
/// `total`, `condition`, `relative_resolution`, `torque_rms_nm`, `flagged`; names and units of
/// inputs and outputs.
pub(crate) fn named_arrays(result: &ResultFile) -> Vec<(String, NamedArray)> {
    let mut arrays = response_arrays(&result.frf);
    let mut add = |name: &str, array| arrays.push((name.into(), array));
    if let Some(torque) = &result.torque_rms_nm {
        add("torque_rms_nm", NamedArray::list(torque));
    }
    if let Some(flags) = &result.flagged {
        add("flagged", NamedArray::Flags(flags.clone()));
    }
    for (name, texts) in [
        ("input_names", &result.input_names),
        ("output_names", &result.output_names),
        ("input_units", &result.input_units),
        ("output_units", &result.output_units),
    ] {
        add(name, NamedArray::Texts(texts.clone()));
    }
    arrays
}

/// What belongs to the FRF itself.
fn response_arrays(frf: &Frf) -> Vec<(String, NamedArray)> {
    let response = NamedArray::Complex(frf.response.clone().into_dyn());
    let mut arrays = vec![
        ("frequency_hz".into(), NamedArray::list(&frf.frequency_hz)),
        ("response".into(), response),
    ];
    let (noise, total) = (frf.noise_variance(), frf.total_variance());
    arrays.extend(uncertainty("noise", frf.noise.as_ref(), noise));
    arrays.extend(uncertainty("total", frf.total.as_ref(), total));
    if let Some(condition) = &frf.condition {
        arrays.push(("condition".into(), NamedArray::list(condition)));
    }
    if let Some(resolution) = frf.relative_resolution {
        let resolution = NamedArray::list(&[resolution]);
        arrays.push(("relative_resolution".into(), resolution));
    }
    arrays
}

/// Variance, covariance and degrees of freedom; nothing where it was not measured.
fn uncertainty(
    name: &str,
    known: Option<&Uncertainty>,
    variance: Option<Array3<f64>>,
) -> Vec<(String, NamedArray)> {
    let (Some(known), Some(variance)) = (known, variance) else {
        return Vec::new();
    };
    let covariance = known.covariance.clone().into_dyn();
    let arrays = [
        ("variance", NamedArray::Real(variance.into_dyn())),
        ("covariance", NamedArray::Complex(covariance)),
        (
            "degrees_of_freedom",
            NamedArray::Count(known.degrees_of_freedom),
        ),
    ];
    let named = arrays.map(|(what, array)| (format!("{name}_{what}"), array));
    named.into()
}
