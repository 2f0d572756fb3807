//! Lines that two FRFs have in common, and their difference there.

use std::ops::RangeInclusive;

use num_complex::Complex64;

use crate::compare::measured::{Measured, Spread};

/// Offset of two lines that are still one, over the distance to the next line: two clocks, or a
/// period found to a fraction of a sample.
const SAME_LINE: f64 = 0.01;

/// Two FRFs with covariances, on the lines they share.
pub(crate) struct CommonLines<'a> {
    pub(crate) a: &'a Measured<'a>,
    pub(crate) b: &'a Measured<'a>,
    places: Vec<(usize, usize)>,
}

impl<'a> CommonLines<'a> {
    /// Those in a band; `None` unless both have a covariance.
    pub(crate) fn of(a: &'a Measured, b: &'a Measured, band_hz: (f64, f64)) -> Option<Self> {
        a.known.and(b.known)?;
        let is_within = |hz: f64| (band_hz.0..=band_hz.1).contains(&hz);
        let mut places = shared(&a.frf.frequency_hz, &b.frf.frequency_hz);
        places.retain(|&(k, _)| is_within(a.frf.frequency_hz[k]));
        Some(Self { a, b, places })
    }

    pub(crate) fn len(&self) -> usize {
        self.places.len()
    }

    /// Places of a common line in A and in B.
    pub(crate) fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        self.places.iter().copied()
    }

    pub(crate) fn hz(&self, line: usize) -> f64 {
        self.a.frf.frequency_hz[self.places[line].0]
    }

    /// Total only if both are.
    pub(crate) fn spread(&self) -> Spread {
        let is_total = |side: &Measured| {
            side.known
                .is_some_and(|(_, spread)| spread == Spread::Total)
        };
        if is_total(self.a) && is_total(self.b) {
            Spread::Total
        } else {
            Spread::Noise
        }
    }

    /// B less A in an entry, and what B was moved by to lie on A's frequency.
    pub(crate) fn difference(
        &self,
        (k, l): (usize, usize),
        (output, input): (usize, usize),
    ) -> (Complex64, Complex64) {
        let (a, b) = (self.a.frf, self.b.frf);
        let at = |line: usize| b.response[[line, output, input]];
        let hz = &b.frequency_hz;
        let (low, high) = (l.saturating_sub(1), (l + 1).min(hz.len() - 1));
        let offset_hz = a.frequency_hz[k] - hz[l];
        let moved = if offset_hz == 0.0 || low == high {
            Complex64::ZERO
        } else {
            (at(high) - at(low)) * (offset_hz / (hz[high] - hz[low]))
        };
        (at(l) + moved - a.response[[k, output, input]], moved)
    }

    /// Rms of the difference over that of A on these lines, in one entry or in all.
    pub(crate) fn relative_difference(
        &self,
        lines: RangeInclusive<usize>,
        entry: Option<(usize, usize)>,
    ) -> f64 {
        let (rows, columns) = (self.a.frf.n_outputs(), self.a.frf.n_inputs());
        let all = || (0..rows).flat_map(|o| (0..columns).map(move |i| (o, i)));
        let (mut difference, mut size) = (0.0, 0.0);
        for &places in &self.places[lines] {
            for (o, i) in all().filter(|found| entry.is_none_or(|entry| entry == *found)) {
                let of_a = self.a.frf.response[[places.0, o, i]].norm_sqr();
                let apart = self.difference(places, (o, i)).0.norm_sqr();
                if apart.is_finite() && of_a.is_finite() {
                    difference += apart;
                    size += of_a;
                }
            }
        }
        (difference / size).sqrt()
    }
}

/// Places of the frequencies that two rising lists share.
fn shared(a_hz: &[f64], b_hz: &[f64]) -> Vec<(usize, usize)> {
    let (mut k, mut l, mut found) = (0, 0, Vec::new());
    while let (Some(a), Some(b)) = (a_hz.get(k), b_hz.get(l)) {
        if (a - b).abs() <= SAME_LINE * spacing(a_hz, k).min(spacing(b_hz, l)) {
            found.push((k, l));
            (k, l) = (k + 1, l + 1);
        } else if a < b {
            k += 1;
        } else {
            l += 1;
        }
    }
    found
}

/// Distance to the nearest other frequency; infinite without.
fn spacing(hz: &[f64], k: usize) -> f64 {
    let to = |other: Option<&f64>| other.map_or(f64::INFINITY, |other| (other - hz[k]).abs());
    let below = k.checked_sub(1).and_then(|below| hz.get(below));
    to(below).min(to(hz.get(k + 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_two_grids_are_found_in_both() {
        assert_eq!(
            shared(&[1.0, 2.0, 3.0], &[2.0, 2.5, 3.0001, 4.0]),
            [(1, 0), (2, 2)]
        );
        assert_eq!(shared(&[1.0], &[1.0]), [(0, 0)]);
        assert_eq!(shared(&[], &[1.0]), []);
    }
}
