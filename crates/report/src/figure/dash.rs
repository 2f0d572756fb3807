//! Dashes along a polyline.

use crate::figure::Point;

/// Cuts a polyline into its strokes. `pattern` holds the lengths of strokes and gaps in turn, in
/// pixels, as in SVG ("6 3"); a pattern without positive lengths leaves the line whole.
pub(crate) fn cut(points: &[Point], pattern: &str) -> Vec<Vec<Point>> {
    let lengths: Vec<f64> = pattern
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .filter(|&length| length > 0.0)
        .collect();
    let (Some(&first), Some(&start)) = (lengths.first(), points.first()) else {
        return vec![points.to_vec()];
    };
    let (mut strokes, mut stroke) = (Vec::new(), vec![start]);
    let (mut turn, mut left) = (0, first);
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        let mut rest = (to.0 - from.0).hypot(to.1 - from.1);
        while rest > left {
            let share = left / rest;
            from = (
                from.0 + share * (to.0 - from.0),
                from.1 + share * (to.1 - from.1),
            );
            rest -= left;
            if turn % 2 == 0 {
                stroke.push(from);
                strokes.push(std::mem::take(&mut stroke));
            } else {
                stroke = vec![from];
            }
            turn += 1;
            left = lengths[turn % lengths.len()];
        }
        left -= rest;
        if turn % 2 == 0 {
            stroke.push(to);
        }
    }
    if turn % 2 == 0 {
        strokes.push(stroke);
    }
    strokes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pattern_runs_on_across_points() {
        let points: Vec<Point> = (0..=20).map(|x| (f64::from(x), 0.0)).collect();
        let strokes = cut(&points, "6 3");
        let ends: Vec<(f64, f64)> = strokes.iter().map(|s| (s[0].0, s[s.len() - 1].0)).collect();
        assert_eq!(ends, [(0.0, 6.0), (9.0, 15.0), (18.0, 20.0)]);
        for whole in ["", "0 0"] {
            assert_eq!(cut(&points, whole), std::slice::from_ref(&points));
        }
    }
}
