//! Panel: one framed plot with its two axes.

use std::iter::zip;

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

/// A value of the horizontal axis and one of the vertical axis.
pub(crate) type Value = (f64, f64);

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
        self.grid(figure, self.x.labelled(), self.y.labelled(), GRID);
        curves(figure);
        self.frame(figure);
    }

    /// Draws the frame.
    pub(crate) fn frame(&self, figure: &mut Figure) {
        let [first, second, third, fourth] = self.rect.corners();
        figure.line(vec![first, second, third, fourth, first], FRAME);
    }

    /// Draws short strokes outside the frame at the labelled values, for panels that hide their
    /// grid.
    pub(crate) fn ticks(&self, figure: &mut Figure) {
        let (left, bottom) = (self.rect.x, self.rect.bottom());
        for &value in self.x.labelled() {
            let x = self.across(value);
            figure.stroke((x, bottom), (x, bottom + TICK), FRAME);
        }
        for &value in self.y.labelled() {
            let y = self.down(value);
            figure.stroke((left - TICK, y), (left, y), FRAME);
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
    pub(crate) fn curve(&self, figure: &mut Figure, values: &[Value], ink: &Ink) {
        if let Some(pen) = ink.pen {
            figure.clipped(self.rect, |figure| {
                for run in values.split(|(_, y)| !y.is_finite()) {
                    figure.line(thinned(self.points(run)), pen);
                }
            });
        }
        let radius = (0.5 * self.rect.width / values.len().max(1) as f64).clamp(1.3, 2.6);
        for &value in values {
            self.mark(figure, value, ink, radius);
        }
    }

    /// Draws one marker of the given radius, if the panel holds the point.
    pub(crate) fn mark(&self, figure: &mut Figure, value: Value, ink: &Ink, radius: f64) {
        if let Some(marker) = ink.marker
            && self.holds(value)
        {
            figure.marker(self.at(value), marker, radius, ink.color);
        }
    }

    /// Whether a pair of values lies in the panel.
    fn holds(&self, (x, y): Value) -> bool {
        self.x.holds(x) && self.y.holds(y)
    }

    /// Shades the area between two curves over the same abscissae, with gaps where one is not a
    /// number.
    pub(crate) fn band(&self, figure: &mut Figure, low: &[Value], high: &[Value], color: &str) {
        let pairs: Vec<(Value, Value)> = zip(low.iter().copied(), high.iter().copied()).collect();
        figure.clipped(self.rect, |figure| {
            for run in pairs.split(|(low, high)| low.1.is_nan() || high.1.is_nan()) {
                let there = run.iter().map(|(low, _)| low);
                let back = run.iter().rev().map(|(_, high)| high);
                let outline: Vec<Point> = self.points(there.chain(back)).collect();
                figure.area(&outline, color, 0.22);
            }
        });
    }

    /// Where a pair of values lies in the picture; far outside the panel it is brought near its
    /// edge.
    pub(crate) fn at(&self, (x, y): Value) -> Point {
        (
            self.rect.x + self.rect.width * self.x.share(x).clamp(-2.0, 3.0),
            self.rect.y + self.rect.height * (1.0 - self.y.share(y).clamp(-2.0, 3.0)),
        )
    }

    /// Where pairs of values lie in the picture.
    fn points<'a>(
        &self,
        values: impl IntoIterator<Item = &'a Value>,
    ) -> impl Iterator<Item = Point> {
        values.into_iter().map(|&value| self.at(value))
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
            figure.stroke((x, self.rect.y), (x, self.rect.bottom()), pen);
        }
        for &value in ys {
            let y = self.down(value);
            figure.stroke((self.rect.x, y), (self.rect.right(), y), pen);
        }
    }
}
