//! Cells of a spectrogram: densities averaged over small rectangles of the picture.

use std::ops::Range;

use crate::diagrams::spectrogram::Spectrogram;
use crate::figure::axis::Axis;
use crate::figure::panel::Panel;

/// Cells, down and across: two pixels each.
pub(crate) const CELLS: (usize, usize) = (140, 270);

/// The mean density of every cell in dB, row by row from the top; NaN where nothing was analysed.
pub(crate) fn levels_db(content: &Spectrogram, panel: &Panel) -> Vec<f64> {
    let (rows, columns) = CELLS;
    let up = groups(content.frequency_hz, &edges(&panel.y, rows));
    let across = groups(content.time_s, &edges(&panel.x, columns));
    let mut levels = Vec::with_capacity(rows * columns);
    for frequencies in up.iter().rev() {
        for times in &across {
            levels.push(10.0 * mean(content, frequencies, times).log10());
        }
    }
    levels
}

/// Mean density over a rectangle of the analysis.
fn mean(content: &Spectrogram, frequencies: &Range<usize>, times: &Range<usize>) -> f64 {
    let all = frequencies
        .clone()
        .flat_map(|k| times.clone().map(move |m| content.density[[k, m]]));
    all.sum::<f64>() / (frequencies.len() * times.len()) as f64
}

/// Values of an axis that part it into `count` pieces of equal length.
fn edges(axis: &Axis, count: usize) -> Vec<f64> {
    (0..=count)
        .map(|k| axis.value(k as f64 / count as f64))
        .collect()
}

/// First and last time with half a step beyond.
pub(crate) fn span(centres: &[f64]) -> (f64, f64) {
    let half = |a: usize, b: usize| (centres[b] - centres[a]) / 2.0;
    match centres.len() {
        0 => (0.0, 1.0),
        1 => (centres[0] - 0.5, centres[0] + 0.5),
        n => (centres[0] - half(0, 1), centres[n - 1] + half(n - 2, n - 1)),
    }
}

/// For every cell between two edges the indices of the centres in it, or of the nearest where there
/// is none; nothing outside of what the centres span.
fn groups(centres: &[f64], edges: &[f64]) -> Vec<Range<usize>> {
    edges
        .windows(2)
        .map(|pair| group(centres, pair[0], pair[1]))
        .collect()
}

/// The indices of one cell.
fn group(centres: &[f64], from: f64, to: f64) -> Range<usize> {
    let first = centres.partition_point(|c| *c < from);
    let end = centres.partition_point(|c| *c < to);
    let middle = (from + to) / 2.0;
    let (low, high) = span(centres);
    if first < end {
        first..end
    } else if centres.is_empty() || !(low..=high).contains(&middle) {
        0..0
    } else {
        let right = first.min(centres.len() - 1);
        let left = right.saturating_sub(1);
        let is_left_nearer = middle - centres[left] < centres[right] - middle;
        let nearest = if is_left_nearer { left } else { right };
        nearest..nearest + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_what_lies_in_them_or_the_nearest_and_nothing_beyond() {
        let edges = |n: usize, low: f64, high: f64| -> Vec<f64> {
            (0..=n)
                .map(|k| low + (high - low) * k as f64 / n as f64)
                .collect()
        };
        assert_eq!(
            groups(&[0.5, 1.5, 2.5, 3.5], &edges(2, 0.0, 4.0)),
            [0..2, 2..4]
        );
        assert_eq!(
            groups(&[1.0, 3.0], &edges(6, 0.0, 6.0)),
            [0..1, 0..1, 1..2, 1..2, 0..0, 0..0]
        );
        assert_eq!(groups(&[], &edges(2, 0.0, 1.0)), [0..0, 0..0]);
    }
}
