//! Upward text of PNG files: written level and turned pixel by pixel. kuva turns letters with their
//! smoothed edges filled, so that they look bold.

use std::io::Cursor;

use kuva::render::render::{Primitive, Scene, TextAnchor};
use png::{BitDepth, ColorType, Decoder, Encoder};

use crate::error::ReportError;
use crate::figure::{FONTS, rasterised};

/// Channels of a pixel: red, green, blue and opacity.
const CHANNELS: usize = 4;

/// Whether a shape is text that reads from bottom to top.
pub(crate) fn is_upward(shape: &Primitive) -> bool {
    matches!(shape, Primitive::Text { rotate: Some(degrees), .. } if *degrees == -90.0)
}

/// A PNG file with upward texts added, `scale` pixels for one of the sheet.
///
/// # Errors
/// [`ReportError::Png`].
pub(crate) fn with_upward(
    sheet: Vec<u8>,
    texts: &[&Primitive],
    scale: f32,
) -> Result<Vec<u8>, ReportError> {
    if texts.is_empty() {
        return Ok(sheet);
    }
    let mut sheet = Pixels::decoded(&sheet)?;
    for text in texts {
        if let Some((label, center)) = level(text) {
            let label = Pixels::decoded(&rasterised(&label, scale)?)?;
            let [x, y] = center.map(|place| (place * f64::from(scale)).round() as usize);
            sheet.darken_with_turned(&label, (x, y));
        }
    }
    sheet.encoded()
}

/// The text level in the middle of a sheet of its own, and the point about which it is turned.
fn level(text: &Primitive) -> Option<(Scene, [f64; 2])> {
    let Primitive::Text {
        x,
        y,
        content,
        size,
        color,
        ..
    } = text
    else {
        return None;
    };
    let letter = f64::from(*size);
    let (width, height) = (letter * (content.chars().count() + 2) as f64, 4.0 * letter);
    let mut scene = Scene::new(width, height);
    scene.font_family = Some(FONTS.to_owned());
    scene.elements = vec![Primitive::Text {
        x: width / 2.0,
        y: height / 2.0,
        content: content.clone(),
        size: *size,
        anchor: TextAnchor::Middle,
        rotate: None,
        bold: false,
        color: color.clone(),
    }];
    Some((scene, [*x, *y]))
}

/// Pixels of a PNG file, row by row.
struct Pixels {
    width: usize,
    height: usize,
    values: Vec<u8>,
}

impl Pixels {
    fn decoded(file: &[u8]) -> Result<Self, ReportError> {
        let error = |error: png::DecodingError| ReportError::Png(error.to_string());
        let mut reader = Decoder::new(Cursor::new(file)).read_info().map_err(error)?;
        let size = reader.output_buffer_size().unwrap_or(0);
        let mut values = vec![0; size];
        let info = reader.next_frame(&mut values).map_err(error)?;
        Ok(Self {
            width: info.width as usize,
            height: info.height as usize,
            values,
        })
    }

    fn encoded(&self) -> Result<Vec<u8>, ReportError> {
        let error = |error: png::EncodingError| ReportError::Png(error.to_string());
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, self.width as u32, self.height as u32);
        encoder.set_color(ColorType::Rgba);
        encoder.set_depth(BitDepth::Eight);
        let mut writer = encoder.write_header().map_err(error)?;
        writer.write_image_data(&self.values).map_err(error)?;
        writer.finish().map_err(error)?;
        Ok(file)
    }

    /// Puts a label, turned upward about its middle, on these pixels: each becomes as dark as the
    /// darker of the two.
    fn darken_with_turned(&mut self, label: &Self, (x, y): (usize, usize)) {
        for (k, ink) in label.values.chunks_exact(CHANNELS).enumerate() {
            let (u, v) = (k % label.width, k / label.width);
            // right becomes up, down becomes right
            let across = (x + v).checked_sub(label.height / 2);
            let down = (y + label.width / 2).checked_sub(u);
            let (Some(across), Some(down)) = (across, down) else {
                continue;
            };
            if across < self.width && down < self.height {
                let start = (down * self.width + across) * CHANNELS;
                let place = &mut self.values[start..start + CHANNELS - 1];
                for (below, above) in place.iter_mut().zip(ink) {
                    *below = (*below).min(*above);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_becomes_up() {
        let white = |width: usize, height: usize| Pixels {
            width,
            height,
            values: vec![255; CHANNELS * width * height],
        };
        let (mut sheet, mut label) = (white(9, 9), white(5, 3));
        let right_of_the_middle = (5 + 4) * CHANNELS; // row 1, column 4
        label.values[right_of_the_middle] = 7;
        sheet.darken_with_turned(&label, (4, 4));
        let dark: Vec<usize> = (0..sheet.values.len())
            .filter(|&k| sheet.values[k] < 255)
            .collect();
        assert_eq!(dark, [(2 * 9 + 4) * CHANNELS], "two above the middle");
        let back = Pixels::decoded(&sheet.encoded().expect("it is sound")).expect("it is ours");
        assert_eq!(back.values, sheet.values);
    }
}
