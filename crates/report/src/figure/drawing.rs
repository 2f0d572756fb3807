//! Drawing on a figure: lines, areas, markers, images and text.

use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, TextAnchor};

use crate::error::ReportError;
use crate::figure::geometry::{Point, Rect};
use crate::figure::image::{Image, Rgb};
use crate::figure::ink::{Marker, Pen};
use crate::figure::{Figure, Shape};

/// Width of the outline of hollow markers in pixels.
const OUTLINE: f64 = 1.2;

/// On which side of its point a text stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Center,
    Right,
}

impl Align {
    fn anchor(self) -> TextAnchor {
        match self {
            Self::Left => TextAnchor::Start,
            Self::Center => TextAnchor::Middle,
            Self::Right => TextAnchor::End,
        }
    }
}

impl Figure {
    /// A stroked line through the points.
    pub(crate) fn line(&mut self, points: Vec<Point>, pen: Pen) {
        if points.len() > 1 {
            self.push(Primitive::PolyLine {
                points,
                stroke: pen.color.into(),
                stroke_width: pen.width,
                stroke_dasharray: Some(pen.dash.to_owned()).filter(|dash| !dash.is_empty()),
            });
        }
    }

    /// A straight line from point to point.
    pub(crate) fn stroke(&mut self, from: Point, to: Point, pen: Pen) {
        self.line(vec![from, to], pen);
    }

    /// A filled area without an outline.
    pub(crate) fn area(&mut self, outline: &[Point], color: &str, opacity: f64) {
        if outline.len() > 2 {
            self.push(path(
                outline,
                Some(color.into()),
                Color::None,
                Some(opacity),
            ));
        }
    }

    /// One marker; `radius` is half its height.
    pub(crate) fn marker(
        &mut self,
        center: Point,
        marker: Marker,
        radius: f64,
        color: &'static str,
    ) {
        let (ink, white) = (Color::from(color), Color::from("#ffffff"));
        match marker {
            Marker::Dot => self.push(circle(center, radius, ink, None)),
            Marker::Ring => self.push(circle(center, radius, white, Some(ink))),
            Marker::Circle => self.push(circle(center, radius, Color::None, Some(ink))),
            Marker::Square => {
                let outline = square(center, 0.85 * radius);
                self.push(path(&outline, Some(ink), Color::None, None));
            }
            Marker::Diamond => {
                let outline = diamond(center, 1.2 * radius);
                self.push(path(&outline, Some(white), ink, None));
            }
            Marker::Cross => self.cross(center, radius, color),
            Marker::Tick => {
                let (x, y) = center;
                let pen = Pen::solid(color, OUTLINE);
                self.stroke((x, y - radius), (x, y + radius), pen);
            }
        }
    }

    /// Two strokes across each other.
    fn cross(&mut self, center: Point, radius: f64, color: &'static str) {
        let [first, second, third, fourth] = square(center, radius);
        let pen = Pen::solid(color, OUTLINE);
        self.stroke(first, third, pen);
        self.stroke(fourth, second, pen);
    }

    /// A grid of coloured cells that fills a rectangle.
    ///
    /// # Errors
    /// [`ReportError::Png`].
    pub(crate) fn image(
        &mut self,
        rect: Rect,
        size: (usize, usize),
        color: impl Fn(usize, usize) -> Rgb,
    ) -> Result<(), ReportError> {
        self.shapes
            .push(Shape::Image(Image::new(rect, size, color)?));
        Ok(())
    }

    /// Text with its baseline at the point, in black.
    pub(crate) fn text(&mut self, at: Point, text: &str, size: u32, align: Align) {
        self.push_text(at, text, size, align, None);
    }

    /// Text centred on the point that reads from bottom to top.
    pub(crate) fn upward_text(&mut self, at: Point, text: &str, size: u32) {
        self.push_text(at, text, size, Align::Center, Some(-90.0));
    }

    /// Text in black, turned by `rotate` degrees.
    fn push_text(
        &mut self,
        (x, y): Point,
        text: &str,
        size: u32,
        align: Align,
        rotate: Option<f64>,
    ) {
        self.push(Primitive::Text {
            x,
            y,
            content: printable(text),
            size,
            anchor: align.anchor(),
            rotate,
            bold: false,
            color: Some(Color::from("#000000")),
        });
    }

    /// Adds a shape above all others.
    fn push(&mut self, shape: Primitive) {
        self.shapes.push(Shape::Plain(shape));
    }

    /// Draws `content` clipped to the rectangle.
    pub(crate) fn clipped(&mut self, rect: Rect, content: impl FnOnce(&mut Self)) {
        let id = format!("clip{}", self.clip_number(rect));
        let Rect {
            x,
            y,
            width,
            height,
        } = rect;
        self.push(Primitive::ClipStart {
            x,
            y,
            width,
            height,
            id,
        });
        content(self);
        self.push(Primitive::ClipEnd);
    }

    /// Number of the clip path of a rectangle; equal rectangles share one.
    fn clip_number(&mut self, rect: Rect) -> usize {
        let Rect {
            x,
            y,
            width,
            height,
        } = rect;
        let shape = format!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"/>"
        );
        let known = self.clip_rects.iter().position(|known| *known == shape);
        known.unwrap_or_else(|| {
            self.clip_rects.push(shape);
            self.clip_rects.len() - 1
        })
    }
}

/// A disc, or with an outline a ring.
fn circle((cx, cy): Point, r: f64, fill: Color, outline: Option<Color>) -> Primitive {
    Primitive::Circle {
        cx,
        cy,
        r,
        fill,
        fill_opacity: None,
        stroke_width: outline.as_ref().map(|_| OUTLINE),
        stroke: outline,
    }
}

/// Corners of an upright square.
fn square((x, y): Point, r: f64) -> [Point; 4] {
    [
        (x - r, y - r),
        (x + r, y - r),
        (x + r, y + r),
        (x - r, y + r),
    ]
}

/// Corners of a square on its tip.
fn diamond((x, y): Point, r: f64) -> [Point; 4] {
    [(x - r, y), (x, y - r), (x + r, y), (x, y + r)]
}

/// A closed path.
fn path(outline: &[Point], fill: Option<Color>, stroke: Color, opacity: Option<f64>) -> Primitive {
    let stroke_width = if matches!(stroke, Color::None) {
        0.0
    } else {
        OUTLINE
    };
    Primitive::Path(Box::new(PathData {
        d: path_data(outline),
        fill,
        stroke,
        stroke_width,
        opacity,
        stroke_dasharray: None,
    }))
}

/// The outline in the language of SVG paths.
fn path_data(outline: &[Point]) -> String {
    let points = outline.iter().map(|(x, y)| format!("{x:.2} {y:.2} "));
    format!("M {}Z", points.collect::<Vec<_>>().join("L "))
}

/// Text as XML can hold it, taken literally: control characters are replaced, and dollars escaped,
/// which kuva would read as mathematics.
fn printable(text: &str) -> String {
    text.chars()
        .map(|c| if is_legal(c) { c } else { '\u{fffd}' })
        .collect::<String>()
        .replace('$', "\\$")
}

/// Whether XML can hold a character.
fn is_legal(c: char) -> bool {
    !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}')
}
