//! Comparison of FRFs with lines of which nothing is known.

use frfid_estimate::{CompareOptions, EstimateError, Sides, compare, find_features};
use frfid_signals::Frf;
use ndarray::Array3;
use num_complex::Complex64;

/// A resonator of 5 % damping; every so many lines, from `first` on, are unknown.
fn resonator(resonance_hz: f64, first: usize, every: usize) -> Frf {
    let hz: Vec<f64> = (0..400)
        .map(|k| 2.0 * 25f64.powf(f64::from(k) / 399.0))
        .collect();
    let response = Array3::from_shape_fn((400, 1, 1), |(k, ..)| {
        let ratio = hz[k] / resonance_hz;
        let value = Complex64::ONE / Complex64::new(1.0 - ratio * ratio, 0.1 * ratio);
        let is_unknown = k >= first && (k - first).is_multiple_of(every);
        if is_unknown {
            Complex64::new(f64::NAN, f64::NAN)
        } else {
            value
        }
    });
    Frf::new(hz, response).expect("shapes agree")
}

#[test]
fn unknown_lines_are_left_out_and_counted() {
    let options = CompareOptions::default();
    let (a, b) = (resonator(10.0, 0, 3), resonator(13.0, 1, 2));
    let found = compare(&a, &b, &options).expect("many lines are known");
    assert_eq!(found.unknown_lines, Sides { a: 134, b: 200 });
    let shift = found.entries[0].changes[0]
        .shift_percent()
        .expect("found in both");
    assert!((shift - 30.0).abs() < 1.0, "{shift}");
    assert!(found.entries[0].level_db.is_finite());
    let features = find_features(&a, 0, 0, 3.0);
    assert!(features.len() == 1 && (features[0].frequency_hz - 9.97).abs() < 0.1);
}

#[test]
fn nothing_known_is_no_common_band() {
    let (a, unknown) = (resonator(10.0, 400, 1), resonator(10.0, 0, 1));
    let refused = compare(&a, &unknown, &CompareOptions::default());
    assert!(matches!(
        refused,
        Err(EstimateError::NoCommonBand { found: 0, .. })
    ));
    assert!(find_features(&unknown, 0, 0, 3.0).is_empty());
}
