//! Payload of a page: its numbers as its script reads them, JSON with arrays as base64 of
//! little-endian float32.

use std::iter::zip;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use ndarray::Array3;
use serde::Serialize;

use crate::diagrams::curve::{Curve, confidence_radius};
use crate::diagrams::style::{Style, Swatch, swatches};
use crate::page::section::Responses;

/// Everything an interactive diagram needs.
#[derive(Serialize)]
struct Payload<'a> {
    inputs: &'a [String],
    outputs: &'a [String],
    curves: Vec<CurveData<'a>>,
}

/// One FRF; arrays are `(frequency, output, input)` in C order, absent where a variance was not
/// measured.
#[derive(Serialize)]
struct CurveData<'a> {
    label: &'a str,
    style: &'static str,
    color: usize,
    shape: usize,
    frequency_hz: String,
    re: String,
    im: String,
    noise_deviation: Option<String>,
    noise_factor: Option<f64>,
    total_deviation: Option<String>,
    total_factor: Option<f64>,
    nonlinear_deviation: Option<String>,
    flagged: Option<&'a [bool]>,
}

/// The data block of a page, a list with one part per diagram, safe inside
/// `<script type="application/json">`.
pub(crate) fn json(all: &[&Responses]) -> String {
    let payloads: Vec<Payload> = all.iter().map(|responses| payload(responses)).collect();
    let text =
        serde_json::to_string(&payloads).expect("strings and finite numbers always make JSON");
    // A script block ends at "</script" and may be misread at "<!--", wherever they stand: no "<"
    // is let through.
    text.replace('<', "\\u003c")
}

fn payload<'a>(Responses { curves, labels, .. }: &'a Responses) -> Payload<'a> {
    let places = swatches(curves.iter().map(Curve::look));
    Payload {
        inputs: &labels.inputs,
        outputs: &labels.outputs,
        curves: zip(curves, places).map(curve_data).collect(),
    }
}

fn curve_data<'a>((curve, swatch): (&'a Curve, Swatch)) -> CurveData<'a> {
    let Swatch { color, shape } = swatch;
    let frf = curve.frf;
    CurveData {
        label: &curve.label,
        style: match curve.style {
            Style::Reference => "reference",
            Style::Line => "line",
            Style::Markers => "markers",
        },
        color,
        shape,
        frequency_hz: float32(frf.frequency_hz.iter().copied()),
        re: float32(frf.response.iter().map(|value| value.re)),
        im: float32(frf.response.iter().map(|value| value.im)),
        noise_deviation: frf.noise_variance().map(deviation),
        noise_factor: frf.noise.as_ref().and_then(confidence_radius),
        total_deviation: frf.total_variance().map(deviation),
        total_factor: frf.total.as_ref().and_then(confidence_radius),
        nonlinear_deviation: frf.nonlinear_variance().map(deviation),
        flagged: curve.flagged.as_deref(),
    }
}

/// Standard deviations rather than variances: these keep within the range of float32.
fn deviation(variance: Array3<f64>) -> String {
    float32(
        variance
            .into_iter()
            .map(|value| value.clamp(0.0, f64::INFINITY).sqrt()),
    )
}

fn float32(values: impl Iterator<Item = f64>) -> String {
    STANDARD.encode(
        values
            .flat_map(|value| (value as f32).to_le_bytes())
            .collect::<Vec<u8>>(),
    )
}
