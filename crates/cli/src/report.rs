//! From results to figures and the HTML report.

use frfid_files::ResultFile;
use frfid_report::{
    Band, Curve, Labels, Part, Report, ReportError, Responses, Style, bode, bode_matrix,
};
use frfid_signals::Frf;

/// More frequencies than this are drawn as a line, fewer as markers.
const DENSE: usize = 150;

/// The report of one result.
///
/// # Errors
/// [`ReportError`] for an FRF that cannot be drawn.
pub(crate) fn html(
    title: &str,
    result: &ResultFile,
    notes: Vec<String>,
) -> Result<String, ReportError> {
    let curves = vec![Curve {
        label: title.to_owned(),
        frf: &result.frf,
        style: if result.frf.n_frequencies() > DENSE {
            Style::Line
        } else {
            Style::Markers
        },
        band: band(&result.frf),
        flagged: None,
    }];
    let labels = labels(result);
    let is_single = result.frf.n_outputs() * result.frf.n_inputs() == 1;
    let figure = if is_single {
        bode(&curves, 0, 0, &labels)
    } else {
        bode_matrix(&curves, &labels, true, &[])
    }?;
    // the plan follows from the description, which reads better
    let provenance = result
        .provenance
        .clone()
        .into_iter()
        .filter(|(name, _)| name != "plan")
        .collect();
    let part = Part {
        title: "Frequency response".to_owned(),
        notes,
        tables: Vec::new(),
        responses: Some(Responses {
            title: "Interactive diagram".to_owned(),
            curves,
            labels,
        }),
        figures: vec![(caption(&result.frf), figure)],
    };
    let report = Report {
        title: title.to_owned(),
        claims: Vec::new(),
        checks: result.checks.clone(),
        parts: vec![part],
        provenance,
    };
    report.html()
}

/// The widest region that is known.
fn band(frf: &Frf) -> Band {
    match (&frf.total, &frf.noise) {
        (Some(_), _) => Band::Total,
        (None, Some(_)) => Band::Noise,
        (None, None) => Band::None,
    }
}

fn caption(frf: &Frf) -> String {
    let shaded = match band(frf) {
        Band::Total => "; shaded: 95 % region of noise and nonlinear distortion",
        Band::Noise => "; shaded: 95 % region of the measurement noise",
        Band::None => "",
    };
    format!("Frequency response{shaded}")
}

/// Names of the channels; one unit of the gain where all entries share it.
fn labels(result: &ResultFile) -> Labels {
    let one = |units: &[String]| {
        units
            .first()
            .filter(|first| units.iter().all(|unit| unit == *first))
            .cloned()
    };
    let gain_unit = match (one(&result.output_units), one(&result.input_units)) {
        (Some(output), Some(input)) => format!("{output} per {input}"),
        _ => "output unit per input unit".to_owned(),
    };
    Labels {
        inputs: result.input_names.clone(),
        outputs: result.output_names.clone(),
        gain_unit,
    }
}
