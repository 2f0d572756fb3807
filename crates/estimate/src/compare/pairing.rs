//! Pairing of the resonances and antiresonances of two FRFs in their order over frequency.
//!
//! Of all pairings that keep the order of both curves and pair peaks with peaks, notches with
//! notches, the one of the least cost is taken: the log ratio of the frequencies of a pair, and for
//! whatever is left over a price that grows with its prominence. Where a machine has become stiffer
//! its first peak is the first peak again, even if the second one is nearer. (The alignment of
//! S. Needleman, C. Wunsch, J. Mol. Biol. 48 (1970) 443.)

use std::iter::zip;

use crate::compare::change::Change;
use crate::compare::curve::Curve;
use crate::compare::feature::resonance::Feature;

/// Price of leaving over what stands out clearly: more than any shift that is allowed, so that a
/// pair that can be made is made.
const LEFT_OVER: f64 = 1.0;
/// Prominence in dB that stands out clearly; lesser ones are left over for less.
const CLEAR_DB: f64 = 6.0;
/// Price of a pair of which one stands out and the other does not.
const UNLIKE: f64 = 0.2;

/// What ends the cheapest pairing of the first features of both.
#[derive(Clone, Copy)]
enum Last {
    Pair,
    OnlyA,
    OnlyB,
}

/// Pairs features in order; returns what became of A's, and what only B has.
pub(super) fn pair(
    a: &[Feature],
    b: &[Feature],
    curve_b: &Curve,
    largest_shift: f64,
) -> (Vec<Change>, Vec<Feature>) {
    let (mut partners, mut is_free) = (vec![None; a.len()], vec![true; b.len()]);
    for (i, j) in pairs(a, b, largest_shift) {
        partners[i] = Some(b[j]);
        is_free[j] = false;
    }
    let changes = zip(a, partners).map(|(a, b)| change(*a, b, curve_b));
    let only_in_b = zip(b, is_free).filter_map(|(b, is_free)| is_free.then_some(*b));
    (changes.collect(), only_in_b.collect())
}

/// Places of the features that belong together.
fn pairs(a: &[Feature], b: &[Feature], largest_shift: f64) -> Vec<(usize, usize)> {
    let mut last = vec![Last::OnlyB; a.len() * b.len()];
    // cost of pairing all of A's so far with the first j of B's
    let mut costs: Vec<f64> = running_sum(b.iter().map(left_over));
    for (i, of_a) in a.iter().enumerate() {
        let mut row = vec![costs[0] + left_over(of_a)];
        for (j, of_b) in b.iter().enumerate() {
            let (only_a, only_b) = (costs[j + 1] + left_over(of_a), row[j] + left_over(of_b));
            let pair = costs[j] + price(of_a, of_b, largest_shift);
            let (cost, step) = if pair <= only_a.min(only_b) {
                (pair, Last::Pair)
            } else if only_a <= only_b {
                (only_a, Last::OnlyA)
            } else {
                (only_b, Last::OnlyB)
            };
            last[i * b.len() + j] = step;
            row.push(cost);
        }
        costs = row;
    }
    way_back(&last, a.len(), b.len())
}

/// The pairs on the cheapest way, from its end.
fn way_back(last: &[Last], mut i: usize, mut j: usize) -> Vec<(usize, usize)> {
    let (columns, mut found) = (j, Vec::new());
    while i > 0 && j > 0 {
        match last[(i - 1) * columns + j - 1] {
            Last::Pair => {
                (i, j) = (i - 1, j - 1);
                found.push((i, j));
            }
            Last::OnlyA => i -= 1,
            Last::OnlyB => j -= 1,
        }
    }
    found
}

fn running_sum(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let sums = values.scan(0.0, |sum, value| {
        *sum += value;
        Some(*sum)
    });
    std::iter::once(0.0).chain(sums).collect()
}

fn left_over(feature: &Feature) -> f64 {
    LEFT_OVER * (feature.prominence_db / CLEAR_DB).clamp(0.0, 1.0)
}

/// Cost of a pair; infinite for what cannot be one.
fn price(a: &Feature, b: &Feature, largest_shift: f64) -> f64 {
    let distance = (b.frequency_hz / a.frequency_hz).ln().abs();
    if a.kind != b.kind || distance > largest_shift.ln() {
        return f64::INFINITY;
    }
    let (least, most) = (
        a.prominence_db.min(b.prominence_db),
        a.prominence_db.max(b.prominence_db),
    );
    let unlike = if most > 0.0 { 1.0 - least / most } else { 0.0 };
    distance + UNLIKE * unlike
}

/// What became of a feature of A.
fn change(a: Feature, b: Option<Feature>, curve_b: &Curve) -> Change {
    let (level_db, std_db) = match b {
        Some(b) => (Some(b.magnitude_db), b.magnitude_std_db),
        None => (
            curve_b.magnitude_db_at(a.frequency_hz),
            curve_b.std_db_near(a.frequency_hz),
        ),
    };
    Change {
        a,
        b,
        level_db: level_db.map(|level_db| level_db - a.magnitude_db),
        level_std_db: a.magnitude_std_db.zip(std_db).map(|(a, b)| a.hypot(b)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::feature::resonance::FeatureKind;
    use crate::compare::feature::resonance::FeatureKind::{Antiresonance, Resonance};

    fn feature((kind, frequency_hz, prominence_db): (FeatureKind, f64, f64)) -> Feature {
        Feature {
            kind,
            frequency_hz,
            frequency_std_hz: None,
            resolution_hz: 0.1,
            blur_hz: 0.0,
            magnitude_db: 0.0,
            magnitude_std_db: None,
            prominence_db,
            damping: None,
            damping_std: None,
        }
    }

    fn paired(a: &[(FeatureKind, f64, f64)], b: &[(FeatureKind, f64, f64)]) -> Vec<(usize, usize)> {
        let features = |list: &[_]| list.iter().copied().map(feature).collect::<Vec<_>>();
        let mut found = pairs(&features(a), &features(b), 1.5);
        found.reverse();
        found
    }

    #[test]
    fn the_first_peak_is_the_first_peak_though_the_second_is_nearer() {
        let soft = [10.0, 13.0, 17.0].map(|hz| (Resonance, hz, 20.0));
        let stiff = soft.map(|(kind, hz, db)| (kind, 1.3 * hz, db));
        assert_eq!(paired(&soft, &stiff), [(0, 0), (1, 1), (2, 2)]);
    }

    #[test]
    fn what_hardly_stands_out_finds_its_own_and_wiggles_are_skipped() {
        let a = [
            (Resonance, 28.4, 3.5),
            (Antiresonance, 31.0, 2.0),
            (Resonance, 35.7, 2.5),
        ];
        let b = [
            (Resonance, 28.4, 2.0),
            (Antiresonance, 31.5, 2.0),
            (Resonance, 35.7, 3.5),
        ];
        assert_eq!(paired(&a, &b), [(0, 0), (1, 1), (2, 2)]);
        let wiggle = [(Resonance, 10.1, 1.0), (Resonance, 11.5, 20.0)];
        assert_eq!(paired(&[(Resonance, 10.0, 20.0)], &wiggle), [(0, 1)]);
    }

    #[test]
    fn kinds_do_not_mix_and_far_ones_are_no_pair() {
        let peak = [(Resonance, 10.0, 9.0)];
        assert_eq!(paired(&peak, &[(Antiresonance, 10.0, 9.0)]), []);
        assert_eq!(paired(&peak, &[(Resonance, 15.1, 9.0)]), []);
        assert_eq!(paired(&peak, &[]), []);
    }
}
