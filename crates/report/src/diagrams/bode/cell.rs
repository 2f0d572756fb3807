//! Cell of a Bode diagram: magnitude above phase of one entry.

use std::iter::zip;

use frfid_signals::Frf;

use crate::diagrams::bode::phase;
use crate::diagrams::bode::sheet::Sheet;
use crate::diagrams::curve::Curve;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::geometry::{Point, Rect};
use crate::figure::ink::{Ink, Marker};
use crate::figure::panel::{GAP, Panel, Value};

/// Half the height of a mark in pixels.
const MARK: f64 = 5.5;
/// The same of the tick at a flagged line.
const TICK: f64 = 3.2;

/// The axes that all cells share.
pub(crate) struct Axes {
    pub(crate) frequency: Axis,
    pub(crate) magnitude: Axis,
    pub(crate) phase: Axis,
}

/// One entry of a sheet, and which of its edges carry labels.
pub(crate) struct Cell<'a> {
    pub(crate) sheet: &'a Sheet<'a>,
    pub(crate) axes: &'a Axes,
    /// Output and input.
    pub(crate) entry: (usize, usize),
    pub(crate) is_leftmost: bool,
    pub(crate) is_lowest: bool,
}

/// A curve of an entry over frequency: pairs of Hz and dB or degrees.
type Line = Vec<Value>;

impl Cell<'_> {
    /// Draws magnitude and phase with the upper left corner at `corner`.
    pub(crate) fn draw(&self, figure: &mut Figure, (left, top): Point) {
        let magnitude = self.magnitude(figure, (left, top));
        let phase_corner = (left, top + self.sheet.magnitude + GAP);
        let height = self.sheet.phase;
        let phase = height.map(|height| self.phase(figure, phase_corner, height));
        if self.is_lowest {
            let lowest = phase.unwrap_or(magnitude);
            lowest.label_x(figure, "Frequency in Hz");
        }
    }

    /// Draws the magnitudes of all curves, and the marks.
    fn magnitude(&self, figure: &mut Figure, corner: Point) -> Panel {
        let panel = self.panel(corner, self.sheet.magnitude, &self.axes.magnitude);
        panel.draw(figure, |figure| {
            for (curve, ink) in self.sheet.in_order_of_drawing() {
                self.magnitude_curve(figure, &panel, curve, ink);
            }
        });
        self.flags(figure, &panel);
        self.marks(figure, &panel);
        if self.is_leftmost {
            panel.label_y(figure, "Magnitude in dB");
        }
        panel
    }

    /// Draws the phases of all curves.
    fn phase(&self, figure: &mut Figure, corner: Point, height: f64) -> Panel {
        let panel = self.panel(corner, height, &self.axes.phase);
        panel.draw(figure, |figure| {
            for (curve, ink) in self.sheet.in_order_of_drawing() {
                self.phase_curve(figure, &panel, curve, ink);
            }
        });
        self.flags(figure, &panel);
        if self.is_leftmost {
            panel.label_y(figure, "Phase in deg");
        }
        panel
    }

    fn panel(&self, (x, y): Point, height: f64, vertical: &Axis) -> Panel {
        Panel {
            rect: Rect {
                x,
                y,
                width: self.sheet.width,
                height,
            },
            x: self.axes.frequency.clone(),
            y: vertical.clone(),
        }
    }

    /// Draws the region, line and markers of a magnitude.
    fn magnitude_curve(&self, figure: &mut Figure, panel: &Panel, curve: &Curve, ink: &Ink) {
        if let Some(radius) = curve.region(self.entry) {
            let [low, high] = [-1.0, 1.0].map(|sign| self.bound_db(curve, &radius, sign));
            panel.band(figure, &low, &high, ink.color);
        }
        let line = self.line(curve, Frf::magnitude_db);
        panel.curve(figure, &line, &ink.without_markers());
        panel.curve(figure, &line, &ink.without_line());
    }

    /// The magnitude with the radius of its region added or subtracted.
    fn bound_db(&self, curve: &Curve, radius: &[f64], sign: f64) -> Line {
        let bounds =
            zip(curve.sizes(self.entry), radius).map(|(size, radius)| size + sign * radius);
        let bounds_db = bounds.map(|bound| 20.0 * bound.clamp(0.0, f64::INFINITY).log10());
        over_frequency(curve, bounds_db)
    }

    /// Draws the region, line and markers of a phase, with gaps where it wraps.
    fn phase_curve(&self, figure: &mut Figure, panel: &Panel, curve: &Curve, ink: &Ink) {
        let phase_deg = self.values(curve, Frf::phase_deg);
        let region = curve.region(self.entry);
        let half_width_deg = region.map(|radius| self.half_width_deg(curve, &radius));
        for run in phase::runs(&phase_deg) {
            let shifted = |by: &dyn Fn(usize) -> f64| shifted_run(curve, &run, by);
            if let Some(half) = &half_width_deg {
                let (low, high) = (shifted(&|k| -half[k]), shifted(&|k| half[k]));
                panel.band(figure, &low, &high, ink.color);
            }
            panel.curve(figure, &shifted(&|_| 0.0), &ink.without_markers());
        }
        let line = over_frequency(curve, phase_deg);
        panel.curve(figure, &line, &ink.without_line());
    }

    /// Half the width of the region of a phase, seen from the origin.
    fn half_width_deg(&self, curve: &Curve, radius: &[f64]) -> Vec<f64> {
        let ratios = zip(radius, curve.sizes(self.entry)).map(|(radius, size)| radius / size);
        let half_width = |ratio: f64| {
            if ratio < 1.0 {
                ratio.asin().to_degrees()
            } else {
                180.0
            }
        };
        ratios.map(half_width).collect()
    }

    /// Draws ticks below the upper edge at the frequencies at which curves are flagged, where they
    /// hide no curve: a row for each curve.
    fn flags(&self, figure: &mut Figure, panel: &Panel) {
        let flagged = self.sheet.inked_curves();
        let flagged = flagged.filter(|(curve, _)| curve.has_flags());
        for (row, (curve, ink)) in flagged.enumerate() {
            let y = panel.rect.y + (2.0 * row as f64 + 1.5) * TICK;
            for (k, &hz) in curve.frf.frequency_hz.iter().enumerate() {
                let (x, _) = panel.at((hz, 0.0));
                if curve.is_flagged(k) && x.is_finite() {
                    figure.marker((x, y), Marker::Tick, TICK, ink.color);
                }
            }
        }
    }

    /// Draws the marks of this entry.
    fn marks(&self, figure: &mut Figure, panel: &Panel) {
        for mark in self.sheet.marks {
            if mark.entry() == self.entry {
                panel.mark(figure, mark.place(), &mark.ink(&self.sheet.inks), MARK);
            }
        }
    }

    /// Values of a curve at this entry, over frequency.
    fn line(&self, curve: &Curve, of_entry: Values) -> Line {
        over_frequency(curve, self.values(curve, of_entry))
    }

    /// Values of a curve at this entry.
    fn values(&self, curve: &Curve, of_entry: Values) -> Vec<f64> {
        let (output, input) = self.entry;
        of_entry(curve.frf, output, input)
    }
}

/// Magnitude or phase of one entry of an FRF.
pub(crate) type Values = fn(&Frf, usize, usize) -> Vec<f64>;

/// Values of a curve with their frequencies.
fn over_frequency(curve: &Curve, values: impl IntoIterator<Item = f64>) -> Line {
    let frequencies = curve.frf.frequency_hz.iter().copied();
    frequencies.zip(values).collect()
}

/// A run of phases, each shifted by a number of degrees.
fn shifted_run(curve: &Curve, run: &[(usize, f64)], by: &dyn Fn(usize) -> f64) -> Line {
    run.iter()
        .map(|&(k, phase)| (curve.frf.frequency_hz[k], phase + by(k)))
        .collect()
}
