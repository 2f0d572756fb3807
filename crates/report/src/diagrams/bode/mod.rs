//! Bode diagrams: magnitude in dB above phase in degrees, over a logarithmic frequency axis in Hz.

pub(crate) mod cell;
pub(crate) mod phase;
pub(crate) mod sheet;

use crate::diagrams::bode::sheet::Sheet;
use crate::diagrams::curve::Curve;
use crate::diagrams::labels::Labels;
use crate::diagrams::mark::Mark;
use crate::diagrams::style::inks;
use crate::diagrams::validation::{check_curves, check_entry, check_marks};
use crate::error::ReportError;
use crate::figure::Figure;

/// Width that a matrix is given, and that of a cell at least and at most, in pixels.
const ACROSS: f64 = 1100.0;
const CELL: (f64, f64) = (170.0, 260.0);

/// Bode diagram of one entry `(output, input)` of several FRFs: magnitude above, phase below, as in
/// SK15 figures 4 and 5.
///
/// Magnitude in dB relative to 1 `labels.gain_unit`; phase in degrees, wrapped into (-180, 180],
/// with gaps where it wraps. Lines that are not finite, or zero, are left out. The shaded band is
/// the 95 % region |dG| <= rho of each entry: 20 lg(|G| -+ rho) and arg G -+ asin(rho / |G|).
///
/// # Errors
/// [`ReportError`] if there are no curves, they differ in size, `labels` does not fit, or a
/// frequency is not above zero.
pub fn bode(
    curves: &[Curve],
    output: usize,
    input: usize,
    labels: &Labels,
) -> Result<Figure, ReportError> {
    let size = check_curves("a Bode diagram", curves, labels)?;
    check_entry(&curves[0], (output, input), size)?;
    Ok(Sheet {
        curves,
        inks: inks(curves.iter().map(Curve::look)),
        labels,
        marks: &[],
        rows: vec![output],
        columns: vec![input],
        width: 540.0,
        magnitude: 230.0,
        phase: Some(160.0),
    }
    .draw())
}

/// Bode diagrams of all entries, one row per output and one column per input, on common axes.
///
/// With `with_phase` every magnitude has its phase below it; without, the figure holds magnitudes
/// only (SK15 figures 8-10). `marks` point out magnitudes, as figure 9 does with peaks.
///
/// # Errors
/// As [`bode`], or if a mark belongs to no curve or entry.
pub fn bode_matrix(
    curves: &[Curve],
    labels: &Labels,
    with_phase: bool,
    marks: &[Mark],
) -> Result<Figure, ReportError> {
    let (outputs, inputs) = check_curves("a matrix of Bode diagrams", curves, labels)?;
    check_marks(marks, curves, (outputs, inputs))?;
    Ok(Sheet {
        curves,
        inks: inks(curves.iter().map(Curve::look)),
        labels,
        marks,
        rows: (0..outputs).collect(),
        columns: (0..inputs).collect(),
        width: (ACROSS / inputs as f64).clamp(CELL.0, CELL.1),
        magnitude: 150.0,
        phase: with_phase.then_some(100.0),
    }
    .draw())
}
