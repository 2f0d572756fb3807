//! Results: what belongs to an FRF besides its numbers, `frfid.load`, and the picture.

use std::path::PathBuf;

use frfid_files::{ResultFile, read_result};
use frfid_report::{Band, Curve, Labels, ReportError, Style, bode, bode_matrix};
use frfid_signals::{Frf as Response, Uncertainty};
use pyo3::prelude::*;

use crate::error;
use crate::frf::Frf;

/// An FRF of which only the numbers are known: channels are numbered, their units empty.
impl From<Response> for Frf {
    fn from(frf: Response) -> Self {
        let (n_inputs, n_outputs) = (frf.n_inputs(), frf.n_outputs());
        let numbered = |word: &str, count: usize| {
            (1..=count)
                .map(|channel| format!("{word} {channel}"))
                .collect()
        };
        Self::of(ResultFile {
            frf,
            input_names: numbered("input", n_inputs),
            output_names: numbered("output", n_outputs),
            input_units: vec![String::new(); n_inputs],
            output_units: vec![String::new(); n_outputs],
            checks: Vec::new(),
            provenance: [(
                "frfid_version".to_owned(),
                env!("CARGO_PKG_VERSION").to_owned(),
            )]
            .into(),
        })
    }
}

/// Reads a result: what ``Frf.save`` or ``frfid estimate`` wrote.
///
/// Parameters
/// ----------
/// path : str or path-like
///     The JSON file.
///
/// Returns
/// -------
/// Frf
///
/// Raises
/// ------
/// OSError
///     If the file cannot be read.
/// ValueError
///     If it is no result, or contradicts itself.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf) -> PyResult<Frf> {
    path.metadata()?;
    Ok(Frf::of(
        py.detach(|| read_result(&path)).map_err(error::file)?,
    ))
}

/// Size, band and which variances are known, in one line.
pub fn described(frf: &Response) -> String {
    let hz = &frf.frequency_hz;
    let (low, high) = (
        hz.first().copied().unwrap_or(f64::NAN),
        hz.last().copied().unwrap_or(f64::NAN),
    );
    let measured = |known: &Option<Uncertainty>| if known.is_some() { "measured" } else { "None" };
    format!(
        "<frfid.Frf: {} outputs x {} inputs at {} frequencies from {low:.4} Hz to {high:.4} Hz, noise variance {}, \
         total variance {}>",
        frf.n_outputs(),
        frf.n_inputs(),
        hz.len(),
        measured(&frf.noise),
        measured(&frf.total)
    )
}

/// The Bode diagram of a result as SVG, with the 95 % region of the largest variance that was
/// measured.
pub fn svg(result: &ResultFile) -> Result<String, ReportError> {
    let ResultFile {
        frf,
        input_names,
        output_names,
        input_units,
        output_units,
        ..
    } = result;
    let band = if frf.total.is_some() {
        Band::Total
    } else {
        Band::Noise
    };
    let curves = [Curve {
        label: "G".into(),
        frf,
        style: Style::Line,
        band,
        flagged: None,
    }];
    let gain_unit = match (output_units.first(), input_units.first()) {
        (Some(output), Some(input)) if !output.is_empty() && !input.is_empty() => {
            format!("{output} per {input}")
        }
        _ => "output per input".to_owned(),
    };
    let labels = Labels {
        inputs: input_names.clone(),
        outputs: output_names.clone(),
        gain_unit,
    };
    let single = (frf.n_outputs(), frf.n_inputs()) == (1, 1);
    let figure = if single {
        bode(&curves, 0, 0, &labels)?
    } else {
        bode_matrix(&curves, &labels, true, &[])?
    };
    Ok(figure.svg())
}
