//! Dashes along a polyline.

use crate::figure::geometry::Point;

/// Cuts a polyline into its strokes. `pattern` holds the lengths of strokes and gaps in turn, in
/// pixels, as in SVG ("6 3"); a pattern without positive lengths leaves the line whole.
pub(crate) fn cut(points: &[Point], pattern: &str) -> Vec<Vec<Point>> {
    let lengths: Vec<f64> = pattern
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .filter(|&length| length > 0.0)
        .collect();
    let (Some(&left), Some(&start)) = (lengths.first(), points.first()) else {
        return vec![points.to_vec()];
    };
    let mut dashes = Dashes {
        lengths,
        turn: 0,
        left,
        stroke: vec![start],
        finished: Vec::new(),
    };
    for pair in points.windows(2) {
        dashes.follow(pair[0], pair[1]);
    }
    dashes.strokes()
}

/// Strokes on the way along a polyline.
struct Dashes {
    /// Lengths of strokes and gaps in turn.
    lengths: Vec<f64>,
    /// Number of the stroke or gap; strokes are even.
    turn: usize,
    /// What is left of it.
    left: f64,
    /// The stroke so far.
    stroke: Vec<Point>,
    finished: Vec<Vec<Point>>,
}

impl Dashes {
    fn is_stroke(&self) -> bool {
        self.turn.is_multiple_of(2)
    }

    /// Goes along a straight piece of the line.
    fn follow(&mut self, mut from: Point, to: Point) {
        let mut rest = (to.0 - from.0).hypot(to.1 - from.1);
        while rest > self.left {
            let share = self.left / rest;
            from = (
                from.0 + share * (to.0 - from.0),
                from.1 + share * (to.1 - from.1),
            );
            rest -= self.left;
            self.turn_at(from);
        }
        self.left -= rest;
        if self.is_stroke() {
            self.stroke.push(to);
        }
    }

    /// Ends a stroke or a gap and begins the next.
    fn turn_at(&mut self, point: Point) {
        if self.is_stroke() {
            self.stroke.push(point);
            self.finished.push(std::mem::take(&mut self.stroke));
        } else {
            self.stroke = vec![point];
        }
        self.turn += 1;
        self.left = self.lengths[self.turn % self.lengths.len()];
    }

    /// Every stroke, the last one included.
    fn strokes(mut self) -> Vec<Vec<Point>> {
        if self.is_stroke() {
            self.finished.push(self.stroke);
        }
        self.finished
    }
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
