//! Sample result of the tests: numbers that show any rounding, and what JSON has no word for.

use frfid_signals::{
    Amplitudes, Distortion, DistortionLevel, Frf, Harmonics, SignalLevels, Uncertainty,
};
use ndarray::Array3;
use num_complex::Complex64;

use crate::result::result_file::{Check, ResultFile};
use crate::result::verdict::{Cause, Verdict};

/// Levels of one input and two outputs, in part unknown.
fn distortion() -> Distortion {
    let level = DistortionLevel {
        frequency_hz: 0.1 + 0.2,
        n_lines: 12,
        excited: 1.0 / 3.0,
        noise: None,
        level: Some(0.1),
        low: 0.05,
        high: 0.2,
    };
    let signal = SignalLevels {
        odd: vec![level],
        even: vec![DistortionLevel {
            level: None,
            ..level
        }],
    };
    Distortion {
        inputs: vec![signal.clone()],
        outputs: vec![signal.clone(), signal],
    }
}

pub(crate) fn result() -> ResultFile {
    let entry = |(k, i, j): (usize, usize, usize)| {
        Complex64::new((k + i) as f64 / 3.0, -1.0 / (1 + k + j) as f64)
    };
    let mut response = Array3::from_shape_fn((4, 2, 1), entry);
    response[[2, 0, 0]] = Complex64::new(f64::NAN, f64::NAN);
    let amplitudes = |channels: usize| Amplitudes {
        amplitude: Array3::from_elem((channels, 2, 1), f64::NAN),
        floor: Array3::from_elem((channels, 2, 1), 0.1),
        deviation: (channels == 1).then(|| Array3::from_elem((1, 2, 1), 1.0 / 3.0)),
    };
    let covariance = Array3::from_shape_fn((4, 2, 2), entry);
    ResultFile {
        frf: Frf {
            frequency_hz: vec![0.1, 0.2, 0.1 + 0.2, 1.0 / 3.0],
            response,
            noise: Some(Uncertainty {
                covariance,
                degrees_of_freedom: 40.0,
            }),
            total: None,
            condition: Some(vec![1.0, 2.0, f64::INFINITY, 1.5]),
            relative_resolution: Some(0.125),
        },
        input_names: vec!["torque".into()],
        output_names: vec!["axis 1".into(), "axis \"2\"".into()],
        input_units: vec!["N m".into()],
        output_units: vec!["rad/s".into(), "rad/s".into()],
        verdicts: vec![Verdict {
            axis: "axis 1".into(),
            cause: Cause::Noise,
            found: Some(0.4),
            limit: 0.3,
        }],
        checks: vec![Check {
            name: "periods".into(),
            passed: false,
            found: "1".into(),
            needed: "2".into(),
            advice: "measure longer".into(),
        }],
        torque_rms_nm: Some(vec![1.0 / 3.0]),
        flagged: Some(vec![false, true, false, false]),
        harmonics: Some(Harmonics {
            frequency_hz: vec![0.1],
            orders: vec![1, 2],
            input: amplitudes(1),
            output: amplitudes(2),
            response: None,
        }),
        distortion: Some(distortion()),
        provenance: [("seed".to_string(), "1".to_string())].into(),
    }
}
