//! Arrays of a result by name, as numpy and MATLAB get them.

use frfid_signals::Uncertainty;
use ndarray::{Array3, ArrayViewD, CowArray, IxDyn, aview1};
use num_complex::Complex64;

use crate::result::result_file::ResultFile;

/// An array of a result.
pub(crate) enum NamedArray<'a> {
    Real(CowArray<'a, f64, IxDyn>),
    Complex(ArrayViewD<'a, Complex64>),
    Number(f64),
    Flags(&'a [bool]),
    Texts(&'a [String]),
}

/// The arrays of a result with their names: `frequency_hz`, `response` (frequency, output, input)
/// and, where known, `noise_variance`, `noise_covariance`, `noise_degrees_of_freedom`, the same for
/// `total`, `condition`, `relative_resolution`, `torque_rms_nm`, `flagged`; names and units of
/// inputs and outputs.
pub(crate) fn named_arrays(result: &ResultFile) -> Vec<(String, NamedArray<'_>)> {
    let frf = &result.frf;
    let response = NamedArray::Complex(frf.response.view().into_dyn());
    let mut arrays = vec![
        ("frequency_hz".into(), reals(&frf.frequency_hz)),
        ("response".into(), response),
    ];
    let (noise, total) = (frf.noise_variance(), frf.total_variance());
    arrays.extend(uncertainty("noise", frf.noise.as_ref(), noise));
    arrays.extend(uncertainty("total", frf.total.as_ref(), total));
    let lists = [
        ("condition", frf.condition.as_deref()),
        (
            "relative_resolution",
            frf.relative_resolution.as_ref().map(std::slice::from_ref),
        ),
        ("torque_rms_nm", result.torque_rms_nm.as_deref()),
    ];
    for (name, list) in lists {
        arrays.extend(list.map(|list| (name.into(), reals(list))));
    }
    let flagged = result.flagged.as_deref().map(NamedArray::Flags);
    arrays.extend(flagged.map(|flags| ("flagged".into(), flags)));
    let texts = [
        ("input_names", &result.input_names),
        ("output_names", &result.output_names),
        ("input_units", &result.input_units),
        ("output_units", &result.output_units),
    ];
    arrays.extend(texts.map(|(name, texts)| (name.into(), NamedArray::Texts(texts))));
    arrays
}

fn reals(list: &[f64]) -> NamedArray<'_> {
    NamedArray::Real(aview1(list).into_dyn().into())
}

/// Variance, covariance and degrees of freedom; nothing where it was not measured.
fn uncertainty<'a>(
    name: &str,
    known: Option<&'a Uncertainty>,
    variance: Option<Array3<f64>>,
) -> Vec<(String, NamedArray<'a>)> {
    let (Some(known), Some(variance)) = (known, variance) else {
        return Vec::new();
    };
    let variance = NamedArray::Real(variance.into_dyn().into());
    let covariance = NamedArray::Complex(known.covariance.view().into_dyn());
    let freedom = NamedArray::Number(known.degrees_of_freedom);
    vec![
        (format!("{name}_variance"), variance),
        (format!("{name}_covariance"), covariance),
        (format!("{name}_degrees_of_freedom"), freedom),
    ]
}
