//! Images: grids of coloured cells, for spectrograms and colour bars.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene};

use crate::error::ReportError;
use crate::figure::geometry::Rect;
use crate::figure::rasterised;

/// A colour as red, green, blue.
pub(crate) type Rgb = [u8; 3];

/// Coloured cells of equal size that fill a rectangle, row by row from its upper left corner.
#[derive(Debug, Clone)]
pub(crate) struct Image {
    rect: Rect,
    columns: usize,
    rows: usize,
    cells: Vec<Rgb>,
    /// The cells as a PNG file, one pixel each.
    png: Vec<u8>,
}

impl Image {
    /// Lays a grid of cells over the rectangle; `color` is asked for every (row, column).
    ///
    /// # Errors
    /// [`ReportError::Png`].
    pub(crate) fn new(
        rect: Rect,
        (rows, columns): (usize, usize),
        color: impl Fn(usize, usize) -> Rgb,
    ) -> Result<Self, ReportError> {
        let cells: Vec<Rgb> = (0..rows * columns)
            .map(|k| color(k / columns, k % columns))
            .collect();
        Ok(Self {
            rect,
            columns,
            rows,
            png: png((rows, columns), &cells)?,
            cells,
        })
    }

    /// The cells as one shape each, for the rasteriser.
    pub(crate) fn cells(&self) -> Primitive {
        batch(self.rect, (self.rows, self.columns), &self.cells)
    }

    /// A rectangle filled with the pattern of that name, for SVG: some ten thousand cells would be
    /// megabytes there.
    pub(crate) fn rectangle(&self, id: &str) -> Primitive {
        let Rect {
            x,
            y,
            width,
            height,
        } = self.rect;
        let fill = Color::Css(format!("url(#{id})").into());
        Primitive::Rect {
            x,
            y,
            width,
            height,
            fill,
            stroke: None,
            stroke_width: None,
            opacity: None,
        }
    }

    /// The pattern that holds the cells as an embedded PNG.
    pub(crate) fn pattern(&self, id: &str) -> String {
        let Rect {
            x,
            y,
            width,
            height,
        } = self.rect;
        let data = STANDARD.encode(&self.png);
        format!(
            "<pattern id=\"{id}\" patternUnits=\"userSpaceOnUse\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\">\
             <image width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" \
             href=\"data:image/png;base64,{data}\"/></pattern>"
        )
    }
}

/// The cells as a PNG file, one pixel each.
fn png((rows, columns): (usize, usize), cells: &[Rgb]) -> Result<Vec<u8>, ReportError> {
    let rect = Rect {
        x: 0.0,
        y: 0.0,
        width: columns as f64,
        height: rows as f64,
    };
    let mut scene = Scene::new(rect.width, rect.height);
    scene.elements = vec![batch(rect, (rows, columns), cells)];
    rasterised(&scene, 1.0)
}

/// One rectangle per cell. Each reaches a pixel below the next ones, which are drawn over it: edges
/// between neighbours would let the background through where they are smoothed.
fn batch(rect: Rect, (rows, columns): (usize, usize), cells: &[Rgb]) -> Primitive {
    let (width, height) = (rect.width / columns as f64, rect.height / rows as f64);
    let left = |k: usize| rect.x + (k % columns) as f64 * width;
    let top = |k: usize| rect.y + (k / columns) as f64 * height;
    let all = || 0..cells.len();
    Primitive::RectBatch {
        x: all().map(left).collect(),
        y: all().map(top).collect(),
        w: all()
            .map(|k| (width + 1.0).min(rect.right() - left(k)))
            .collect(),
        h: all()
            .map(|k| (height + 1.0).min(rect.bottom() - top(k)))
            .collect(),
        fills: cells.iter().map(|&[r, g, b]| Color::Rgb(r, g, b)).collect(),
    }
}
