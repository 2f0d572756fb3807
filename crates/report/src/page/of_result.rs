//! Figure and page of one result: the same from the command line and from Python.

use frfid_files::ResultFile;
use frfid_signals::Frf;

use crate::diagrams::bode::{bode, bode_matrix};
use crate::diagrams::curve::{Band, Curve};
use crate::diagrams::labels::Labels;
use crate::diagrams::style::Style;
use crate::error::ReportError;
use crate::figure::Figure;
use crate::page::Report;
use crate::page::section::{Part, Responses};

/// More frequencies than this are drawn as a line, fewer as markers.
const DENSE: usize = 150;

/// Outputs or inputs beyond which magnitudes alone are printed.
const MOST_WITH_PHASE: usize = 3;

/// The Bode diagram of a result, with the 95 % region of the largest variance that was measured.
///
/// ```
/// use frfid_files::ResultFile;
/// use frfid_report::result_figure;
/// use frfid_signals::Frf;
/// use ndarray::Array3;
/// use num_complex::Complex64;
///
/// let frf = Frf {
///     frequency_hz: vec![1.0, 10.0],
///     response: Array3::from_elem((2, 1, 1), Complex64::ONE),
///     noise: None,
///     total: None,
///     condition: None,
///     relative_resolution: None,
/// };
/// let result = ResultFile::torque_to_velocity(frf, &["joint_1".into()]);
/// assert!(result_figure("G", &result)?.svg().starts_with("<svg"));
/// # Ok::<(), frfid_report::ReportError>(())
/// ```
///
/// # Errors
/// [`ReportError`] for an FRF that cannot be drawn.
pub fn result_figure(title: &str, result: &ResultFile) -> Result<Figure, ReportError> {
    let (curves, labels) = ([curve(title, result)], labels(result));
    match curves[0].size() {
        (1, 1) => bode(&curves, 0, 0, &labels),
        _ => bode_matrix(&curves, &labels, true, &[]),
    }
}

/// The page of a result, with `notes` on what a careful reader should know.
///
/// # Errors
/// [`ReportError`] for an FRF that cannot be drawn.
pub fn result_page(
    title: &str,
    result: &ResultFile,
    notes: Vec<String>,
) -> Result<String, ReportError> {
    // the plan follows from the description, which reads better
    let provenance = result.provenance.clone().into_iter();
    let report = Report {
        title: title.to_owned(),
        lead: None,
        claims: Vec::new(),
        verdicts: result.verdicts.clone(),
        checks: result.checks.clone(),
        parts: vec![part(title, result, notes)?],
        provenance: provenance.filter(|(name, _)| name != "plan").collect(),
    };
    report.html()
}

/// The FRF as a part of its page: to look into, and as a figure in print.
fn part<'a>(
    title: &str,
    result: &'a ResultFile,
    notes: Vec<String>,
) -> Result<Part<'a>, ReportError> {
    Ok(Part {
        title: "Frequency response".to_owned(),
        notes,
        tables: Vec::new(),
        responses: Some(Responses {
            title: "Bode diagram".to_owned(),
            curves: vec![curve(title, result)],
            labels: labels(result),
            still: Some((caption(result), still(title, result)?)),
        }),
        figures: Vec::new(),
    })
}

/// The figure for print: a large matrix shows its magnitudes only, so that it fits on a page.
fn still(title: &str, result: &ResultFile) -> Result<Figure, ReportError> {
    let (curves, labels) = ([curve(title, result)], labels(result));
    let (outputs, inputs) = curves[0].size();
    if outputs.max(inputs) > MOST_WITH_PHASE {
        bode_matrix(&curves, &labels, false, &[])
    } else {
        result_figure(title, result)
    }
}

/// The FRF of a result as a curve.
fn curve<'a>(title: &str, result: &'a ResultFile) -> Curve<'a> {
    Curve {
        band: band(&result.frf),
        flagged: result.flagged.clone(),
        ..Curve::new(title, &result.frf, style(&result.frf))
    }
}

fn style(frf: &Frf) -> Style {
    if frf.n_frequencies() > DENSE {
        Style::Line
    } else {
        Style::Markers
    }
}

/// The widest region that is known.
fn band(frf: &Frf) -> Band {
    match (&frf.total, &frf.noise) {
        (Some(_), _) => Band::Total,
        (None, Some(_)) => Band::Noise,
        (None, None) => Band::None,
    }
}

/// What the figure shows, its shades and ticks included.
fn caption(result: &ResultFile) -> String {
    let shaded = shaded(&result.frf);
    let ticked = if result.flagged.iter().flatten().any(|flagged| *flagged) {
        "; ticks at the upper edge: lines at which what remains of the torque ripple exceeds the noise"
    } else {
        ""
    };
    format!("Frequency response{shaded}{ticked}")
}

fn shaded(frf: &Frf) -> &'static str {
    match (band(frf), frf.relative_resolution) {
        (Band::Total, _) => "; shaded: 95 % region of noise and nonlinear distortion",
        (Band::Noise, None) => "; shaded: 95 % region of the measurement noise",
        (Band::Noise, Some(_)) => {
            "; shaded: 95 % region of the measurement noise and the bias of the excerpts"
        }
        (Band::None, _) => "",
    }
}

/// Names of the channels; one unit of the gain where all entries share it.
fn labels(result: &ResultFile) -> Labels {
    Labels {
        inputs: result.input_names.clone(),
        outputs: result.output_names.clone(),
        gain_unit: gain_unit(result),
    }
}

fn gain_unit(result: &ResultFile) -> String {
    let output = common_unit(&result.output_units);
    match (output, common_unit(&result.input_units)) {
        (Some(output), Some(input)) => format!("{output} per {input}"),
        _ => "output unit per input unit".to_owned(),
    }
}

/// The unit that all channels share, if they do.
fn common_unit(units: &[String]) -> Option<&String> {
    let first = units.first().filter(|unit| !unit.is_empty())?;
    units.iter().all(|unit| unit == first).then_some(first)
}
