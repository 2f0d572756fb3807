//! A finished picture, as SVG or PNG. Only this module and `image` know the plotting library
//! (kuva).
//!
//! We draw axes, curves and legends ourselves and use kuva as paper: its primitives, its SVG writer
//! and its rasteriser with the DejaVu font built in, so that both outputs come from one list of
//! shapes and no system font is needed. Its ready-made plots do not offer what a Bode diagram needs
//! (an axis that ends at the band, 45 degree ticks, panels that share axes).

pub(crate) mod axis;
pub(crate) mod colormap;
pub(crate) mod dash;
pub(crate) mod image;
pub(crate) mod legend;
pub(crate) mod panel;

use kuva::backend::raster::RasterBackend;
use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};

use crate::error::ReportError;
use crate::figure::image::{Image, Rgb};

/// Largest PNG we make, in pixels: 16 times a 4K screen.
const MOST_PIXELS: f64 = 128e6;

/// Width of the outline of hollow markers in pixels.
const OUTLINE: f64 = 1.2;

/// A point of a picture in CSS pixels, y down.
pub(crate) type Point = (f64, f64);

/// A rectangle in CSS pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

/// How a line is stroked: `dash` holds the lengths of strokes and gaps in pixels ("6 3"), empty for
/// a solid line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pen {
    pub color: &'static str,
    pub width: f64,
    pub dash: &'static str,
}

/// The shape drawn at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    Dot,
    Ring,
    Square,
    Diamond,
    Circle,
    Cross,
}

/// On which side of its point a text stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Center,
    Right,
}

/// A picture: vector graphics in memory, written by [`Figure::svg`] and [`Figure::png`].
///
/// The same inputs give the same bytes. The background is white, so the picture also reads on a
/// dark page.
#[derive(Debug, Clone)]
pub struct Figure {
    width: f64,
    height: f64,
    shapes: Vec<Shape>,
    clip_rects: Vec<String>,
}

/// What a picture is made of.
#[derive(Debug, Clone)]
enum Shape {
    Plain(Primitive),
    Image(Image),
}

impl Figure {
    /// A white sheet, in CSS pixels.
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Self {
            width,
            height,
            shapes: Vec::new(),
            clip_rects: Vec::new(),
        }
    }

    /// Height in CSS pixels.
    pub(crate) fn height(&self) -> f64 {
        self.height
    }

    /// The picture as a stand-alone SVG document.
    #[must_use]
    pub fn svg(&self) -> String {
        let (mut shapes, mut patterns) = (Vec::new(), Vec::new());
        for shape in &self.shapes {
            match shape {
                Shape::Plain(primitive) => shapes.push(primitive.clone()),
                Shape::Image(image) => {
                    let id = format!("image{}", patterns.len());
                    shapes.push(image.rectangle(&id));
                    patterns.push(image.pattern(&id));
                }
            }
        }
        let svg = SvgBackend::new().render_scene(&self.scene(shapes, patterns));
        // Without a viewBox an SVG does not scale with the page it is put on.
        svg.replacen(
            "<svg ",
            &format!("<svg viewBox=\"0 0 {} {}\" ", self.width, self.height),
            1,
        )
    }

    /// The picture as a PNG file, `scale` pixels per CSS pixel (2 is right for screens, 4 for
    /// print).
    ///
    /// # Errors
    /// [`ReportError::Value`] if `scale` is not above zero or gives more than 128 million pixels,
    /// [`ReportError::Png`].
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, ReportError> {
        let pixels = self.width * self.height * scale * scale;
        if !(scale > 0.0 && pixels <= MOST_PIXELS) {
            let needed = "above 0 and at most 128 million pixels in the picture";
            return Err(ReportError::Value {
                what: "PNG scale".to_owned(),
                found: scale,
                needed,
            });
        }
        // kuva's rasteriser begins the dash pattern anew at every point, so dense dashed curves
        // would come out solid.
        let plain = |shape: &Shape| match shape {
            Shape::Plain(primitive) => cut_dashes(primitive),
            Shape::Image(image) => vec![image.cells()],
        };
        let scene = self.scene(self.shapes.iter().flat_map(plain).collect(), Vec::new());
        RasterBackend::new()
            .with_scale(scale as f32)
            .render_scene(&scene)
            .map_err(ReportError::Png)
    }

    fn scene(&self, shapes: Vec<Primitive>, patterns: Vec<String>) -> Scene {
        let mut scene = Scene::new(self.width, self.height);
        scene.font_family = Some("Arial, Helvetica, DejaVu Sans, sans-serif".to_owned());
        let clips = self.clip_rects.iter().enumerate();
        scene.defs = clips
            .map(|(k, rect)| format!("<clipPath id=\"clip{k}\">{rect}</clipPath>"))
            .collect();
        scene.defs.extend(patterns);
        scene.elements = shapes;
        scene
    }

    /// A stroked line through the points.
    pub(crate) fn line(&mut self, points: Vec<Point>, pen: Pen) {
        if points.len() > 1 {
            let stroke_dasharray = (!pen.dash.is_empty()).then(|| pen.dash.to_owned());
            let stroke = Color::from(pen.color);
            self.push(Primitive::PolyLine {
                points,
                stroke,
                stroke_width: pen.width,
                stroke_dasharray,
            });
        }
    }

    /// A filled area without an outline.
    pub(crate) fn area(&mut self, outline: &[Point], color: &str, opacity: f64) {
        if outline.len() > 2 {
            self.push(path(
                outline,
                Some(Color::from(color)),
                Color::None,
                Some(opacity),
            ));
        }
    }

    /// One marker; `radius` is half its height.
    pub(crate) fn marker(&mut self, (x, y): Point, marker: Marker, radius: f64, color: &str) {
        let ink = Color::from(color);
        let circle = |fill: Color, stroke: Option<Color>| Primitive::Circle {
            cx: x,
            cy: y,
            r: radius,
            fill,
            fill_opacity: None,
            stroke_width: stroke.as_ref().map(|_| OUTLINE),
            stroke,
        };
        let white = || Color::from("#ffffff");
        match marker {
            Marker::Dot => self.push(circle(ink, None)),
            Marker::Ring => self.push(circle(white(), Some(ink))),
            Marker::Circle => self.push(circle(Color::None, Some(ink))),
            Marker::Square => {
                let r = 0.85 * radius;
                let corners = [
                    (x - r, y - r),
                    (x + r, y - r),
                    (x + r, y + r),
                    (x - r, y + r),
                ];
                self.push(path(&corners, Some(ink), Color::None, None));
            }
            Marker::Diamond => {
                let r = 1.2 * radius;
                self.push(path(
                    &[(x - r, y), (x, y - r), (x + r, y), (x, y + r)],
                    Some(white()),
                    ink,
                    None,
                ));
            }
            Marker::Cross => {
                for (dx, dy) in [(radius, radius), (radius, -radius)] {
                    let (points, stroke) = (vec![(x - dx, y - dy), (x + dx, y + dy)], ink.clone());
                    self.push(Primitive::PolyLine {
                        points,
                        stroke,
                        stroke_width: OUTLINE,
                        stroke_dasharray: None,
                    });
                }
            }
        }
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

    fn push_text(
        &mut self,
        (x, y): Point,
        text: &str,
        size: u32,
        align: Align,
        rotate: Option<f64>,
    ) {
        let anchor = match align {
            Align::Left => TextAnchor::Start,
            Align::Center => TextAnchor::Middle,
            Align::Right => TextAnchor::End,
        };
        let color = Some(Color::from("#000000"));
        self.push(Primitive::Text {
            x,
            y,
            content: printable(text),
            size,
            anchor,
            rotate,
            bold: false,
            color,
        });
    }

    fn push(&mut self, shape: Primitive) {
        self.shapes.push(Shape::Plain(shape));
    }

    /// Draws `content` clipped to the rectangle.
    pub(crate) fn clipped(&mut self, rect: Rect, content: impl FnOnce(&mut Self)) {
        let Rect {
            x,
            y,
            width,
            height,
        } = rect;
        let shape = format!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"/>"
        );
        let number = self
            .clip_rects
            .iter()
            .position(|known| *known == shape)
            .unwrap_or_else(|| {
                self.clip_rects.push(shape);
                self.clip_rects.len() - 1
            });
        let id = format!("clip{number}");
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
}

/// A closed path.
fn path(outline: &[Point], fill: Option<Color>, stroke: Color, opacity: Option<f64>) -> Primitive {
    let mut d = String::new();
    for (k, (x, y)) in outline.iter().enumerate() {
        d.push_str(&format!(
            "{} {x:.2} {y:.2} ",
            if k == 0 { 'M' } else { 'L' }
        ));
    }
    d.push('Z');
    let stroke_width = if matches!(stroke, Color::None) {
        0.0
    } else {
        OUTLINE
    };
    Primitive::Path(Box::new(PathData {
        d,
        fill,
        stroke,
        stroke_width,
        opacity,
        stroke_dasharray: None,
    }))
}

/// Text as XML can hold it, taken literally: control characters are replaced, and dollars escaped,
/// which kuva would read as mathematics.
fn printable(text: &str) -> String {
    let legal = |c: char| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars()
        .map(|c| if legal(c) { c } else { '\u{fffd}' })
        .collect::<String>()
        .replace('$', "\\$")
}

/// A dashed line as its strokes, anything else as it is.
fn cut_dashes(shape: &Primitive) -> Vec<Primitive> {
    match shape {
        Primitive::PolyLine {
            points,
            stroke,
            stroke_width,
            stroke_dasharray: Some(pattern),
        } => dash::cut(points, pattern)
            .into_iter()
            .map(|points| Primitive::PolyLine {
                points,
                stroke: stroke.clone(),
                stroke_width: *stroke_width,
                stroke_dasharray: None,
            })
            .collect(),
        other => vec![other.clone()],
    }
}
