//! Panel: one framed plot with its two axes.

use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::drawing::Align;
use crate::figure::geometry::{Point, Rect};
use crate::figure::ink::{Ink, Pen};
use crate::figure::thinning::thinned;

/// Room for labels to the left, right and below the panels, and between them, in pixels.
pub(crate) const LEFT: f64 = 72.0;
pub(crate) const RIGHT: f64 = 16.0;
pub(crate) const BELOW: f64 = 46.0;
pub(crate) const GAP: f64 = 16.0;
/// Font sizes in pixels.
pub(crate) const TICK_SIZE: u32 = 12;
pub(crate) const LABEL_SIZE: u32 = 13;
/// Length of a tick in pixels.
pub(crate) const TICK: f64 = 3.0;

const GRID: Pen = Pen::solid("#c8c8c8", 0.8);
const FINE_GRID: Pen = Pen::solid("#e8e8e8", 0.6);
pub(crate) const FRAME: Pen = Pen::solid("#000000", 1.0);

/// A rectangle of the picture with a horizontal and a vertical axis.
pub(crate) struct Panel {
    pub(crate) rect: Rect,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
}

impl Panel {
    /// Draws grid, curves and frame, in this order: markers may reach over the frame, lines are
    /// clipped.
    pub(crate) fn draw(&self, figure: &mut Figure, curves: impl FnOnce(&mut Figure)) {
        self.grid(figure, self.x.minor.iter(), self.y.minor.iter(), FINE_GRID);
        self.grid(
            figure,
            self.x.ticks.iter().map(|(x, _)| x),
            self.y.ticks.iter().map(|(y, _)| y),
            GRID,
        );
        curves(figure);
        self.frame(figure);
    }

    /// Draws the frame.
    pub(crate) fn frame(&self, figure: &mut Figure) {
        let (left, right) = (self.rect.x, self.rect.right());
        let (top, bottom) = (self.rect.y, self.rect.bottom());
        let corners = vec![
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        figure.line(corners, FRAME);
    }

    /// Draws short strokes outside the frame at the labelled values, for panels that hide their
    /// grid.
    pub(crate) fn ticks(&self, figure: &mut Figure) {
        let (left, bottom) = (self.rect.x, self.rect.bottom());
        for (value, _) in &self.x.ticks {
            let x = self.across(*value);
            figure.line(vec![(x, bottom), (x, bottom + TICK)], FRAME);
        }
        for (value, _) in &self.y.ticks {
            let y = self.down(*value);
            figure.line(vec![(left - TICK, y), (left, y)], FRAME);
        }
    }

    /// Writes the tick labels and the label below the panel.
    pub(crate) fn label_x(&self, figure: &mut Figure, label: &str) {
        let bottom = self.rect.bottom();
        for (value, text) in &self.x.ticks {
            let at = (self.across(*value), bottom + 16.0);
            figure.text(at, text, TICK_SIZE, Align::Center);
        }
        let at = (self.rect.middle_x(), bottom + 36.0);
        figure.text(at, label, LABEL_SIZE, Align::Center);
    }

    /// Writes the tick labels and the label to the left of the panel.
    pub(crate) fn label_y(&self, figure: &mut Figure, label: &str) {
        let left = self.rect.x;
        for (value, text) in &self.y.ticks {
            let at = (left - 6.0, self.down(*value) + 4.0);
            figure.text(at, text, TICK_SIZE, Align::Right);
        }
        figure.upward_text((left - 54.0, self.rect.middle_y()), label, LABEL_SIZE);
    }

    /// Draws a curve through finite values, with line, markers or both.
    pub(crate) fn curve(&self, figure: &mut Figure, values: &[(f64, f64)], ink: &Ink) {
        if let Some(pen) = ink.pen {
            figure.clipped(self.rect, |figure| {
                for run in values.split(|(_, y)| !y.is_finite()) {
                    figure.line(thinned(run.iter().map(|&(x, y)| self.at(x, y))), pen);
                }
            });
        }
        let radius = (0.5 * self.rect.width / values.len().max(1) as f64).clamp(1.3, 2.6);
        values
            .iter()
            .for_each(|&point| self.mark(figure, point, ink, radius));
    }

    /// Draws one marker of the given radius, if the panel holds the point.
    pub(crate) fn mark(&self, figure: &mut Figure, (x, y): (f64, f64), ink: &Ink, radius: f64) {
        if let Some(marker) = ink.marker
            && self.x.holds(x)
            && self.y.holds(y)
        {
            figure.marker(self.at(x, y), marker, radius, ink.color);
        }
    }

    /// Shades the area between two curves over the same abscissae.
    pub(crate) fn band(
        &self,
        figure: &mut Figure,
        low: &[(f64, f64)],
        high: &[(f64, f64)],
        color: &str,
    ) {
        let there = low.iter().map(|&(x, y)| self.at(x, y));
        let back = high.iter().rev().map(|&(x, y)| self.at(x, y));
        let outline: Vec<Point> = there.chain(back).collect();
        figure.clipped(self.rect, |figure| figure.area(&outline, color, 0.22));
    }

    /// Where a pair of values lies in the picture; far outside the panel it is brought near its
    /// edge.
    pub(crate) fn at(&self, x: f64, y: f64) -> Point {
        (
            self.rect.x + self.rect.width * self.x.share(x).clamp(-2.0, 3.0),
            self.rect.y + self.rect.height * (1.0 - self.y.share(y).clamp(-2.0, 3.0)),
        )
    }

    /// Where a value of the horizontal axis lies in the picture.
    fn across(&self, value: f64) -> f64 {
        self.rect.x + self.rect.width * self.x.share(value)
    }

    /// Where a value of the vertical axis lies in the picture.
    fn down(&self, value: f64) -> f64 {
        self.rect.y + self.rect.height * (1.0 - self.y.share(value))
    }

    /// Draws lines through the panel at the values.
    fn grid<'a>(
        &self,
        figure: &mut Figure,
        xs: impl Iterator<Item = &'a f64>,
        ys: impl Iterator<Item = &'a f64>,
        pen: Pen,
    ) {
        for &value in xs {
            let x = self.across(value);
            figure.line(vec![(x, self.rect.y), (x, self.rect.bottom())], pen);
        }
        for &value in ys {
            let y = self.down(value);
            figure.line(vec![(self.rect.x, y), (self.rect.right(), y)], pen);
        }
    }
}
