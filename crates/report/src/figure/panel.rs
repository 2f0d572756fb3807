//! One framed plot with its two axes.

use crate::diagrams::curve::Ink;
use crate::figure::axis::Axis;
use crate::figure::{Align, Figure, Pen, Point, Rect};

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

const GRID: Pen = Pen {
    color: "#c8c8c8",
    width: 0.8,
    dash: "",
};
const FINE_GRID: Pen = Pen {
    color: "#e8e8e8",
    width: 0.6,
    dash: "",
};
pub(crate) const FRAME: Pen = Pen {
    color: "#000000",
    width: 1.0,
    dash: "",
};

/// A rectangle of the picture with a horizontal and a vertical axis.
pub(crate) struct Panel {
    pub rect: Rect,
    pub x: Axis,
    pub y: Axis,
}

impl Panel {
    /// Draws grid, curves and frame, in this order: markers may reach over the frame, lines are
    /// clipped.
    pub fn draw(&self, figure: &mut Figure, curves: impl FnOnce(&mut Figure)) {
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
    pub fn frame(&self, figure: &mut Figure) {
        let Rect {
            x,
            y,
            width,
            height,
        } = self.rect;
        let corners = vec![
            (x, y),
            (x + width, y),
            (x + width, y + height),
            (x, y + height),
            (x, y),
        ];
        figure.line(corners, FRAME);
    }

    /// Draws short strokes outside the frame at the labelled values, for panels that hide their
    /// grid.
    pub fn ticks(&self, figure: &mut Figure) {
        let Rect {
            x: left,
            y: top,
            width,
            height,
        } = self.rect;
        for (value, _) in &self.x.ticks {
            let x = left + width * self.x.share(*value);
            figure.line(vec![(x, top + height), (x, top + height + TICK)], FRAME);
        }
        for (value, _) in &self.y.ticks {
            let y = top + height * (1.0 - self.y.share(*value));
            figure.line(vec![(left - TICK, y), (left, y)], FRAME);
        }
    }

    /// Writes the tick labels and the label below the panel.
    pub fn label_x(&self, figure: &mut Figure, label: &str) {
        let below = self.rect.y + self.rect.height;
        for (value, text) in &self.x.ticks {
            figure.text(
                (self.at(*value, 0.0).0, below + 16.0),
                text,
                TICK_SIZE,
                Align::Center,
            );
        }
        figure.text(
            (self.rect.x + self.rect.width / 2.0, below + 36.0),
            label,
            LABEL_SIZE,
            Align::Center,
        );
    }

    /// Writes the tick labels and the label to the left of the panel.
    pub fn label_y(&self, figure: &mut Figure, label: &str) {
        for (value, text) in &self.y.ticks {
            let y = self.rect.y + self.rect.height * (1.0 - self.y.share(*value));
            figure.text((self.rect.x - 6.0, y + 4.0), text, TICK_SIZE, Align::Right);
        }
        figure.upward_text(
            (self.rect.x - 54.0, self.rect.y + self.rect.height / 2.0),
            label,
            LABEL_SIZE,
        );
    }

    /// Draws a curve through finite values, with line, markers or both.
    pub fn curve(&self, figure: &mut Figure, values: &[(f64, f64)], ink: &Ink) {
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
    pub fn mark(&self, figure: &mut Figure, (x, y): (f64, f64), ink: &Ink, radius: f64) {
        if let Some(marker) = ink.marker
            && self.x.holds(x)
            && self.y.holds(y)
        {
            figure.marker(self.at(x, y), marker, radius, ink.color);
        }
    }

    /// Shades the area between two curves over the same abscissae.
    pub fn band(&self, figure: &mut Figure, low: &[(f64, f64)], high: &[(f64, f64)], color: &str) {
        let there = low.iter().map(|&(x, y)| self.at(x, y));
        let back = high.iter().rev().map(|&(x, y)| self.at(x, y));
        let outline: Vec<Point> = there.chain(back).collect();
        figure.clipped(self.rect, |figure| figure.area(&outline, color, 0.22));
    }

    /// Where a pair of values lies in the picture; far outside the panel it is brought near its
    /// edge.
    pub fn at(&self, x: f64, y: f64) -> Point {
        let Rect {
            x: left,
            y: top,
            width,
            height,
        } = self.rect;
        (
            left + width * self.x.share(x).clamp(-2.0, 3.0),
            top + height * (1.0 - self.y.share(y).clamp(-2.0, 3.0)),
        )
    }

    fn grid<'a>(
        &self,
        figure: &mut Figure,
        xs: impl Iterator<Item = &'a f64>,
        ys: impl Iterator<Item = &'a f64>,
        pen: Pen,
    ) {
        let Rect {
            x: left,
            y: top,
            width,
            height,
        } = self.rect;
        for &value in xs {
            let x = left + width * self.x.share(value);
            figure.line(vec![(x, top), (x, top + height)], pen);
        }
        for &value in ys {
            let y = top + height * (1.0 - self.y.share(value));
            figure.line(vec![(left, y), (left + width, y)], pen);
        }
    }
}

/// A polyline that runs to the right, without the points nobody sees: of all points within half a
/// pixel the first, lowest, highest and last are kept, and of these the ones more than a tenth of a
/// pixel off the line between their neighbours.
fn thinned(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    let mut column: Vec<Point> = Vec::new();
    for point in points {
        if column
            .first()
            .is_some_and(|first| (point.0 - first.0).abs() >= 0.5)
        {
            kept.append(&mut outline(&column));
            column.clear();
        }
        column.push(point);
    }
    kept.append(&mut outline(&column));
    straightened(&kept)
}

/// Drops points while one straight line passes within a tenth of a pixel, measured vertically, of
/// all that were dropped.
fn straightened(points: &[Point]) -> Vec<Point> {
    let Some((&first, rest)) = points.split_first() else {
        return Vec::new();
    };
    let (mut kept, mut anchor, mut last) = (vec![first], first, first);
    let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
    for &point in rest {
        let slope = |from: Point, by: f64| (point.1 + by - from.1) / (point.0 - from.0).max(1e-9);
        if !(least..=most).contains(&slope(anchor, 0.0)) {
            kept.push(last);
            (anchor, least, most) = (last, f64::NEG_INFINITY, f64::INFINITY);
        }
        (least, most) = (least.max(slope(anchor, -0.1)), most.min(slope(anchor, 0.1)));
        last = point;
    }
    if rest.is_empty() {
        kept
    } else {
        [kept, vec![last]].concat()
    }
}

/// First, lowest, highest and last of the points of a column, in their order.
fn outline(column: &[Point]) -> Vec<Point> {
    if column.len() <= 4 {
        return column.to_vec();
    }
    let by_height = |a: &usize, b: &usize| column[*a].1.total_cmp(&column[*b].1);
    let mut kept = vec![0, column.len() - 1];
    kept.extend((0..column.len()).min_by(by_height));
    kept.extend((0..column.len()).max_by(by_height));
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|k| column[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_extremes() {
        let dense = (0..10_000).map(|k| (f64::from(k) * 1e-2, f64::from((k * 37) % 1000)));
        let kept = thinned(dense);
        assert!(kept.len() <= 4 * 210, "{}", kept.len());
        assert!(kept.iter().any(|p| p.1 == 0.0) && kept.iter().any(|p| p.1 == 999.0));
    }

    #[test]
    fn what_is_dropped_lies_within_a_tenth_of_a_pixel() {
        let curve: Vec<Point> = (0..500)
            .map(f64::from)
            .map(|x| (x, 100.0 * (x / 40.0).sin()))
            .collect();
        let kept = thinned(curve.iter().copied());
        assert!(kept.len() < 250, "{}", kept.len());
        for &(x, y) in &curve {
            let right = kept.partition_point(|p| p.0 < x).max(1);
            let (a, b) = (kept[right - 1], kept[right]);
            assert!((a.1 + (x - a.0) / (b.0 - a.0) * (b.1 - a.1) - y).abs() <= 0.1 + 1e-9);
        }
    }
}
