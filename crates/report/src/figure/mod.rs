//! Figure: a finished picture, as SVG or PNG. Only this module, `drawing` and `image` know the
//! plotting library (kuva).
//!
//! We draw axes, curves and legends ourselves and use kuva as paper: its primitives, its SVG writer
//! and its rasteriser with the DejaVu font built in, so that both outputs come from one list of
//! shapes and no system font is needed. Its ready-made plots do not offer what a Bode diagram needs
//! (an axis that ends at the band, 45 degree ticks, panels that share axes).

pub(crate) mod axis;
pub(crate) mod colormap;
pub(crate) mod dash;
pub(crate) mod drawing;
pub(crate) mod geometry;
pub(crate) mod image;
pub(crate) mod ink;
pub(crate) mod legend;
pub(crate) mod panel;
pub(crate) mod thinning;
pub(crate) mod ticks;
pub(crate) mod upward;

use kuva::backend::raster::RasterBackend;
use kuva::backend::svg::SvgBackend;
use kuva::render::render::{Primitive, Scene};

use crate::error::ReportError;
use crate::figure::image::Image;
use crate::figure::upward::{is_upward, with_upward};
use crate::validation;

/// What text is written in.
const FONTS: &str = "Arial, Helvetica, DejaVu Sans, sans-serif";

/// Largest PNG we make, in pixels: 16 times a 4K screen.
const MOST_PIXELS: f64 = 128e6;

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
        self.with_view_box(&SvgBackend::new().render_scene(&self.scene(shapes, patterns)))
    }

    /// The SVG with a viewBox: without one it does not scale with the page it is put on.
    fn with_view_box(&self, svg: &str) -> String {
        let (width, height) = (self.width, self.height);
        let start = format!("<svg viewBox=\"0 0 {width} {height}\" ");
        svg.replacen("<svg ", &start, 1)
    }

    /// The picture as a PNG file, `scale` pixels per CSS pixel (2 is right for screens, 4 for
    /// print).
    ///
    /// # Errors
    /// [`ReportError::Value`] if `scale` is not above zero or gives more than 128 million pixels,
    /// [`ReportError::Png`].
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, ReportError> {
        self.check_scale(scale)?;
        let plain = self.shapes.iter().filter_map(|shape| match shape {
            Shape::Plain(primitive) => Some(primitive),
            Shape::Image(_) => None,
        });
        let upward: Vec<&Primitive> = plain.filter(|shape| is_upward(shape)).collect();
        // kuva's rasteriser begins the dash pattern again at every point, so dense dashed curves
        // would come out solid.
        let shapes = self.shapes.iter().flat_map(|shape| match shape {
            Shape::Plain(primitive) if is_upward(primitive) => Vec::new(),
            Shape::Plain(primitive) => cut_dashes(primitive),
            Shape::Image(image) => vec![image.cells()],
        });
        let level = rasterised(&self.scene(shapes.collect(), Vec::new()), scale as f32)?;
        with_upward(level, &upward, scale as f32)
    }

    /// Refuses a scale that gives no picture or too large a one.
    fn check_scale(&self, scale: f64) -> Result<(), ReportError> {
        let pixels = self.width * self.height * scale * scale;
        let needed = "above 0 and at most 128 million pixels in the picture";
        validation::value("PNG scale", scale, needed, |scale| {
            scale > 0.0 && pixels <= MOST_PIXELS
        })
    }

    /// The sheet with these shapes; clip paths and patterns are its definitions.
    fn scene(&self, shapes: Vec<Primitive>, patterns: Vec<String>) -> Scene {
        let mut scene = Scene::new(self.width, self.height);
        scene.font_family = Some(FONTS.to_owned());
        let clips = self.clip_rects.iter().enumerate();
        let clips = clips.map(|(k, rect)| format!("<clipPath id=\"clip{k}\">{rect}</clipPath>"));
        scene.defs = clips.chain(patterns).collect();
        scene.elements = shapes;
        scene
    }
}

/// A sheet as a PNG file, `scale` pixels for one of the sheet.
pub(crate) fn rasterised(sheet: &Scene, scale: f32) -> Result<Vec<u8>, ReportError> {
    let rasteriser = RasterBackend::new().with_scale(scale);
    rasteriser.render_scene(sheet).map_err(ReportError::Png)
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
