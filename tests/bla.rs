//! The best linear approximation against numpy and against chance: golden numbers, coverage of the confidence region, and
//! the bias of the direct estimate when the input is measured with noise.

use frfid::estimate::{Averaging, BlaOptions, estimate_bla};
use frfid::signals::{Frf, Uncertainty};
use ndarray::{Array5, ShapeBuilder};
use num_complex::Complex64;
use serde_json::Value;

/// The signal formula of tests/golden/bla.py.
fn hash(indices: &[usize]) -> f64 {
    const PRIME: i64 = 1_000_003;
    let mut k = indices[0] as i64;
    for &index in &indices[1..] {
        k = (k * 31 + index as i64 * 7919 + 17) % PRIME;
        k = (k * k + 12345) % PRIME;
    }
    ((k * k * 3 + 5 * k + 1) % PRIME) as f64 / PRIME as f64 - 0.5
}

fn signal(kind: usize, shape: [usize; 5]) -> Array5<f64> {
    Array5::from_shape_fn(shape, |(p, m, q, c, k)| {
        hash(&[kind, p, m, c, k]) + 0.1 * hash(&[kind + 10, p, m, q, c, k]) + 3.0
    })
}

fn count(entry: &Value, name: &str) -> usize {
    entry[name].as_u64().expect("a count") as usize
}

/// Largest difference between two lists over the largest entry on the same line.
fn worst(found: &[Complex64], golden: &Value, n_lines: usize) -> f64 {
    let flat: Vec<f64> = golden.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect();
    let golden: Vec<Complex64> = flat.chunks(2).map(|pair| Complex64::new(pair[0], pair[1])).collect();
    assert_eq!(found.len(), golden.len());
    let lines = found.chunks(found.len() / n_lines).zip(golden.chunks(golden.len() / n_lines));
    lines
        .map(|(found, golden)| {
            let size = golden.iter().map(|g| g.norm()).fold(0.0, f64::max);
            found.iter().zip(golden).map(|(f, g)| (f - g).norm() / size).fold(0.0, f64::max)
        })
        .fold(0.0, f64::max)
}

fn assert_same(known: Option<&Uncertainty>, golden: &Value, n_lines: usize, freedom: usize, what: &str) {
    match known {
        None => assert!(golden.is_null(), "{what} was not estimated"),
        Some(known) => {
            let worst = worst(known.covariance.as_slice().expect("contiguous"), golden, n_lines);
            assert!(worst < 1e-12, "{what}: {worst:e}");
            assert_eq!(known.degrees_of_freedom, freedom);
        }
    }
}

fn check(entry: &Value, frf: &Frf) {
    let what = format!("{} {}", entry["case"], entry["method"]);
    let (n_p, n_q, n_lines) = (count(entry, "n_p"), count(entry, "n_q"), frf.n_frequencies());
    let worst = worst(frf.response.as_slice().expect("contiguous"), &entry["response"], n_lines);
    assert!(worst < 1e-12, "{what}: {worst:e}");
    assert_same(frf.noise.as_ref(), &entry["noise"], n_lines, n_p * (n_q - 1), &format!("{what} noise"));
    assert_same(frf.total.as_ref(), &entry["total"], n_lines, n_p - 1, &format!("{what} total"));
    let golden = entry["condition"].as_array().expect("a list").iter().map(|c| c.as_f64().expect("a number"));
    for (found, golden) in frf.condition.as_ref().expect("U was inverted").iter().zip(golden) {
        assert!((found / golden - 1.0).abs() < 1e-12, "{what}: condition {found} for {golden}");
    }
}

/// Mixed channels, n_y other than n_u, n_ex > n_u, periods of 2500, 8192, 12288 and 19838 samples, arrays laid out with
/// the last axis first in memory: mean, both covariances and condition to 1e-12.
#[test]
fn bla_agrees_with_numpy() {
    let golden: Vec<Value> = serde_json::from_str(include_str!("golden/bla.json")).expect("the golden file is JSON");
    assert_eq!(golden.len(), 12);
    for entry in &golden {
        let shape = |channels| {
            [
                count(entry, "n_p"),
                count(entry, "n_ex"),
                count(entry, "n_q"),
                count(entry, channels),
                count(entry, "n_samples"),
            ]
        };
        let fortran = |kind, channels| {
            let mut turned = Array5::zeros(shape(channels).f());
            turned.assign(&signal(kind, shape(channels)));
            turned
        };
        let (u, y, r) = (fortran(1, "n_u"), fortran(2, "n_y"), signal(3, shape("n_u")));
        let averaging = if entry["method"] == "spectra" { Averaging::Spectra } else { Averaging::Frfs };
        let r = (entry["method"] == "indirect").then(|| r.view());
        let lines: Vec<usize> =
            entry["lines"].as_array().expect("a list").iter().map(|l| l.as_u64().expect("a line") as usize).collect();
        let options = BlaOptions { averaging, ..Default::default() };
        check(entry, &estimate_bla(u.view(), y.view(), r, 1e-3, &lines, &options).expect("sound"));
    }
}
