//! Coverage where some realizations are conditioned much worse than others: independent phases, as many
//! experiments as inputs.

use frfid_estimate::Method;

use crate::region::{entries, matrices};
use crate::simulated::{Case, Phases};

fn case(n_channels: usize, n_realizations: usize, n_periods: usize) -> Case {
    Case {
        n_channels,
        n_realizations,
        n_periods,
        phases: Phases::Independent,
        ..Case::default()
    }
}

const SIZES: [(usize, usize); 5] = [(2, 2), (2, 10), (4, 4), (10, 2), (10, 10)];

/// Least squares over all realizations is as certain as it says, as a matrix where that has enough
/// degrees of freedom.
#[test]
fn least_squares_holds_entry_by_entry_and_as_a_matrix() {
    for n_channels in [2, 3] {
        for (n_realizations, n_periods) in SIZES {
            let case = Case {
                distortion: 0.02,
                ..case(n_channels, n_realizations, n_periods)
            };
            let quiet = Case {
                distortion: 0.0,
                ..case
            }
            .estimate(Method::LeastSquares);
            let noise = quiet.frf.noise.as_ref();
            let distorted = case.estimate(Method::LeastSquares);
            let by_entry = [
                entries(&quiet, noise),
                entries(&distorted, distorted.frf.total.as_ref()),
            ];
            let nu = noise.expect("measured").degrees_of_freedom;
            let n_entries = (n_channels * n_channels) as f64;
            let by_matrix = (nu >= n_entries + 0.5).then(|| matrices(&quiet, noise));
            println!(
                "{n_channels} x {n_channels}, {n_realizations} x {n_periods}: noise {:.1} % (matrix {by_matrix:.1?}), total {:.1} %, nu {nu:.2}",
                by_entry[0], by_entry[1]
            );
            assert!((93.0..97.0).contains(&by_entry[0]));
            // one degree of freedom tells less than the corrected spread makes up for
            let most = if n_realizations > 2 { 97.0 } else { 99.0 };
            assert!((93.0..most).contains(&by_entry[1]));
            assert!(by_matrix.is_none_or(|share| (93.0..98.7).contains(&share)));
            assert_eq!(quiet.evenness, None);
        }
    }
}

/// The paper's mean of FRFs has few degrees of freedom there, says so, and is far off.
#[test]
fn the_mean_of_frfs_says_how_few_realizations_it_rests_on() {
    for n_channels in [2, 3] {
        for (n_realizations, n_periods) in SIZES {
            let case = case(n_channels, n_realizations, n_periods);
            let mean = case.estimate(Method::MeanOfFrfs);
            let noise = entries(&mean, mean.frf.noise.as_ref());
            let nu = mean
                .frf
                .noise
                .as_ref()
                .expect("measured")
                .degrees_of_freedom;
            println!("{n_channels}, {n_realizations} x {n_periods}: {noise:.1} %, nu {nu:.2}");
            assert!((93.0..97.5).contains(&noise));
            assert!(nu < 0.8 * (n_realizations * (n_periods - 1)) as f64);
            let said = mean.warnings().join("\n");
            assert!(said.contains("least-squares"), "{said}");
        }
    }
}

/// With orthogonal experiments all is as it was: whole degrees of freedom, nothing said, and least
/// squares is the mean of spectra.
#[test]
fn orthogonal_experiments_know_no_difference() {
    let case = Case {
        phases: Phases::Orthogonal,
        ..case(3, 4, 3)
    };
    let mean = case.estimate(Method::MeanOfSpectra);
    assert_eq!(mean.warnings(), Vec::<String>::new());
    assert_eq!(
        mean.frf
            .noise
            .as_ref()
            .expect("measured")
            .degrees_of_freedom,
        8.0
    );
    let all = case.estimate(Method::LeastSquares);
    let differences = &mean.frf.response - &all.frf.response;
    assert!(
        differences
            .iter()
            .all(|difference| difference.norm() < 1e-12)
    );
    let pairs = [
        (mean.frf.noise_variance(), all.frf.noise_variance()),
        (mean.frf.total_variance(), all.frf.total_variance()),
    ];
    for (mean, all) in pairs {
        let (mean, all) = (mean.expect("measured"), all.expect("measured"));
        let ratios = &mean / &all;
        assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 1e-9));
    }
}

/// One realization is the mean of spectra whatever the phases.
#[test]
fn least_squares_of_one_realization_is_the_mean_of_spectra() {
    let case = case(2, 1, 4);
    let [a, b] =
        [Method::MeanOfSpectra, Method::LeastSquares].map(|method| case.estimate(method).frf);
    assert!(
        (&a.response - &b.response)
            .iter()
            .all(|difference| difference.norm() < 1e-9)
    );
    assert!(b.total.is_none() && b.noise.is_some());
}
