//! Strength of an excitation pooled over several runs.

use frfid_signals::power::rms;
use ndarray::ArrayView1;

use crate::excitation_strength::{AxisStrength, BandStrength};

/// The strength of several runs as one: mean power, mean stuck share of those that know it, slowest of
/// all, crossing if any; `None` of none. The runs must be of one plan, with the same bands. Torques are put beside the
/// Coulomb friction in N m of every axis, where it is known.
#[must_use]
pub fn pooled_strength(
    runs: &[Vec<AxisStrength>],
    coulomb_nm: Option<&[f64]>,
) -> Option<Vec<AxisStrength>> {
    let axes = runs.first()?.iter().enumerate().map(|(axis, first)| {
        let all: Vec<&AxisStrength> = runs.iter().filter_map(|run| run.get(axis)).collect();
        pooled_axis(first, &all, known_friction_nm(coulomb_nm, axis))
    });
    Some(axes.collect())
}

/// The Coulomb friction of an axis, where it is known and not 0.
pub(super) fn known_friction_nm(coulomb_nm: Option<&[f64]>, axis: usize) -> Option<f64> {
    let coulomb_nm = coulomb_nm?.get(axis).copied();
    coulomb_nm.filter(|nm| *nm > 0.0)
}

/// One axis in several runs.
fn pooled_axis(
    first: &AxisStrength,
    all: &[&AxisStrength],
    coulomb_nm: Option<f64>,
) -> AxisStrength {
    let rms_nm = quadratic_mean(all.iter().map(|run| run.rms_nm));
    AxisStrength {
        rms_nm,
        rms_over_coulomb: coulomb_nm.map(|nm| rms_nm / nm),
        stuck_share: mean(all.iter().filter_map(|run| run.stuck_share)),
        slowest_rad_s: slowest_rad_s(all),
        crosses_zero: first.crosses_zero.map(|_| any_crosses_zero(all)),
        bands: pooled_bands(&first.bands, all, coulomb_nm),
    }
}

fn slowest_rad_s(all: &[&AxisStrength]) -> f64 {
    let slowest = all.iter().map(|run| run.slowest_rad_s);
    slowest.fold(f64::INFINITY, f64::min)
}

fn any_crosses_zero(all: &[&AxisStrength]) -> bool {
    all.iter().any(|run| run.crosses_zero == Some(true))
}

/// The bands of an axis in several runs.
fn pooled_bands(
    first: &[BandStrength],
    all: &[&AxisStrength],
    coulomb_nm: Option<f64>,
) -> Vec<BandStrength> {
    let band = |(place, first): (usize, &BandStrength)| {
        let all: Vec<_> = all.iter().filter_map(|run| run.bands.get(place)).collect();
        pooled_band(first, &all, coulomb_nm)
    };
    first.iter().enumerate().map(band).collect()
}

/// One band of an axis in several runs.
fn pooled_band(
    first: &BandStrength,
    all: &[&BandStrength],
    coulomb_nm: Option<f64>,
) -> BandStrength {
    let rms_nm = quadratic_mean(all.iter().map(|run| run.rms_nm));
    BandStrength {
        rms_nm,
        rms_over_coulomb: coulomb_nm.map(|nm| rms_nm / nm),
        stuck_share: mean(all.iter().filter_map(|run| run.stuck_share)),
        ..*first
    }
}

/// `None` of none.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.collect();
    ArrayView1::from(&values).mean()
}

fn quadratic_mean(values: impl Iterator<Item = f64>) -> f64 {
    rms(&values.collect::<Vec<_>>())
}
