//! Strength of an excitation pooled over several runs.

use frfid_signals::power::rms;

use crate::excitation_strength::{AxisStrength, BandStrength};

/// The strength of several runs as one: mean power, mean stuck share, slowest of all, crossing if
/// any; `None` of none. The runs must be of one plan, with the same bands. Torques are put beside the
/// Coulomb friction in N m of every axis, where it is known.
#[must_use]
pub fn pooled_strength(
    runs: &[Vec<AxisStrength>],
    coulomb_nm: Option<&[f64]>,
) -> Option<Vec<AxisStrength>> {
    let axes = runs.first()?.iter().enumerate().map(|(axis, first)| {
        let all: Vec<&AxisStrength> = runs.iter().filter_map(|run| run.get(axis)).collect();
        let coulomb_nm = coulomb_nm.and_then(|all| all.get(axis)).copied();
        pooled_axis(first, &all, runs.len(), coulomb_nm.filter(|nm| *nm > 0.0))
    });
    Some(axes.collect())
}

/// One axis in several runs.
fn pooled_axis(
    first: &AxisStrength,
    all: &[&AxisStrength],
    n_runs: usize,
    coulomb_nm: Option<f64>,
) -> AxisStrength {
    let rms_nm = quadratic_mean(all.iter().map(|run| run.rms_nm));
    let slowest = all.iter().map(|run| run.slowest_rad_s);
    let crosses_zero = || all.iter().any(|run| run.crosses_zero == Some(true));
    let bands = first.bands.iter().enumerate().map(|(place, first)| {
        let all: Vec<_> = all.iter().filter_map(|run| run.bands.get(place)).collect();
        pooled_band(first, &all, n_runs, coulomb_nm)
    });
    AxisStrength {
        rms_nm,
        rms_over_coulomb: coulomb_nm.map(|nm| rms_nm / nm),
        stuck_share: mean(all.iter().map(|run| run.stuck_share), n_runs),
        slowest_rad_s: slowest.fold(f64::INFINITY, f64::min),
        crosses_zero: first.crosses_zero.map(|_| crosses_zero()),
        bands: bands.collect(),
    }
}

/// One band of an axis in several runs.
fn pooled_band(
    first: &BandStrength,
    all: &[&BandStrength],
    n_runs: usize,
    coulomb_nm: Option<f64>,
) -> BandStrength {
    let rms_nm = quadratic_mean(all.iter().map(|run| run.rms_nm));
    let stuck_share = || mean(all.iter().filter_map(|run| run.stuck_share), n_runs);
    BandStrength {
        rms_nm,
        rms_over_coulomb: coulomb_nm.map(|nm| rms_nm / nm),
        stuck_share: first.stuck_share.map(|_| stuck_share()),
        ..*first
    }
}

fn mean(values: impl Iterator<Item = f64>, n_runs: usize) -> f64 {
    values.sum::<f64>() / n_runs as f64
}

fn quadratic_mean(values: impl Iterator<Item = f64>) -> f64 {
    rms(&values.collect::<Vec<_>>())
}
