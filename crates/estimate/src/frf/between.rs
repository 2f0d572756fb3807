//! Neighbours of a line among others, and where it stands between them: for linear interpolation.

/// The places in `lines`, at least one, that rise, below and above a line, and where it stands between them; the
/// nearest beyond the ends.
pub(crate) fn between(lines: &[usize], line: usize) -> (usize, usize, f64) {
    let above = lines.partition_point(|&other| other < line);
    match above {
        0 => (0, 0, 0.0),
        above if above == lines.len() => (above - 1, above - 1, 0.0),
        above => {
            let (low, high) = (lines[above - 1] as f64, lines[above] as f64);
            (above - 1, above, (line as f64 - low) / (high - low))
        }
    }
}
