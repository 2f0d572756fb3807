//! Thinning of polylines: dropping the points that cannot be seen.

use crate::figure::geometry::Point;

/// A polyline that runs to the right, without the points that cannot be seen: of all points within
/// half a pixel the first, lowest, highest and last are kept, and of these the ones more than a
/// tenth of a pixel off the line between their neighbours.
pub(crate) fn thinned(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    let mut column: Vec<Point> = Vec::new();
    for point in points {
        if column
            .first()
            .is_some_and(|first| (point.0 - first.0).abs() >= 0.5)
        {
            kept.append(&mut outline(&column));
            column.clear();
        }
        column.push(point);
    }
    kept.append(&mut outline(&column));
    straightened(&kept)
}

/// Drops points while one straight line passes within a tenth of a pixel, measured vertically, of
/// all that were dropped.
fn straightened(points: &[Point]) -> Vec<Point> {
    let Some((&first, rest)) = points.split_first() else {
        return Vec::new();
    };
    let (mut kept, mut sight, mut last) = (vec![first], Sight::from(first), first);
    for &point in rest {
        if !sight.holds(point) {
            kept.push(last);
            sight = Sight::from(last);
        }
        sight.narrow(point);
        last = point;
    }
    if !rest.is_empty() {
        kept.push(last);
    }
    kept
}

/// The lines of sight from a point that pass within a tenth of a pixel of all points since.
struct Sight {
    from: Point,
    /// Least and greatest of their slopes.
    least: f64,
    most: f64,
}

impl Sight {
    fn from(point: Point) -> Self {
        Self {
            from: point,
            least: f64::NEG_INFINITY,
            most: f64::INFINITY,
        }
    }

    /// Slope of the line to a point `by` pixels below another.
    fn slope(&self, point: Point, by: f64) -> f64 {
        (point.1 + by - self.from.1) / (point.0 - self.from.0).max(1e-9)
    }

    fn holds(&self, point: Point) -> bool {
        (self.least..=self.most).contains(&self.slope(point, 0.0))
    }

    fn narrow(&mut self, point: Point) {
        self.least = self.least.max(self.slope(point, -0.1));
        self.most = self.most.min(self.slope(point, 0.1));
    }
}

/// First, lowest, highest and last of the points of a column, in their order.
fn outline(column: &[Point]) -> Vec<Point> {
    if column.len() <= 4 {
        return column.to_vec();
    }
    let by_height = |a: &usize, b: &usize| column[*a].1.total_cmp(&column[*b].1);
    let mut kept = vec![0, column.len() - 1];
    kept.extend((0..column.len()).min_by(by_height));
    kept.extend((0..column.len()).max_by(by_height));
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|k| column[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_extremes() {
        let dense = (0..10_000).map(|k| (f64::from(k) * 1e-2, f64::from((k * 37) % 1000)));
        let kept = thinned(dense);
        assert!(kept.len() <= 4 * 210, "{}", kept.len());
        assert!(kept.iter().any(|p| p.1 == 0.0) && kept.iter().any(|p| p.1 == 999.0));
    }

    #[test]
    fn what_is_dropped_lies_within_a_tenth_of_a_pixel() {
        let curve: Vec<Point> = (0..500)
            .map(f64::from)
            .map(|x| (x, 100.0 * (x / 40.0).sin()))
            .collect();
        let kept = thinned(curve.iter().copied());
        assert!(kept.len() < 250, "{}", kept.len());
        for &(x, y) in &curve {
            let right = kept.partition_point(|p| p.0 < x).max(1);
            let (a, b) = (kept[right - 1], kept[right]);
            assert!((a.1 + (x - a.0) / (b.0 - a.0) * (b.1 - a.1) - y).abs() <= 0.1 + 1e-9);
        }
    }
}
