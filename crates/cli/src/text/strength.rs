//! Strength of an excitation, axis by axis.

use frfid_estimate::AxisStrength;
use frfid_experiment::Strength;
use frfid_signals::format::significant;

use crate::text::table::list;

/// How the axes were driven and moved: name and value per axis.
pub(crate) fn strength_rows(strength: Option<&Strength>) -> Vec<(&'static str, Vec<String>)> {
    let Some(Strength { axes, .. }) = strength else {
        return Vec::new();
    };
    let rows = |value: &dyn Fn(&AxisStrength) -> Option<String>| {
        axes.iter().filter_map(value).collect::<Vec<_>>()
    };
    let all = [
        (
            "torque, rms / friction",
            rows(&|axis| axis.rms_over_coulomb.map(|ratio| significant(ratio, 3))),
        ),
        (
            "stuck",
            rows(&|axis| Some(format!("{:.1} %", 100.0 * axis.stuck_share))),
        ),
        (
            "slowest velocity",
            rows(&|axis| {
                axis.crosses_zero
                    .map(|_| format!("{} rad/s", significant(axis.slowest_rad_s, 3)))
            }),
        ),
        (
            "velocity changes sign",
            rows(&|axis| {
                axis.crosses_zero
                    .map(|crosses| if crosses { "YES" } else { "no" }.into())
            }),
        ),
    ];
    all.into_iter()
        .filter(|(_, values)| values.len() == axes.len())
        .collect()
}

/// The same with the values of all axes beside each other.
pub(crate) fn strength_as_text(strength: Option<&Strength>) -> String {
    let rows = strength_rows(strength)
        .into_iter()
        .map(|(name, values)| (name, values.join(" | ")));
    list(&rows.collect::<Vec<_>>())
}
