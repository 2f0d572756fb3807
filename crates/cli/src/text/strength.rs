//! Strength of an excitation, axis by axis.

use frfid_estimate::AxisStrength;
use frfid_experiment::Strength;
use frfid_signals::format::significant;

use crate::text::table::{list, side_by_side};

/// How the axes were driven and moved: name and value per axis.
pub(crate) fn strength_rows(strength: Option<&Strength>) -> Vec<(&'static str, Vec<String>)> {
    let Some(Strength { axes, .. }) = strength else {
        return Vec::new();
    };
    let all = [
        ("torque, rms / friction", values(axes, rms_over_friction)),
        ("stuck", values(axes, stuck)),
        ("slowest velocity", values(axes, slowest_velocity)),
        ("velocity changes sign", values(axes, changes_sign)),
    ];
    all.into_iter()
        .filter(|(_, values)| values.len() == axes.len())
        .collect()
}

/// The value of every axis that has one.
fn values(axes: &[AxisStrength], value: fn(&AxisStrength) -> Option<String>) -> Vec<String> {
    axes.iter().filter_map(value).collect()
}

fn rms_over_friction(axis: &AxisStrength) -> Option<String> {
    axis.rms_over_coulomb.map(|ratio| significant(ratio, 3))
}

fn stuck(axis: &AxisStrength) -> Option<String> {
    Some(share_as_text(axis.stuck_share))
}

/// A share in %, or that it is not known.
pub(crate) fn share_as_text(share: Option<f64>) -> String {
    share.map_or("unknown".into(), |share| format!("{:.1} %", 100.0 * share))
}

/// `None` without a constant velocity.
fn slowest_velocity(axis: &AxisStrength) -> Option<String> {
    axis.crosses_zero?;
    Some(format!("{} rad/s", significant(axis.slowest_rad_s, 3)))
}

/// `None` without a constant velocity.
fn changes_sign(axis: &AxisStrength) -> Option<String> {
    Some(if axis.crosses_zero? { "YES" } else { "no" }.into())
}

/// The same with the values of all axes beside each other.
pub(crate) fn strength_as_text(strength: Option<&Strength>) -> String {
    let rows = strength_rows(strength).into_iter();
    let rows = rows.map(|(name, values)| (name, side_by_side(&values)));
    list(&rows.collect::<Vec<_>>())
}
