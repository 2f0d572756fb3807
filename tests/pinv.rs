//! Graded matrices: FRFs of axes from wrist to base, and experiments of very different strength,
//! cost no digits.

use frfid::estimate::{Campaign, FrfOptions, PeriodIndex, RunSpectra, singular_values};
use nalgebra::DMatrix;
use ndarray::{Array2, s};
use num_complex::Complex64;
use serde_json::Value;

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array()
        .expect("a list")
        .iter()
        .map(|x| x.as_f64().expect("a number"))
        .collect()
}

/// A row-major list re, im, re, im, ... as a matrix.
fn matrix(list: &Value, rows: usize) -> Array2<Complex64> {
    let entries: Vec<Complex64> = numbers(list)
        .chunks(2)
        .map(|pair| Complex64::new(pair[0], pair[1]))
        .collect();
    Array2::from_shape_vec((rows, entries.len() / rows), entries).expect("whole rows")
}

/// G = Y U^+ as the estimator computes it: a campaign of one period on one line.
fn divide(y: &Array2<Complex64>, u: &Array2<Complex64>) -> Vec<Complex64> {
    let mut campaign = Campaign::new(vec![1.0]).expect("one frequency");
    for experiment in 0..u.ncols() {
        let column = |of: &Array2<Complex64>| of.slice(s![.., experiment..=experiment]).to_owned();
        let run = RunSpectra {
            u: column(u),
            y: column(y),
            r: None,
        };
        campaign
            .insert(
                PeriodIndex {
                    realization: 0,
                    period: 0,
                    experiment,
                },
                run,
            )
            .expect("fits");
    }
    campaign
        .estimate(&FrfOptions::default())
        .expect("full rank")
        .response
        .into_iter()
        .collect()
}

/// Against 60-digit arithmetic: every entry of G to 1e-12 and every singular value to 1e-13 of
/// itself where inputs or experiments are graded; to what the rounding of U itself leaves of a
/// value of 1e-6 where the grading is mixed away.
#[test]
fn graded_matrices_are_divided_and_rated_right() {
    let golden: Vec<Value> =
        serde_json::from_str(include_str!("golden/pinv.json")).expect("the golden file is JSON");
    assert_eq!(golden.len(), 6);
    for entry in &golden {
        let (u, y) = (
            matrix(
                &entry["u"],
                entry["n_u"].as_u64().expect("a count") as usize,
            ),
            matrix(&entry["y"], 2),
        );
        let response = divide(&y, &u).into_iter().zip(matrix(&entry["g"], 2));
        let worst = response
            .map(|(found, golden)| (found - golden).norm() / golden.norm())
            .fold(0.0, f64::max);
        let found = singular_values(&DMatrix::from_fn(u.nrows(), u.ncols(), |l, m| u[[l, m]]))
            .expect("finite");
        let values = found.iter().zip(numbers(&entry["singular_values"]));
        let worst_value = values
            .map(|(found, golden)| (found / golden - 1.0).abs())
            .fold(0.0, f64::max);
        println!(
            "{}: G {worst:.1e}, singular values {worst_value:.1e}",
            entry["case"]
        );
        let (slack, slack_value) = if entry["case"] == "mixed" {
            (1e-8, 1e-9)
        } else {
            (1e-12, 1e-13)
        };
        assert!(
            worst < slack && worst_value < slack_value,
            "{}: {worst:e}, {worst_value:e}",
            entry["case"]
        );
    }
}
