//! Legend: rows above the plots, so that it never covers a curve.

use crate::figure::Figure;
use crate::figure::drawing::Align;
use crate::figure::geometry::Point;
use crate::figure::ink::Ink;
use crate::figure::panel::{BELOW, LEFT, RIGHT, TICK_SIZE};

/// Distance from the upper edge of the figure in pixels.
const TOP: f64 = 8.0;
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
        let widths = entries.iter().map(|(label, _)| entry_width(label));
        let column = widths.fold(1.0, f64::max);
        Self {
            entries,
            column,
            columns: ((width + GAP) / column).floor().max(1.0) as usize,
        }
    }

    /// A figure with the legend above panels of that width; `below` are the pixels from its lowest row to
    /// the labels of the lowest panel.
    pub(crate) fn figure(&self, width: f64, below: f64) -> Figure {
        let mut figure = Figure::new(LEFT + width + RIGHT, self.bottom() + below + BELOW);
        self.draw(&mut figure);
        figure
    }

    /// Where the lowest row ends, in pixels from the upper edge.
    pub(crate) fn bottom(&self) -> f64 {
        TOP + ROW * self.entries.len().div_ceil(self.columns) as f64
    }

    /// Draws the rows from the upper left corner downward.
    fn draw(&self, figure: &mut Figure) {
        for (k, (label, ink)) in self.entries.iter().enumerate() {
            let x = LEFT + self.column * (k % self.columns) as f64;
            let y = TOP + ROW * ((k / self.columns) as f64 + 0.5);
            draw_sample(figure, (x, y), ink);
            figure.text((x + SAMPLE + 6.0, y + 4.0), label, TICK_SIZE, Align::Left);
        }
    }
}

/// Draws a short line and a marker, the line's left end at the point.
fn draw_sample(figure: &mut Figure, (x, y): Point, ink: &Ink) {
    if let Some(pen) = ink.pen {
        figure.stroke((x, y), (x + SAMPLE, y), pen);
    }
    if let Some(marker) = ink.marker {
        figure.marker((x + SAMPLE / 2.0, y), marker, 3.0, ink.color);
    }
}

/// Room for one entry, with 0.57 em per letter, about what DejaVu, the widest of our fonts, needs.
fn entry_width(label: &str) -> f64 {
    SAMPLE + 6.0 + 0.57 * f64::from(TICK_SIZE) * label.chars().count() as f64 + GAP
}
