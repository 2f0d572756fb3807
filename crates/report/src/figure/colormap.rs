//! Colour map whose lightness rises evenly, so that equal steps look equal, also in grey and to
//! the colour-blind.

use crate::figure::image::Rgb;

/// Nine evenly spaced colours of the map viridis (S. van der Walt, N. Smith, 2015, public domain);
/// between them we interpolate.
const ANCHORS: [Rgb; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2d, 0x7b],
    [0x3b, 0x52, 0x8b],
    [0x2c, 0x72, 0x8e],
    [0x21, 0x91, 0x8c],
    [0x28, 0xae, 0x80],
    [0x5e, 0xc9, 0x62],
    [0xad, 0xdc, 0x30],
    [0xfd, 0xe7, 0x25],
];
/// Steps of the map: finer ones cannot be told apart and make larger files.
pub(crate) const STEPS: usize = 96;

/// The colour of a share between 0 (dark blue) and 1 (yellow), in [`STEPS`] steps; white for NaN.
pub(crate) fn color(share: f64) -> Rgb {
    if share.is_nan() {
        return [0xff; 3];
    }
    let step = (share.clamp(0.0, 1.0) * STEPS as f64)
        .floor()
        .min((STEPS - 1) as f64);
    let place = step / (STEPS - 1) as f64 * (ANCHORS.len() - 1) as f64;
    let left = (place as usize).min(ANCHORS.len() - 2);
    let mixed = |k: usize| {
        let (a, b) = (f64::from(ANCHORS[left][k]), f64::from(ANCHORS[left + 1][k]));
        (a + (place - left as f64) * (b - a)).round() as u8
    };
    [mixed(0), mixed(1), mixed(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_rises_evenly_from_dark_to_bright() {
        // Relative luminance to CIE lightness (CIE 15:2004), a little simplified.
        let lightness = |rgb: Rgb| {
            let linear = rgb.map(|c| (f64::from(c) / 255.0).powf(2.2));
            116.0 * (0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]).cbrt() - 16.0
        };
        let all: Vec<f64> = (0..=10)
            .map(|k| lightness(color(f64::from(k) / 10.0)))
            .collect();
        for pair in all.windows(2) {
            assert!((4.0..11.0).contains(&(pair[1] - pair[0])), "{all:?}");
        }
        assert_eq!(
            (color(0.0), color(1.0), color(f64::NAN)),
            (ANCHORS[0], ANCHORS[8], [255; 3])
        );
    }
}
