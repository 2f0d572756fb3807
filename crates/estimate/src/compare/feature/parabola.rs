//! Top of a curve by a parabola through three points, and its half-power bandwidth by the points
//! around: all that can be read where nothing is known of the scatter.

/// Top of the parabola through a point and its neighbours, over log frequency: frequency in Hz,
/// level in dB.
pub(crate) fn parabola_top(hz: &[f64], level: &[f64], top: usize) -> (f64, f64) {
    let (left, right) = ((hz[top - 1] / hz[top]).ln(), (hz[top + 1] / hz[top]).ln());
    let (below, above) = (
        (level[top - 1] - level[top]) / left,
        (level[top + 1] - level[top]) / right,
    );
    let curvature = (above - below) / (right - left);
    let slope = below - curvature * left;
    if curvature >= 0.0 {
        return (hz[top], level[top]);
    }
    let shift = (-0.5 * slope / curvature).clamp(left, right);
    (
        hz[top] * shift.exp(),
        level[top] + shift * (slope + curvature * shift),
    )
}

/// Distance in Hz of the two places where the level has fallen to half the power of `magnitude_db`.
pub(crate) fn half_power_bandwidth(
    hz: &[f64],
    level: &[f64],
    top: usize,
    magnitude_db: f64,
) -> Option<f64> {
    let half = magnitude_db - 10.0 * 2f64.log10();
    let crossing = |inside: usize, outside: usize| {
        let share = (half - level[inside]) / (level[outside] - level[inside]);
        (level[inside] >= half && level[outside] < half)
            .then(|| hz[inside] + share * (hz[outside] - hz[inside]))
    };
    let rises = |from: usize, to: usize| level[to] > level[from] && level[from] < half + 3.0;
    let low = (0..top)
        .rev()
        .take_while(|&k| !rises(k + 1, k))
        .find_map(|k| crossing(k + 1, k))?;
    let high = (top + 1..level.len())
        .take_while(|&k| !rises(k - 1, k))
        .find_map(|k| crossing(k - 1, k))?;
    Some(high - low)
}
