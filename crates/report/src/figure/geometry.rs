//! Points and rectangles of a picture, in CSS pixels, y down.

/// A point of a picture in CSS pixels, y down.
pub(crate) type Point = (f64, f64);

/// A rectangle in CSS pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Rect {
    /// The right edge.
    pub(crate) fn right(&self) -> f64 {
        self.x + self.width
    }

    /// The lower edge.
    pub(crate) fn bottom(&self) -> f64 {
        self.y + self.height
    }

    /// The corners, from the upper left one clockwise.
    pub(crate) fn corners(&self) -> [Point; 4] {
        let Self { x, y, .. } = *self;
        let (right, bottom) = (self.right(), self.bottom());
        [(x, y), (right, y), (right, bottom), (x, bottom)]
    }

    /// Halfway from left to right.
    pub(crate) fn middle_x(&self) -> f64 {
        self.x + self.width / 2.0
    }

    /// Halfway from top to bottom.
    pub(crate) fn middle_y(&self) -> f64 {
        self.y + self.height / 2.0
    }
}
