//! Legend: rows above the plots, so that it never covers a curve.

use crate::figure::Figure;
use crate::figure::drawing::Align;
use crate::figure::geometry::Point;
use crate::figure::ink::Ink;
use crate::figure::panel::TICK_SIZE;

const SAMPLE: f64 = 26.0;
const ROW: f64 = 18.0;
const GAP: f64 = 16.0;

/// The entries of a legend in columns of equal width.
pub(crate) struct Legend<'a> {
    entries: Vec<(&'a str, Ink)>,
    column: f64,
    columns: usize,
}

impl<'a> Legend<'a> {
    /// Puts the entries into as many columns as `width` pixels hold.
    pub(crate) fn new(entries: impl Iterator<Item = (&'a str, Ink)>, width: f64) -> Self {
        let entries: Vec<_> = entries.filter(|(label, _)| !label.is_empty()).collect();
        let column = entries
            .iter()
            .map(|(label, _)| entry_width(label))
            .fold(1.0, f64::max);
        Self {
            entries,
            column,
            columns: ((width + GAP) / column).floor().max(1.0) as usize,
        }
    }

    /// Height of all rows in pixels.
    pub(crate) fn height(&self) -> f64 {
        ROW * self.entries.len().div_ceil(self.columns) as f64
    }

    /// Draws the rows from `(left, top)` downward.
    pub(crate) fn draw(&self, figure: &mut Figure, left: f64, top: f64) {
        for (k, (label, ink)) in self.entries.iter().enumerate() {
            let x = left + self.column * (k % self.columns) as f64;
            let y = top + ROW * ((k / self.columns) as f64 + 0.5);
            draw_sample(figure, (x, y), ink);
            figure.text((x + SAMPLE + 6.0, y + 4.0), label, TICK_SIZE, Align::Left);
        }
    }
}

/// Draws a short line and a marker, the line's left end at the point.
fn draw_sample(figure: &mut Figure, (x, y): Point, ink: &Ink) {
    if let Some(pen) = ink.pen {
        figure.line(vec![(x, y), (x + SAMPLE, y)], pen);
    }
    if let Some(marker) = ink.marker {
        figure.marker((x + SAMPLE / 2.0, y), marker, 3.0, ink.color);
    }
}

/// Room for one entry, with 0.57 em per letter, about what DejaVu, the widest of our fonts, needs.
fn entry_width(label: &str) -> f64 {
    SAMPLE + 6.0 + 0.57 * f64::from(TICK_SIZE) * label.chars().count() as f64 + GAP
}
