//! Plausibility of a description: what is possible but reads as if another unit was meant.

use std::f64::consts::{PI, TAU};

use frfid_signals::Limit;
use frfid_signals::format::significant;

use crate::description::config::Config;

/// Frequencies that close to 2 pi times a round number are taken for rad/s.
const CLOSE: f64 = 1e-3;

/// What reads as if another unit was meant, in words.
pub(crate) fn implausible(config: &Config) -> Vec<String> {
    let travel = config
        .constant_velocity
        .as_ref()
        .and_then(|table| table.travel_rad.as_deref());
    let limit = config.limits.given.get(Limit::Travel);
    let far = [("travel_rad", travel), ("max_travel", limit)];
    let far = far
        .into_iter()
        .filter_map(|(key, values)| far_words(key, values?));
    stated_band(config)
        .and_then(band_words)
        .into_iter()
        .chain(far)
        .collect()
}

/// Edges of the band as they are written.
fn stated_band(config: &Config) -> Option<[f64; 2]> {
    let multisine = config
        .multisine
        .as_ref()
        .map(|table| [table.low_hz, table.high_hz]);
    let chirp = config
        .chirp
        .as_ref()
        .map(|table| [table.low_hz, table.high_hz]);
    let stepped = config
        .stepped_sine
        .as_ref()
        .map(|table| [table.low_hz, table.high_hz]);
    multisine.or(chirp).or(stepped)
}

/// That both edges are 2 pi times round numbers, as rad/s are.
fn band_words(edges: [f64; 2]) -> Option<String> {
    let is_of_rad_per_s = |edge: f64| !is_round(edge, 1e-9) && is_round(edge / TAU, CLOSE);
    edges.into_iter().all(is_of_rad_per_s).then(|| {
        let [low, high] = edges;
        let [low_hz, high_hz] = edges.map(|edge| significant(edge / TAU, 2));
        format!("{low} to {high} Hz is {low_hz} to {high_hz} times 2 pi: frequencies are in Hz, not in rad/s")
    })
}

/// Whether a number has two digits and zeros only, but for a share of it.
fn is_round(number: f64, share: f64) -> bool {
    let unit = 10_f64.powf(number.abs().log10().floor() - 1.0);
    ((number / unit).round() * unit / number - 1.0).abs() < share
}

/// That an axis may go further than half a turn.
fn far_words(key: &str, values: &[f64]) -> Option<String> {
    let axis = values
        .iter()
        .position(|value| value.is_finite() && value.abs() > PI)?;
    let (found, degrees) = (values[axis], significant(values[axis].to_degrees(), 3));
    let axis = axis + 1;
    Some(format!(
        "{key} of axis {axis} is {found} rad, {degrees} degrees: is that what is meant?"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rad_per_s_where_hz_are_needed_are_told() {
        for (edges, told) in [
            ([31.4, 377.0], true),
            ([TAU, 60.0 * TAU], true),
            ([12.566, 125.66], true),
            ([1.0, 60.0], false),
            ([1.0, 377.0], false),
            ([2.5, 250.0], false),
            ([0.5, 123.4], false),
        ] {
            assert_eq!(band_words(edges).is_some(), told, "{edges:?}");
        }
    }

    #[test]
    fn a_way_beyond_half_a_turn_is_told() {
        let words = far_words("travel_rad", &[0.1, 4.0]);
        assert!(words.is_some_and(|words| words.contains("axis 2 is 4 rad, 229 degrees")));
        assert_eq!(far_words("max_travel", &[3.0, f64::INFINITY]), None);
    }
}
