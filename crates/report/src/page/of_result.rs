//! Figure and page of one result, or of several in one picture: the same from the command line and
//! from Python.

use frfid_files::{Check, ResultFile, Verdict};
use frfid_signals::Frf;

use crate::diagrams::bode::{bode, bode_matrix};
use crate::diagrams::curve::{Band, Curve};
use crate::diagrams::labels::Labels;
use crate::diagrams::style::Style;
use crate::error::ReportError;
use crate::figure::Figure;
use crate::page::Report;
use crate::page::levels::level_figures;
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
    figure(&[(title, result)], result, true)
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
    results_page(title, &[(title, result)], notes)
}

/// The page of several results, each under its name: one picture with a curve for each, and the
/// verdicts, checks and provenance of all.
///
/// # Errors
/// [`ReportError::Channels`] for results of other channels than the first, [`ReportError`] for an
/// FRF that cannot be drawn, or no result.
pub fn results_page(
    title: &str,
    results: &[Named],
    notes: Vec<String>,
) -> Result<String, ReportError> {
    let report = Report {
        title: title.to_owned(),
        lead: None,
        claims: Vec::new(),
        verdicts: verdicts(results),
        checks: checks(results),
        parts: vec![part(results, notes)?],
        provenance: provenance(results),
    };
    report.html()
}

/// A result and the name it goes by.
pub(super) type Named<'a> = (&'a str, &'a ResultFile);

/// The FRFs as a part of their page: to look into, and as a figure in print.
fn part<'a>(results: &[Named<'a>], notes: Vec<String>) -> Result<Part<'a>, ReportError> {
    let &[(_, first), ref others @ ..] = results else {
        return Err(ReportError::empty("a page", "results"));
    };
    for (name, result) in others {
        check_channels(results[0], (name, result))?;
    }
    Ok(Part {
        title: "Frequency response".to_owned(),
        notes,
        tables: Vec::new(),
        responses: Some(Responses {
            title: "Bode diagram".to_owned(),
            curves: curves(results),
            labels: labels(first),
            still: Some((caption(results), still(results, first)?)),
        }),
        figures: level_figures(results)?,
    })
}

/// The figure for print: a large matrix shows its magnitudes only, so that it fits on a page.
fn still(results: &[Named], first: &ResultFile) -> Result<Figure, ReportError> {
    let (outputs, inputs) = (first.frf.n_outputs(), first.frf.n_inputs());
    figure(results, first, outputs.max(inputs) <= MOST_WITH_PHASE)
}

/// The Bode diagram of results that go together.
fn figure(results: &[Named], first: &ResultFile, with_phase: bool) -> Result<Figure, ReportError> {
    let (curves, labels) = (curves(results), labels(first));
    match curves[0].size() {
        (1, 1) => bode(&curves, 0, 0, &labels),
        _ => bode_matrix(&curves, &labels, with_phase, &[]),
    }
}

/// Refuses a result whose entries mean something else than those of the first.
fn check_channels((first, one): Named, (name, other): Named) -> Result<(), ReportError> {
    let (found, needed) = (channels(other), channels(one));
    if found == needed {
        return Ok(());
    }
    Err(ReportError::Channels {
        result: name.to_owned(),
        found,
        first: first.to_owned(),
        needed,
    })
}

/// Inputs and outputs in words: `joint_1 torque (N m) to joint_1 velocity (rad/s)`.
fn channels(result: &ResultFile) -> String {
    let named = |names: &[String], units: &[String]| {
        let named = names.iter().zip(units);
        let named = named.map(|(name, unit)| format!("{name} ({unit})"));
        named.collect::<Vec<_>>().join(", ")
    };
    format!(
        "{} to {}",
        named(&result.input_names, &result.input_units),
        named(&result.output_names, &result.output_units)
    )
}

/// What belongs to one of several results bears its name.
pub(super) fn of_result(results: &[Named], (name, _): Named, what: &str) -> String {
    match results {
        [_] => what.to_owned(),
        _ => format!("{name}: {what}"),
    }
}

fn verdicts(results: &[Named]) -> Vec<Verdict> {
    let all = results.iter().flat_map(|&named| {
        let verdicts = named.1.verdicts.iter().cloned();
        verdicts.map(move |verdict| Verdict {
            axis: of_result(results, named, &verdict.axis),
            ..verdict
        })
    });
    all.collect()
}

fn checks(results: &[Named]) -> Vec<Check> {
    let all = results.iter().flat_map(|&named| {
        let checks = named.1.checks.iter().cloned();
        checks.map(move |check| Check {
            name: of_result(results, named, &check.name),
            ..check
        })
    });
    all.collect()
}

/// Names and values; the plan follows from the description, which reads better.
fn provenance(results: &[Named]) -> Vec<(String, String)> {
    let all = results.iter().flat_map(|&named| {
        let lines = named
            .1
            .provenance
            .iter()
            .filter(|(name, _)| *name != "plan");
        lines.map(move |(name, value)| (of_result(results, named, name), value.clone()))
    });
    all.collect()
}

fn curves<'a>(results: &[Named<'a>]) -> Vec<Curve<'a>> {
    let curves = results.iter().map(|&(name, result)| curve(name, result));
    curves.collect()
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
fn caption(results: &[Named]) -> String {
    let responses = match results {
        [_] => "Frequency response",
        _ => "Frequency responses",
    };
    let mut all = results.iter().map(|(_, result)| shaded(&result.frf));
    let first = all.next().unwrap_or_default();
    let shaded = match all.all(|other| other == first) {
        true => first,
        false => "; shaded: 95 % region of the largest variance that each result has",
    };
    let flags = results.iter().flat_map(|(_, result)| &result.flagged);
    let ticked = match flags.flatten().any(|flagged| *flagged) {
        true => {
            "; ticks at the upper edge: lines at which what remains of the torque ripple exceeds the noise"
        }
        false => "",
    };
    format!("{responses}{shaded}{ticked}")
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
