//! Outputs of successive periods without what changes of the input explain: a shaker that warms up
//! changes both, and their ratio has settled all the same.

use std::borrow::Borrow;

use frfid_signals::Frf;
use ndarray::Array2;
use num_complex::Complex64;

use crate::spectra::run_spectra::RunSpectra;

/// `Y_q - G (U_q - U)` of the periods q of a run, U the mean of its `U_q`, each `(output, line)`; on
/// lines where the FRF is not known the mean of `Y_q`. Empty where the FRF does not fit the spectra.
#[must_use]
pub fn without_input_changes(
    periods: &[impl Borrow<RunSpectra>],
    frf: &Frf,
) -> Vec<Array2<Complex64>> {
    let Some(first) = periods.first().map(Borrow::borrow) else {
        return Vec::new();
    };
    let n_lines = frf.n_frequencies();
    if first.u.dim() != (frf.n_inputs(), n_lines) || first.y.dim() != (frf.n_outputs(), n_lines) {
        return Vec::new();
    }
    let mean_u = mean(periods, |run| &run.u);
    let mean_y = mean(periods, |run| &run.y);
    let of_period = |run: &RunSpectra| {
        let mut rest = run.y.clone();
        let changes = &run.u - &mean_u;
        for (line, g) in frf.response.outer_iter().enumerate() {
            let explained = g.dot(&changes.column(line));
            let is_known = explained.iter().all(|value| value.is_finite());
            for (output, value) in rest.column_mut(line).iter_mut().enumerate() {
                *value = match is_known {
                    true => *value - explained[output],
                    false => mean_y[[output, line]],
                };
            }
        }
        rest
    };
    periods.iter().map(|run| of_period(run.borrow())).collect()
}

fn mean(
    periods: &[impl Borrow<RunSpectra>],
    signal: impl Fn(&RunSpectra) -> &Array2<Complex64>,
) -> Array2<Complex64> {
    let mut mean = Array2::zeros(
        periods
            .first()
            .map_or((0, 0), |run| signal(run.borrow()).dim()),
    );
    for run in periods {
        mean += signal(run.borrow());
    }
    mean / Complex64::from(periods.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{Array3, array};
    use std::iter::zip;

    #[test]
    fn what_the_input_explains_goes_and_the_rest_stays() {
        let complex = |re: f64| Complex64::new(re, 0.5);
        let g = Array3::from_shape_fn((2, 1, 1), |(line, ..)| complex(line as f64));
        let frf = Frf::new(vec![1.0, 2.0], g.clone()).expect("sound");
        let run = |gain: f64, rest: f64| {
            let u = array![[complex(3.0) * gain, complex(1.0) * gain]];
            let y = array![[g[[0, 0, 0]] * u[[0, 0]] + rest, g[[1, 0, 0]] * u[[0, 1]]]];
            RunSpectra { u, y, r: None }
        };
        let found = without_input_changes(&[run(1.0, 0.0), run(0.5, 0.25), run(0.2, 0.0)], &frf);
        let changes: Vec<f64> = zip(&found, &found[1..])
            .map(|(a, b)| (b - a).iter().map(|value| value.norm()).sum())
            .collect();
        assert!(zip(changes, [0.25, 0.25]).all(|(found, needed)| (found - needed).abs() < 1e-12));
        let unknown = Frf::new(vec![1.0, 2.0], g.mapv(|_| Complex64::from(f64::NAN)));
        let found =
            without_input_changes(&[run(1.0, 0.0), run(0.5, 0.25)], &unknown.expect("sound"));
        assert_eq!(found[0], found[1]);
        assert!(without_input_changes(&[] as &[RunSpectra], &frf).is_empty());
    }
}
