//! Spectrogram: power spectral density over time as a heat map (SK15 figure 3).

pub(crate) mod cells;

use ndarray::ArrayView2;

use crate::diagrams::spectrogram::cells::{CELLS, levels_db, span};
use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::colormap::{STEPS, color};
use crate::figure::drawing::Align;
use crate::figure::geometry::Rect;
use crate::figure::ink::{Ink, Pen};
use crate::figure::panel::{BELOW, FRAME, LABEL_SIZE, LEFT, Panel, TICK, TICK_SIZE, Value};
use crate::figure::ticks::highest;
use crate::validation;

const WIDTH: f64 = 540.0;
const HEIGHT: f64 = 280.0;
/// Room above for the names of the harmonics, between the plot and its colour bar, and to the right
/// of that.
const ABOVE: f64 = 24.0;
const BESIDE: f64 = 34.0;
const BAR: f64 = 14.0;
const RIGHT: f64 = 66.0;
/// Dots that are seen on every colour of the map but its brightest, where the line runs along the
/// ridge it points out.
const HARMONIC: Ink = Ink::line(Pen {
    color: "#ffffff",
    width: 0.9,
    dash: "1.5 4",
});

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
    let mut figure = Figure::new(LEFT + WIDTH + BESIDE + BAR + RIGHT, ABOVE + HEIGHT + BELOW);
    let panel = content.panel();
    let level_db = levels_db(content, &panel);
    let scale = content.scale(&level_db);
    figure.image(panel.rect, CELLS, |row, column| {
        color(scale.share(level_db[row * CELLS.1 + column]))
    })?;
    for &harmonic in &content.harmonics {
        content.mark(&mut figure, &panel, harmonic);
    }
    panel.frame(&mut figure);
    panel.ticks(&mut figure);
    panel.label_x(&mut figure, "Time in s");
    panel.label_y(&mut figure, "Frequency in Hz");
    let label = format!("Density in dB, 0 dB = 1 {}", content.unit);
    draw_bar(&mut figure, &scale, &label)?;
    Ok(figure)
}

impl Spectrogram<'_> {
    /// Refuses what cannot be drawn.
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
        self.check_band()?;
        let range_db = "range_db of the spectrogram";
        validation::value(range_db, self.range_db, "above 0", |db| db > 0.0)
    }

    fn check_band(&self) -> Result<(), ReportError> {
        let (low, high) = self.band_hz;
        let least = if self.log_frequency {
            f64::MIN_POSITIVE
        } else {
            0.0
        };
        let needed = "above 0 (from 0 on a linear axis)";
        validation::value("band_hz.0 of the spectrogram", low, needed, |hz| {
            hz >= least
        })?;
        let needed = "above band_hz.0";
        validation::value("band_hz.1 of the spectrogram", high, needed, |hz| hz > low)
    }

    /// The panel of the heat map: the analysed time over the band.
    fn panel(&self) -> Panel {
        let band: [f64; 2] = self.band_hz.into();
        let time_s: [f64; 2] = span(self.time_s).into();
        Panel {
            rect: Rect {
                x: LEFT,
                y: ABOVE,
                width: WIDTH,
                height: HEIGHT,
            },
            x: Axis::exact(time_s, WIDTH),
            y: if self.log_frequency {
                Axis::upright_log(band, HEIGHT)
            } else {
                Axis::exact(band, HEIGHT)
            },
        }
    }

    /// The axis of the colour bar, up to the highest level.
    fn scale(&self, level_db: &[f64]) -> Axis {
        let highest = highest(level_db).unwrap_or(0.0);
        Axis::linear([highest - self.range_db, highest], HEIGHT)
    }

    /// Draws one multiple of the excitation's frequency with its name.
    fn mark(&self, figure: &mut Figure, panel: &Panel, harmonic: u32) {
        let seen = self.sweep.iter().filter(|(s, _)| panel.x.holds(*s));
        let line: Vec<Value> = seen.map(|&(s, hz)| (s, f64::from(harmonic) * hz)).collect();
        panel.curve(figure, &line, &HARMONIC);
        write_name(figure, panel, &line, &harmonic_name(harmonic));
    }
}

/// Writes the name of a rising line where it leaves the picture or, if it ends before, at the right
/// edge.
fn write_name(figure: &mut Figure, panel: &Panel, line: &[Value], name: &str) {
    let leaves = line.iter().position(|&(_, hz)| panel.y.share(hz) > 1.0);
    match (leaves, line.last()) {
        (Some(0), _) | (_, None) => {}
        (Some(first), _) => {
            let at = (panel.at((line[first].0, 0.0)).0, panel.rect.y - 6.0);
            figure.text(at, name, TICK_SIZE, Align::Center);
        }
        (None, Some(&last)) => {
            let at = (panel.rect.right() + 6.0, panel.at(last).1 + 4.0);
            figure.text(at, name, TICK_SIZE, Align::Left);
        }
    }
}

/// Name of a multiple of the excitation's frequency f.
fn harmonic_name(harmonic: u32) -> String {
    if harmonic == 1 {
        "f".to_owned()
    } else {
        format!("{harmonic}f")
    }
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
        x: Axis::exact([0.0, 1.0], BAR),
        y: scale.clone(),
    };
    bar.frame(figure);
    label_right(figure, &bar);
    figure.upward_text((rect.right() + 52.0, rect.middle_y()), label, LABEL_SIZE);
    Ok(())
}

/// Ticks and labels to the right of a panel.
fn label_right(figure: &mut Figure, panel: &Panel) {
    for (value, text) in &panel.y.ticks {
        let (right, y) = panel.at((1.0, *value));
        figure.stroke((right, y), (right + TICK, y), FRAME);
        figure.text((right + 6.0, y + 4.0), text, TICK_SIZE, Align::Left);
    }
}
