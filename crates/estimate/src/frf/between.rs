//! Neighbours of a place among others, and where it stands between them: for linear interpolation.

/// The indices below and above a place among `others`, at least one, that rise, and where it stands between them; the
/// nearest beyond the ends.
pub(crate) fn between(others: &[f64], place: f64) -> (usize, usize, f64) {
    let above = others.partition_point(|&other| other < place);
    match above {
        0 => (0, 0, 0.0),
        above if above == others.len() => (above - 1, above - 1, 0.0),
        above => {
            let (low, high) = (others[above - 1], others[above]);
            (above - 1, above, (place - low) / (high - low))
        }
    }
}
