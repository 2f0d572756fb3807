//! Styles of curves, and the inks that tell several curves apart.

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

/// One ink per style: each colour once, each dash once among the lines and each marker once among
/// the markers, as far as they reach.
pub(crate) fn inks(styles: impl Iterator<Item = Style>) -> Vec<Ink> {
    let (mut lines, mut markers) = (0, 0);
    let ink = |style| {
        let color = COLORS[(lines + markers) % COLORS.len()];
        match style {
            Style::Reference => Ink::line(Pen::solid("#000000", 1.0)),
            Style::Line => {
                lines += 1;
                Ink::line(Pen {
                    color,
                    width: 1.8,
                    dash: DASHES[(lines - 1) % DASHES.len()],
                })
            }
            Style::Markers => {
                markers += 1;
                Ink::markers(MARKERS[(markers - 1) % MARKERS.len()], color)
            }
        }
    };
    styles.map(ink).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inks_differ_in_colour_and_in_dash_or_marker() {
        let inks = inks(
            [
                Style::Reference,
                Style::Markers,
                Style::Line,
                Style::Markers,
                Style::Line,
            ]
            .into_iter(),
        );
        for (k, a) in inks.iter().enumerate() {
            for b in &inks[..k] {
                let dash = |ink: &Ink| ink.pen.map(|pen| (pen.dash, pen.width.to_bits()));
                assert!(a.color != b.color && (dash(a), a.marker) != (dash(b), b.marker));
            }
        }
    }
}
