//! Way on which a campaign on a constant velocity was measured: an FRF is that of the poses passed.

use frfid_signals::Limit;

use crate::run::load::Load;

/// Mean pose and range of the positions in rad, one for each axis, as they stand in the provenance;
/// nothing without position readings.
pub(crate) fn way(load: &Load) -> Vec<(String, String)> {
    let position = |limit: Limit| load.peaks.get(limit);
    let ends = [Limit::LowestPosition, Limit::HighestPosition].map(position);
    let [Some(low), Some(high)] = ends else {
        return Vec::new();
    };
    let mean: Vec<f64> = low
        .iter()
        .zip(high)
        .map(|(low, high)| 0.5 * (low + high))
        .collect();
    vec![
        ("mean_position_rad".into(), format!("{mean:?}")),
        ("lowest_position_rad".into(), format!("{low:?}")),
        ("highest_position_rad".into(), format!("{high:?}")),
    ]
}
