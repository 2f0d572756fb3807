//! Coverage where the mean of glides was subtracted from every run.

use frfid_estimate::{FrfEstimate, Method};

use crate::region::entries;
use crate::simulated::{Case, Phases};

fn noise(estimate: &FrfEstimate) -> f64 {
    entries(estimate, estimate.frf.noise.as_ref())
}

fn total(estimate: &FrfEstimate) -> f64 {
    entries(estimate, estimate.frf.total.as_ref())
}

/// The noise of the mean glide is in the noise variance, however few glides or repetitions; with two
/// glides one degree of freedom must do for most of the variance, and the region is wider than needed.
#[test]
fn the_noise_region_holds_with_any_number_of_glides() {
    for n_periods in [2, 5, 10] {
        for n_glides in [1, 2, 5, 20] {
            let case = Case {
                n_periods,
                n_glides,
                noise_u: 0.01,
                ..Case::default()
            };
            let estimate = case.estimate(Method::MeanOfSpectra);
            let (noise, total) = (noise(&estimate), total(&estimate));
            let freedom = estimate
                .frf
                .noise
                .as_ref()
                .map(|known| known.degrees_of_freedom);
            println!(
                "n_q {n_periods:2}, n_g {n_glides:2}: noise {noise:.1} %, total {total:.1} %, nu {:.2}",
                freedom.expect("measured")
            );
            assert!((93.0..98.7).contains(&noise), "{noise}");
            assert!((93.0..97.0).contains(&total), "{total}");
        }
    }
}

#[test]
fn every_method_knows_the_noise_of_the_glides() {
    for method in [
        Method::MeanOfFrfs,
        Method::LogarithmicMean,
        Method::LeastSquares,
    ] {
        for n_glides in [1, 5] {
            let case = Case {
                n_glides,
                n_channels: 3,
                ..Case::default()
            };
            let noise = noise(&case.estimate(method));
            println!("{method:?}, n_g {n_glides}: {noise:.1} %");
            assert!((93.0..97.0).contains(&noise), "{method:?}: {noise}");
        }
    }
}

/// The spread over realizations contains the glides' noise already, since their phases differ: what
/// distortion is left over is 0 on a linear machine, neither less nor more, glides or not.
#[test]
fn a_linear_machine_has_no_distortion_in_the_mean() {
    for (n_realizations, n_periods) in [(2, 2), (4, 3), (10, 4)] {
        for n_glides in [0, 1, 4] {
            let case = Case {
                n_realizations,
                n_periods,
                n_glides,
                ..Case::default()
            };
            let frf = case.estimate(Method::MeanOfFrfs).frf;
            let nonlinear = frf.nonlinear_variance().expect("both are known");
            let noise = frf.noise_variance().expect("measured") * n_realizations as f64;
            let share = nonlinear.sum() / noise.sum();
            let negative = nonlinear.iter().filter(|&&level| level < 0.0).count() as f64;
            let negative = negative / nonlinear.len() as f64;
            println!(
                "{n_realizations} x {n_periods}, {n_glides} glides: {share:.3} of the noise, {negative:.2} negative"
            );
            assert!(share.abs() < 0.09 && negative > 0.3);
        }
    }
}

/// Distortion keeps its level beside the noise of the glides.
#[test]
fn distortion_is_not_taken_for_noise() {
    let case = Case {
        n_glides: 2,
        distortion: 0.05,
        n_realizations: 8,
        phases: Phases::Orthogonal,
        ..Case::default()
    };
    let frf = case.estimate(Method::MeanOfFrfs).frf;
    let nonlinear = frf.nonlinear_variance().expect("both are known");
    let level = nonlinear.mean().expect("not empty");
    let expected = 0.05 * 0.05 / case.n_channels as f64;
    assert!(
        (level / expected - 1.0).abs() < 0.1,
        "{level:e}, {expected:e}"
    );
}
