//! Power spectral density over time as a heat map (SK15 figure 3).

use std::ops::Range;

use ndarray::ArrayView2;

use crate::diagrams::curve::Ink;
use crate::error::ReportError;
use crate::figure::axis::Axis;
use crate::figure::colormap::{STEPS, color};
use crate::figure::panel::{BELOW, FRAME, LABEL_SIZE, LEFT, Panel, TICK, TICK_SIZE};
use crate::figure::{Align, Figure, Pen, Rect};
use crate::validation;

const WIDTH: f64 = 540.0;
const HEIGHT: f64 = 280.0;
/// Room above for the names of the harmonics, between the plot and its colour bar, and to the right
/// of that.
const ABOVE: f64 = 24.0;
const BESIDE: f64 = 34.0;
const BAR: f64 = 14.0;
const RIGHT: f64 = 66.0;
/// Cells, down and across: two pixels each.
const CELLS: (usize, usize) = (140, 270);
/// Dots that are seen on every colour of the map but its brightest, where the line runs along the
/// ridge it points out.
const HARMONIC: Pen = Pen {
    color: "#ffffff",
    width: 0.9,
    dash: "1.5 4",
};

/// Power spectral density of one signal over time, as [`spectrogram`] draws it.
#[derive(Debug, Clone)]
pub struct Spectrogram<'a> {
    /// Frequencies in Hz, rising.
    pub frequency_hz: &'a [f64],
    /// Times of the analysed pieces in s, rising.
    pub time_s: &'a [f64],
    /// Power spectral density, `(frequency, time)`, in `unit`.
    pub density: ArrayView2<'a, f64>,
    /// Unit of the density, to which 0 dB refers: `(N m)²/Hz`.
    pub unit: String,
    /// Lowest and highest frequency shown, in Hz.
    pub band_hz: (f64, f64),
    /// Whether the frequency axis is logarithmic.
    pub log_frequency: bool,
    /// What lies further below the highest density is drawn in the darkest colour, in dB.
    pub range_db: f64,
    /// Frequency of the excitation over time, pairs of s and Hz; empty for none.
    pub sweep: Vec<(f64, f64)>,
    /// Multiples of the excitation's frequency that are marked as dotted lines: `[1, 2, 3, 5]`.
    pub harmonics: Vec<u32>,
}

/// Heat map of a power spectral density: time in s across, frequency in Hz upward, dB as colour
/// with a colour bar.
///
/// Densities are averaged where several fall into one cell of the picture. NaN and what was not
/// analysed stay white.
///
/// # Errors
/// [`ReportError`] if the lengths do not agree, an axis does not rise, or the band or range cannot
/// be drawn.
pub fn spectrogram(content: &Spectrogram) -> Result<Figure, ReportError> {
    content.check()?;
    let rect = Rect {
        x: LEFT,
        y: ABOVE,
        width: WIDTH,
        height: HEIGHT,
    };
    let mut figure = Figure::new(LEFT + WIDTH + BESIDE + BAR + RIGHT, ABOVE + HEIGHT + BELOW);
    let (low_hz, high_hz) = content.band_hz;
    let band = [low_hz, high_hz].into_iter();
    let y = if content.log_frequency {
        Axis::upright_log(band, HEIGHT)
    } else {
        Axis::exact(band, HEIGHT)
    };
    let (time_low, time_high) = span(content.time_s);
    let panel = Panel {
        rect,
        x: Axis::exact([time_low, time_high].into_iter(), WIDTH),
        y,
    };
    let level_db = content.cells(&panel);
    let highest = level_db
        .iter()
        .copied()
        .filter(|db| db.is_finite())
        .fold(f64::NEG_INFINITY, f64::max);
    let highest = if highest.is_finite() { highest } else { 0.0 };
    let scale = Axis::linear([highest - content.range_db, highest].into_iter(), HEIGHT);
    figure.image(rect, CELLS, |row, column| {
        color(scale.share(level_db[row * CELLS.1 + column]))
    })?;
    for &harmonic in &content.harmonics {
        content.mark(&mut figure, &panel, harmonic);
    }
    panel.frame(&mut figure);
    panel.ticks(&mut figure);
    panel.label_x(&mut figure, "Time in s");
    panel.label_y(&mut figure, "Frequency in Hz");
    draw_bar(
        &mut figure,
        &scale,
        &format!("Density in dB, 0 dB = 1 {}", content.unit),
    )?;
    Ok(figure)
}

impl Spectrogram<'_> {
    fn check(&self) -> Result<(), ReportError> {
        let (frequencies, times) = self.density.dim();
        validation::length(
            "frequency_hz of the spectrogram",
            self.frequency_hz.len(),
            frequencies,
        )?;
        validation::length("time_s of the spectrogram", self.time_s.len(), times)?;
        validation::rising("frequency_hz of the spectrogram", self.frequency_hz)?;
        validation::rising("time_s of the spectrogram", self.time_s)?;
        let (low, high) = self.band_hz;
        let least = if self.log_frequency {
            f64::MIN_POSITIVE
        } else {
            0.0
        };
        validation::value(
            "band_hz.0 of the spectrogram",
            low,
            "above 0 (from 0 on a linear axis)",
            |hz| hz >= least,
        )?;
        validation::value(
            "band_hz.1 of the spectrogram",
            high,
            "above band_hz.0",
            |hz| hz > low,
        )?;
        validation::value(
            "range_db of the spectrogram",
            self.range_db,
            "above 0",
            |db| db > 0.0,
        )
    }

    /// What every cell shows, in dB, row by row from the top.
    fn cells(&self, panel: &Panel) -> Vec<f64> {
        let (rows, columns) = CELLS;
        let edges = |axis: &Axis, count: usize| -> Vec<f64> {
            (0..=count)
                .map(|k| axis.value(k as f64 / count as f64))
                .collect()
        };
        let up = groups(self.frequency_hz, &edges(&panel.y, rows));
        let across = groups(self.time_s, &edges(&panel.x, columns));
        let mean = |frequencies: &Range<usize>, times: &Range<usize>| {
            let all = frequencies
                .clone()
                .flat_map(|k| times.clone().map(move |m| self.density[[k, m]]));
            all.sum::<f64>() / (frequencies.len() * times.len()) as f64
        };
        up.iter()
            .rev()
            .flat_map(|row| {
                across
                    .iter()
                    .map(move |column| 10.0 * mean(row, column).log10())
            })
            .collect()
    }

    /// Draws one multiple of the excitation's frequency, with its name where it leaves the picture
    /// or, if it ends before, at the right edge.
    fn mark(&self, figure: &mut Figure, panel: &Panel, harmonic: u32) {
        let seen = self.sweep.iter().filter(|(s, _)| panel.x.holds(*s));
        let line: Vec<(f64, f64)> = seen.map(|&(s, hz)| (s, f64::from(harmonic) * hz)).collect();
        let ink = Ink {
            pen: Some(HARMONIC),
            marker: None,
            color: HARMONIC.color,
        };
        panel.curve(figure, &line, &ink);
        let name = if harmonic == 1 {
            "f".to_owned()
        } else {
            format!("{harmonic}f")
        };
        match (
            line.iter().position(|&(_, hz)| panel.y.share(hz) > 1.0),
            line.last(),
        ) {
            (Some(0), _) | (_, None) => {}
            (Some(first), _) => {
                let at = (panel.at(line[first].0, 0.0).0, panel.rect.y - 6.0);
                figure.text(at, &name, TICK_SIZE, Align::Center);
            }
            (None, Some(&(s, hz))) => {
                let (x, y) = (panel.rect.x + panel.rect.width, panel.at(s, hz).1);
                figure.text((x + 6.0, y + 4.0), &name, TICK_SIZE, Align::Left);
            }
        }
    }
}

/// First and last time with half a step beyond.
fn span(centres: &[f64]) -> (f64, f64) {
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
    let (low, high) = span(centres);
    let group = |pair: &[f64]| {
        let (first, end) = (
            centres.partition_point(|c| *c < pair[0]),
            centres.partition_point(|c| *c < pair[1]),
        );
        let middle = (pair[0] + pair[1]) / 2.0;
        if first < end {
            first..end
        } else if centres.is_empty() || !(low..=high).contains(&middle) {
            0..0
        } else {
            let right = first.min(centres.len() - 1);
            let left = right.saturating_sub(1);
            let nearest = if middle - centres[left] < centres[right] - middle {
                left
            } else {
                right
            };
            nearest..nearest + 1
        }
    };
    edges.windows(2).map(group).collect()
}

/// The colour bar with its label, to the right of the plot.
fn draw_bar(figure: &mut Figure, scale: &Axis, label: &str) -> Result<(), ReportError> {
    let rect = Rect {
        x: LEFT + WIDTH + BESIDE,
        y: ABOVE,
        width: BAR,
        height: HEIGHT,
    };
    figure.image(rect, (STEPS, 1), |row, _| {
        color(1.0 - (row as f64 + 0.5) / STEPS as f64)
    })?;
    let bar = Panel {
        rect,
        x: Axis::exact([0.0, 1.0].into_iter(), BAR),
        y: scale.clone(),
    };
    bar.frame(figure);
    for (value, text) in &scale.ticks {
        let (right, y) = bar.at(1.0, *value);
        figure.line(vec![(right, y), (right + TICK, y)], FRAME);
        figure.text((right + 6.0, y + 4.0), text, TICK_SIZE, Align::Left);
    }
    figure.upward_text(
        (rect.x + BAR + 52.0, rect.y + rect.height / 2.0),
        label,
        LABEL_SIZE,
    );
    Ok(())
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
