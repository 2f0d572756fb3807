//! Pairing of the resonances and antiresonances of two FRFs.

use std::iter::zip;

use crate::compare::bode::Bode;
use crate::compare::change::Change;
use crate::compare::resonance::Feature;

/// Pairs features of the same kind, the nearest in log frequency first; returns what became of A's,
/// and what only B has.
pub(super) fn pair(
    a: &[Feature],
    mut b: Vec<Feature>,
    curve_b: &Bode,
    largest_shift: f64,
) -> (Vec<Change>, Vec<Feature>) {
    let mut partners = vec![None; a.len()];
    while let Some((i, j)) = nearest(a, &partners, &b, largest_shift) {
        partners[i] = Some(b.remove(j));
    }
    let changes = zip(a, partners).map(|(a, b)| change(*a, b, curve_b));
    (changes.collect(), b)
}

/// The nearest two features of the same kind, by their places, of A's without a partner and of B's.
fn nearest(
    a: &[Feature],
    partners: &[Option<Feature>],
    b: &[Feature],
    largest_shift: f64,
) -> Option<(usize, usize)> {
    let distance = |(i, j): (usize, usize)| (b[j].frequency_hz / a[i].frequency_hz).ln().abs();
    let free = (0..a.len()).filter(|&i| partners[i].is_none());
    free.flat_map(|i| (0..b.len()).map(move |j| (i, j)))
        .filter(|&(i, j)| a[i].kind == b[j].kind)
        .filter(|&places| distance(places) <= largest_shift.ln())
        .min_by(|&x, &y| distance(x).total_cmp(&distance(y)))
}

/// What became of a feature of A.
fn change(a: Feature, b: Option<Feature>, curve_b: &Bode) -> Change {
    let level_db = match b {
        Some(b) => Some(b.magnitude_db),
        None => curve_b.magnitude_db_at(a.frequency_hz),
    };
    Change {
        a,
        b,
        level_db: level_db.map(|level_db| level_db - a.magnitude_db),
    }
}
