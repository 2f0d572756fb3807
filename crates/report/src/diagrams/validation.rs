//! Validation of curves, their labels and marks.

use crate::diagrams::curve::Curve;
use crate::diagrams::labels::Labels;
use crate::diagrams::mark::Mark;
use crate::error::ReportError;
use crate::validation;

/// Number of outputs and inputs.
type Size = (usize, usize);

/// Refuses no curves, curves of different sizes, labels that do not fit them, and frequencies a
/// logarithmic axis cannot hold. Returns the number of outputs and inputs.
pub(crate) fn check_curves(
    figure: &'static str,
    curves: &[Curve],
    labels: &Labels,
) -> Result<Size, ReportError> {
    let first = curves.first();
    let size = first.ok_or(ReportError::empty(figure, "curves"))?.size();
    for curve in curves {
        check_curve(curve, size)?;
    }
    if curves.iter().all(|curve| curve.frf.frequency_hz.is_empty()) {
        return Err(ReportError::empty(figure, "frequencies"));
    }
    let names = (labels.outputs.len(), labels.inputs.len());
    check_size("the list of channel names".to_owned(), names, size)?;
    Ok(size)
}

/// Refuses a curve that is not of the figure's size or not sound in itself.
fn check_curve(curve: &Curve, size: Size) -> Result<(), ReportError> {
    let Curve {
        label,
        frf,
        flagged,
        ..
    } = curve;
    check_size(format!("curve \"{label}\""), curve.size(), size)?;
    frf.check()?;
    if let Some(flagged) = flagged {
        validation::length(
            &format!("flagged of curve \"{label}\""),
            flagged.len(),
            frf.n_frequencies(),
        )?;
    }
    validation::log_frequencies(
        &format!("a frequency_hz of curve \"{label}\""),
        frf.frequency_hz.iter().copied(),
    )
}

/// Refuses anything that is not of the figure's size.
fn check_size(
    what: String,
    (found_outputs, found_inputs): Size,
    (outputs, inputs): Size,
) -> Result<(), ReportError> {
    if (found_outputs, found_inputs) == (outputs, inputs) {
        Ok(())
    } else {
        Err(ReportError::Size {
            what,
            found_outputs,
            found_inputs,
            outputs,
            inputs,
        })
    }
}

/// Refuses an entry outside of an `outputs` x `inputs` matrix.
pub(crate) fn check_entry(
    curve: &Curve,
    (output, input): (usize, usize),
    (outputs, inputs): Size,
) -> Result<(), ReportError> {
    if output < outputs && input < inputs {
        Ok(())
    } else {
        Err(ReportError::NoSuchEntry {
            curve: curve.label.clone(),
            outputs,
            inputs,
            output,
            input,
        })
    }
}

/// Refuses marks that belong to no curve or no entry of a matrix.
pub(crate) fn check_marks(marks: &[Mark], curves: &[Curve], size: Size) -> Result<(), ReportError> {
    for mark in marks {
        let needed = "the number of a curve, from 0";
        validation::value("the curve of a mark", mark.curve as f64, needed, |_| {
            mark.curve < curves.len()
        })?;
        check_entry(&curves[mark.curve], mark.entry(), size)?;
    }
    Ok(())
}
