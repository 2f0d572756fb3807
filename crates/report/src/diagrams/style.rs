//! Styles of curves, and the inks that tell several curves apart.

use std::iter::zip;

use crate::figure::ink::{COLORS, Ink, MARKERS, Pen};

/// How an FRF is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A thin black line: the truth, or whatever the others are compared with.
    Reference,
    /// A coloured line, for estimates on a dense grid (chirp).
    Line,
    /// Coloured markers at the lines, for estimates on a sparse grid (multisine).
    Markers,
}

const DASHES: [&str; 4] = ["", "7 3", "7 2 2 2", "2 2"];

/// Place of a curve in the palette, for one that several diagrams of a page show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Swatch {
    /// Number of its colour, from 0; after the last, the first follows.
    pub color: usize,
    /// Number of its dash or marker, likewise.
    pub shape: usize,
}

/// One swatch per curve, its own or the next: each colour once, each dash once among the lines and
/// each marker once among the markers, as far as they reach.
pub(crate) fn swatches(curves: impl Iterator<Item = (Style, Option<Swatch>)>) -> Vec<Swatch> {
    let (mut lines, mut markers) = (0, 0);
    let next = |(style, own): (Style, Option<Swatch>)| {
        let color = lines + markers;
        let count = match style {
            Style::Reference => return Swatch { color: 0, shape: 0 },
            Style::Line => &mut lines,
            Style::Markers => &mut markers,
        };
        let shape = *count;
        *count += 1;
        own.unwrap_or(Swatch { color, shape })
    };
    curves.map(next).collect()
}

/// The ink of every curve.
pub(crate) fn inks(curves: impl Iterator<Item = (Style, Option<Swatch>)> + Clone) -> Vec<Ink> {
    zip(curves.clone(), swatches(curves))
        .map(|((style, _), swatch)| ink(style, swatch))
        .collect()
}

fn ink(style: Style, Swatch { color, shape }: Swatch) -> Ink {
    let color = COLORS[color % COLORS.len()];
    match style {
        Style::Reference => Ink::line(Pen::solid("#000000", 1.0)),
        Style::Line => Ink::line(Pen {
            color,
            width: 1.8,
            dash: DASHES[shape % DASHES.len()],
        }),
        Style::Markers => Ink::markers(MARKERS[shape % MARKERS.len()], color),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_keeps_its_own_place_whatever_stands_before_it() {
        let own = Swatch { color: 3, shape: 1 };
        let alone = swatches([(Style::Line, Some(own))].into_iter());
        let behind = swatches([(Style::Markers, None), (Style::Line, Some(own))].into_iter());
        assert_eq!((alone[0], behind[1]), (own, own));
    }

    #[test]
    fn inks_differ_in_colour_and_in_dash_or_marker() {
        let styles = [
            Style::Reference,
            Style::Markers,
            Style::Line,
            Style::Markers,
            Style::Line,
        ];
        let inks = inks(styles.into_iter().map(|style| (style, None)));
        for (k, a) in inks.iter().enumerate() {
            for b in &inks[..k] {
                let dash = |ink: &Ink| ink.pen.map(|pen| (pen.dash, pen.width.to_bits()));
                assert!(a.color != b.color && (dash(a), a.marker) != (dash(b), b.marker));
            }
        }
    }
}
