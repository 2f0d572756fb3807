//! `frfid.estimate_local`.

use frfid_estimate::{LocalOptions, Method, Piece, estimate_local as estimate, find_repetition};
use frfid_files::Check;
use frfid_signals::format::significant;
use ndarray::{ArrayView, ArrayView2, Axis, Ix2, IxDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::array::{Axes, real};
use crate::error;
use crate::estimate::periods::checked;
use crate::frf::matrix::Frf;
use crate::size::List;
use crate::threads::detached;
use crate::warnings::warn;

/// A record that repeats for more than this share of its time is periodic.
const MOST: f64 = 0.8;

const RECORDS: [Axes; 2] = [&["channel", "sample"], &["record", "channel", "sample"]];

/// FRF by local rational models from records of any excitation: noise, chirps, a period from rest; transients and
/// leakage are modelled. One record is enough for several inputs that are excited independently.
///
/// Around each frequency every row of the FRF, and what the ends of a record leave, is a rational function of
/// order two: exact where one mode lies within the band, however little it is damped. With ``r`` outputs and
/// inputs are both estimated from it, so that noise in the loop does not bias their quotient.
///
/// Parameters
/// ----------
/// u, y : array_like, shape (channel, sample) or (record, channel, sample)
///     Plant input and output.
/// sample_time_s : float
///     Sample time in s.
/// frequencies_hz : sequence of float
///     Where to estimate, rising, in Hz; any number, also between the lines of the record.
/// r : array_like, shape as u, optional
///     Reference.
/// method : str, optional
///     ``"local-rational"``, or ``"local-polynomial"`` (LPM): fewer unknowns, right where the FRF is smooth from line
///     to line.
/// half_width : int, optional
///     Lines of the record to either side of a frequency. Without it, at each frequency the most that agree with
///     all fewer: what the choice leaves of bias is then part of the variance.
///
/// Returns
/// -------
/// Frf
///     With the total variance, of noise and distortion, which within a band cannot be told apart; NaN at
///     frequencies around which an input is not excited or inputs are alike, which a failed check names. Another one
///     says, with a warning, that what excites repeats: ``estimate`` does better then.
///
/// Raises
/// ------
/// ValueError
///     For shapes that do not fit, samples that are not finite, frequencies outside of the band, records too short.
/// NumericalError
///     If the inputs can be told apart at no frequency.
#[pyfunction]
#[pyo3(signature = (u, y, *, sample_time_s, frequencies_hz, method = "local-rational", r = None, half_width = None))]
#[expect(clippy::too_many_arguments, reason = "keyword-only in Python")]
pub(crate) fn estimate_local(
    py: Python<'_>,
    u: &Bound<'_, PyAny>,
    y: &Bound<'_, PyAny>,
    sample_time_s: f64,
    frequencies_hz: List<f64>,
    method: &str,
    r: Option<&Bound<'_, PyAny>>,
    half_width: Option<usize>,
) -> PyResult<Frf> {
    let u = real::<IxDyn>("u", u, &RECORDS)?;
    let y = real::<IxDyn>("y", y, &RECORDS)?;
    let r = r.map(|r| real::<IxDyn>("r", r, &RECORDS)).transpose()?;
    let (u, y, r) = (u.as_array(), y.as_array(), r.as_ref().map(|r| r.as_array()));
    let (u, y, r) = (records(&u), records(&y), r.as_ref().map(records));
    check_numbers(u.len(), y.len(), r.as_ref().map(Vec::len))?;
    let piece = |k: usize| Piece {
        u: u[k],
        y: y[k],
        r: r.as_ref().map(|r| r[k]),
    };
    let pieces: Vec<Piece> = (0..u.len()).map(piece).collect();
    let options = LocalOptions {
        model: local_method(method, "")?.local_model().unwrap_or_default(),
        half_width,
        ..LocalOptions::default()
    };
    let estimate = || estimate(&pieces, sample_time_s, &frequencies_hz.0, &options);
    let estimate = detached(py, estimate)?.map_err(error::estimate)?.estimate;
    let mut result = checked(estimate).result;
    if let Some(check) = detached(py, || pieces.iter().find_map(repeats))? {
        warn(py, [format!("{}; {}", check.found, check.advice)])?;
        result.checks.push(check);
    }
    Ok(Frf::of(result))
}

/// The check that fails where what excites repeats: then few lines are excited and the others tell nothing.
fn repeats(piece: &Piece) -> Option<Check> {
    let exciting = piece.r.unwrap_or(piece.u);
    let found = find_repetition(exciting, None).ok()?;
    let n_samples = exciting.len_of(Axis(1));
    let n_repeating: usize = found.runs.iter().map(ExactSizeIterator::len).sum();
    let n_periods = found.n_periods(n_samples);
    let is_whole = n_periods > 1 && n_repeating as f64 > MOST * n_samples as f64;
    is_whole.then(|| Check {
        name: "periods".into(),
        passed: false,
        found: format!(
            "what excites repeats after {} samples, {n_periods} times: one line in {n_periods} is excited, and few lie around \
             a frequency",
            significant(found.period, 8)
        ),
        needed: "nothing that repeats".into(),
        advice: "give the periods to frfid.estimate(..., method=\"local-rational\"), which averages them and knows their noise"
            .into(),
    })
}

/// A method that fits local models, by its name; what else would do is named beside them.
pub(super) fn local_method(name: &str, others: &str) -> PyResult<Method> {
    match name {
        "local-rational" => Ok(Method::LocalRational),
        "local-polynomial" => Ok(Method::LocalPolynomial),
        _ => Err(PyValueError::new_err(format!(
            "method: unknown variant `{name}`, expected {others}`local-rational` or `local-polynomial`"
        ))),
    }
}

/// The records one by one; a single one may stand without its axis.
fn records<'a>(signal: &'a ArrayView<'a, f64, IxDyn>) -> Vec<ArrayView2<'a, f64>> {
    let one = |record: ArrayView<'a, f64, IxDyn>| record.into_dimensionality::<Ix2>().ok();
    match signal.ndim() {
        2 => one(signal.view()).into_iter().collect(),
        _ => signal.axis_iter(Axis(0)).filter_map(one).collect(),
    }
}

fn check_numbers(u: usize, y: usize, r: Option<usize>) -> PyResult<()> {
    if u == y && r.is_none_or(|r| r == u) {
        return Ok(());
    }
    let r = r.map_or(String::new(), |r| format!(", r of {r}"));
    Err(PyValueError::new_err(format!(
        "u is of {u} records, y of {y}{r}: needed one of each"
    )))
}
