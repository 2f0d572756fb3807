//! Phases shared by the channels of an experiment lead to another best linear approximation of a machine
//! whose nonlinearity couples them.

use std::f64::consts::TAU;

use frfid_estimate::{FrfOptions, Method, estimate_bla};
use frfid_signals::Frf;
use frfid_signals::random::{phase, stream};
use ndarray::{Array5, Axis};

const SAMPLES: usize = 128;
const LINES: [usize; 8] = [1, 3, 5, 7, 9, 11, 13, 15];
const REALIZATIONS: usize = 300;

/// `y_1 = u_1 + 0.2 u_1 u_2^2`, y_2 the other way round, for inputs of variance 1; two experiments,
/// orthogonal phases or a draw for each channel and experiment.
fn bla(is_shared: bool) -> Frf {
    let sizes = (REALIZATIONS, 2, 1, 2, SAMPLES);
    let mut u = Array5::zeros(sizes);
    for (p, mut realization) in u.outer_iter_mut().enumerate() {
        for (m, mut experiment) in realization.outer_iter_mut().enumerate() {
            for channel in 0..2 {
                let draw = if is_shared { [0, 0] } else { [m, channel] };
                let mut rng = stream(1, "phases", &[p, draw[0], draw[1]].map(|i| i as u64));
                let turn = if is_shared {
                    0.5 * (m * channel) as f64
                } else {
                    0.0
                };
                for line in LINES {
                    let start = phase(&mut rng) + TAU * turn;
                    for k in 0..SAMPLES {
                        let angle = TAU * (line * k) as f64 / SAMPLES as f64 + start;
                        experiment[[0, channel, k]] +=
                            (2.0 / LINES.len() as f64).sqrt() * angle.cos();
                    }
                }
            }
        }
    }
    let mut other = u.clone();
    other.invert_axis(Axis(3));
    let y = &u + 0.2 * &u * &other * &other;
    let options = FrfOptions::from(Method::LeastSquares);
    estimate_bla(u.view(), y.view(), None, 1e-3, &LINES, &options).expect("excited")
}

/// With `u_2 = +-u_1` the coupling acts as the cube of one signal, `3 E u^2`, with independent inputs as
/// `E u^2`: neither total variance holds the other.
#[test]
fn shared_phases_approximate_a_coupled_machine_otherwise() {
    let [shared, independent] = [true, false].map(bla);
    let gain = |frf: &Frf| {
        let lines = 0..LINES.len();
        lines
            .map(|line| frf.response[[line, 0, 0]].re - 1.0)
            .sum::<f64>()
            / LINES.len() as f64
    };
    let (shared_gain, independent_gain) = (gain(&shared), gain(&independent));
    println!(
        "0.2 u_1 u_2^2 adds {shared_gain:.3} by shared phases, {independent_gain:.3} by independent ones"
    );
    assert!((independent_gain / 0.2 - 1.0).abs() < 0.1);
    assert!((shared_gain / independent_gain - 3.0).abs() < 0.4);
    let region = |frf: &Frf| {
        let total = frf.total.as_ref().expect("many realizations");
        total.covariance[[0, 0, 0]].re * total.confidence_factor_95()
    };
    let difference = (shared.response[[0, 0, 0]] - independent.response[[0, 0, 0]]).norm_sqr();
    assert!(difference > 4.0 * region(&shared) && difference > 4.0 * region(&independent));
}
