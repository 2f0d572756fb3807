//! Error of a shaping octave by octave: an rms over the lines of a band is one over Hz, in which the
//! lowest octaves hardly count.

use std::iter::zip;

use frfid_signals::format::significant;
use ndarray::{Array2, Axis};
use serde::{Deserialize, Serialize};

use crate::shape::measure::rms_per_channel;

/// Relative error of the target in one octave of the band.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OctaveError {
    /// Lower edge in Hz.
    pub low_hz: f64,
    /// Upper edge in Hz.
    pub high_hz: f64,
    /// Rms over the lines of the octave, for each axis.
    pub axis_error: Vec<f64>,
}

impl OctaveError {
    /// The rms of errors `(line, axis)` on rising `line_hz` in octaves of a band: in as many parts
    /// of equal ratio as come nearest to octaves. Parts without a line are left out.
    pub(super) fn of_band(
        line_hz: &[f64],
        error: &Array2<f64>,
        [low_hz, high_hz]: [f64; 2],
    ) -> Vec<Self> {
        let ratio = high_hz / low_hz;
        let n_octaves = ratio.log2().round().max(1.0);
        let edge = |k: usize| low_hz * ratio.powf(k as f64 / n_octaves);
        let octave = |k: usize| {
            let (from, to) = (edge(k), edge(k + 1));
            let is_last = k + 1 == n_octaves as usize;
            let first = if k == 0 {
                0
            } else {
                line_hz.partition_point(|hz| *hz < from)
            };
            let end = if is_last {
                line_hz.len()
            } else {
                line_hz.partition_point(|hz| *hz < to)
            };
            let lines: Vec<usize> = (first..end).collect();
            (!lines.is_empty()).then(|| Self {
                low_hz: from,
                high_hz: to,
                axis_error: rms_per_channel(&error.select(Axis(0), &lines)),
            })
        };
        (0..n_octaves as usize).filter_map(octave).collect()
    }

    /// The largest error of an axis in one of these octaves, and the axis from 0.
    fn largest(&self) -> Option<(usize, f64)> {
        let errors = self.axis_error.iter().copied().enumerate();
        errors.max_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// The octave in which an axis is off by most; `None` without octaves.
    #[must_use]
    pub fn worst(octaves: &[Self]) -> Option<&Self> {
        let error = |octave: &Self| octave.largest().map_or(0.0, |(_, error)| error);
        octaves.iter().max_by(|a, b| error(a).total_cmp(&error(b)))
    }

    /// For each axis its largest error in an octave.
    #[must_use]
    pub fn worst_of_axes(octaves: &[Self]) -> Vec<f64> {
        let n_axes = octaves.first().map_or(0, |octave| octave.axis_error.len());
        let mut worst = vec![0.0_f64; n_axes];
        for octave in octaves {
            zip(&mut worst, &octave.axis_error)
                .for_each(|(worst, error)| *worst = worst.max(*error));
        }
        worst
    }

    /// The edges, as `2 to 4 Hz`.
    #[must_use]
    pub fn place(&self) -> String {
        let [low, high] = [self.low_hz, self.high_hz].map(|hz| significant(hz, 2));
        format!("{low} to {high} Hz")
    }

    /// The worst octave in words: axes from 1.
    #[must_use]
    pub fn worst_in_words(octaves: &[Self]) -> Option<String> {
        let octave = Self::worst(octaves)?;
        let (axis, error) = octave.largest()?;
        Some(format!(
            "most from {}: {:.1} % on axis {}",
            octave.place(),
            100.0 * error,
            axis + 1
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors that fall with the frequency: 1/f between 1 and 32 Hz on lines of 1/16 Hz. The rms
    /// from a to b Hz is sqrt(1/(a b)), which octave by octave is halved.
    #[test]
    fn octaves_of_a_falling_error_are_those_of_its_integral() {
        let hz: Vec<f64> = (16..=512).map(|k| f64::from(k) / 16.0).collect();
        let error = Array2::from_shape_fn((hz.len(), 2), |(k, axis)| (1.0 + axis as f64) / hz[k]);
        let octaves = OctaveError::of_band(&hz, &error, [1.0, 32.0]);
        assert_eq!(octaves.len(), 5);
        for octave in &octaves {
            let exact = (octave.low_hz * octave.high_hz).sqrt().recip();
            for (axis, found) in octave.axis_error.iter().enumerate() {
                let ratio = found / exact / (1.0 + axis as f64);
                assert!((ratio - 1.0).abs() < 0.03, "{octave:?}: {ratio}");
            }
        }
        let words = OctaveError::worst_in_words(&octaves).expect("octaves");
        assert!(
            words.starts_with("most from 1 to 2 Hz: 14") && words.ends_with("on axis 2"),
            "{words}"
        );
        let mean = rms_per_channel(&error)[0];
        assert!(octaves[0].axis_error[0] > 3.0 * mean, "{mean}");
        assert_eq!(OctaveError::worst_of_axes(&octaves), octaves[0].axis_error);
    }

    #[test]
    fn a_narrow_band_is_one_octave_and_empty_ones_are_left_out() {
        let error = Array2::from_elem((2, 1), 0.5);
        let narrow = OctaveError::of_band(&[5.0, 6.0], &error, [5.0, 6.0]);
        assert_eq!(narrow.len(), 1);
        assert_eq!(narrow[0].axis_error, [0.5]);
        let sparse = OctaveError::of_band(&[1.0, 9.0], &error, [1.0, 16.0]);
        assert_eq!(sparse.len(), 2);
        assert_eq!(OctaveError::worst_in_words(&[]), None);
    }
}
