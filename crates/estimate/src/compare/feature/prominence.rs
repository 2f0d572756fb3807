//! Saddles beside every point of a curve, and its prominence above them, in linear time.

use std::iter::zip;

/// For every point the higher of two least values of `floor`: those on the way to something higher
/// in `level`, or to the end, to the left and to the right; infinite where a side has no lower
/// point.
pub(crate) fn saddles(level: &[f64], floor: &[f64]) -> Vec<f64> {
    let points = || zip(level.iter().copied(), floor.iter().copied());
    let left = least_on_the_way(points());
    let mut right = least_on_the_way(points().rev());
    right.reverse();
    zip(left, right)
        .map(|(left, right)| left.max(right))
        .collect()
}

/// The least floor between every point and the last higher one before it. Points that a higher one
/// hides are folded into it, so that each is looked at once.
fn least_on_the_way(points: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    let mut in_sight: Vec<(f64, f64)> = Vec::new();
    let least_before = points.map(|(height, floor)| {
        let mut least = f64::INFINITY;
        while let Some((_, hidden)) = in_sight.pop_if(|(top, _)| *top <= height) {
            least = least.min(hidden);
        }
        in_sight.push((height, least.min(floor)));
        least
    });
    least_before.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use frfid_signals::random::{stream, uniform};

    /// Walking to both sides from every point.
    #[test]
    fn saddles_are_those_of_a_walk_from_every_point() {
        let mut rng = stream(3, "levels", &[]);
        let level: Vec<f64> = (0..200)
            .map(|_| (9.0 * uniform(&mut rng)).floor())
            .collect();
        let floor: Vec<f64> = level
            .iter()
            .map(|value| value + uniform(&mut rng))
            .collect();
        let found = saddles(&level, &floor);
        for (k, found) in found.iter().enumerate() {
            let walk = |places: &mut dyn Iterator<Item = usize>| {
                let way = places.take_while(|&j| level[j] <= level[k]);
                way.map(|j| floor[j]).fold(f64::INFINITY, f64::min)
            };
            let expected = walk(&mut (0..k).rev()).max(walk(&mut (k + 1..200)));
            assert_eq!(*found, expected, "{k}");
        }
    }
}
