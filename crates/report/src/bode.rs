//! Bode diagrams: magnitude in dB above phase in degrees, over a logarithmic frequency axis in Hz.

use crate::axis::Axis;
use crate::curve::{self, Curve, Ink, Labels, inks};
use crate::figure::{Align, Figure, Rect};
use crate::legend::Legend;
use crate::panel::{BELOW, GAP, LABEL_SIZE, LEFT, Panel, RIGHT, TICK_SIZE};
use crate::{ReportError, phase};

const TITLE: f64 = 24.0;

/// Bode diagram of one entry `(output, input)` of several FRFs: magnitude above, phase below, as in SK15 figures 4 and 5.
///
/// Magnitude in dB relative to 1 `labels.gain_unit`; phase in degrees, wrapped into (-180, 180], with gaps where it wraps.
/// Lines that are not finite, or zero, are left out. The shaded band is the 95 % region |dG| <= rho of each entry:
/// 20 lg(|G| -+ rho) and arg G -+ asin(rho / |G|).
///
/// # Errors
/// [`ReportError`] if there are no curves, they differ in size, `labels` does not fit, or a frequency is not above zero.
pub fn bode(curves: &[Curve], output: usize, input: usize, labels: &Labels) -> Result<Figure, ReportError> {
    let (outputs, inputs) = curve::check("a Bode diagram", curves, labels)?;
    if output >= outputs || input >= inputs {
        let curve = curves[0].label.clone();
        return Err(ReportError::NoSuchEntry { curve, outputs, inputs, output, input });
    }
    Ok(Sheet {
        curves,
        labels,
        rows: vec![output],
        columns: vec![input],
        width: 540.0,
        magnitude: 230.0,
        phase: Some(160.0),
    }
    .draw())
}

/// Bode diagrams of all entries, one row per output and one column per input, on common axes.
///
/// With `with_phase` every magnitude has its phase below it; without, the figure holds magnitudes only (SK15 figures 8-10).
///
/// # Errors
/// As [`bode`].
pub fn bode_matrix(curves: &[Curve], labels: &Labels, with_phase: bool) -> Result<Figure, ReportError> {
    let (outputs, inputs) = curve::check("a matrix of Bode diagrams", curves, labels)?;
    let (rows, columns) = ((0..outputs).collect(), (0..inputs).collect());
    Ok(Sheet { curves, labels, rows, columns, width: 260.0, magnitude: 150.0, phase: with_phase.then_some(100.0) }
        .draw())
}

/// The layout of a figure: which entries, and the size of a cell's panels in pixels.
struct Sheet<'a> {
    curves: &'a [Curve<'a>],
    labels: &'a Labels,
    rows: Vec<usize>,
    columns: Vec<usize>,
    width: f64,
    magnitude: f64,
    phase: Option<f64>,
}

impl Sheet<'_> {
    fn draw(&self) -> Figure {
        let inks = inks(self.curves.iter().map(|curve| curve.style));
        let cell = TITLE + self.magnitude + self.phase.map_or(0.0, |height| height + GAP) + 6.0;
        let across = self.columns.len() as f64 * (self.width + GAP) - GAP;
        let legend = Legend::new(self.curves.iter().map(|curve| curve.label.as_str()).zip(&inks), across);
        let top = 8.0 + legend.height();
        let mut figure = Figure::new(LEFT + across + RIGHT, top + self.rows.len() as f64 * cell + BELOW + 10.0);
        legend.draw(&mut figure, LEFT, 8.0);
        let reference = format!("0 dB = 1 {}", self.labels.gain_unit);
        figure.text((LEFT + across, figure.height() - 8.0), &reference, TICK_SIZE, Align::Right);
        let axes = self.axes();
        for (row, &output) in self.rows.iter().enumerate() {
            for (column, &input) in self.columns.iter().enumerate() {
                let (left, above) = (LEFT + column as f64 * (self.width + GAP), top + row as f64 * cell);
                let title = self.labels.entry(output, input);
                figure.text((left + self.width / 2.0, above + TITLE - 7.0), &title, LABEL_SIZE, Align::Center);
                let edge = Edge { left: column == 0, bottom: row + 1 == self.rows.len() };
                self.cell(&mut figure, (left, above + TITLE), (output, input), &axes, &inks, edge);
            }
        }
        figure
    }

    /// Axes that hold every curve of every entry: frequency, magnitude and phase.
    fn axes(&self) -> (Axis, Axis, Axis) {
        let entries = || self.rows.iter().flat_map(|&output| self.columns.iter().map(move |&input| (output, input)));
        let of_all = |values: fn(&Curve, usize, usize) -> Vec<f64>| -> Vec<f64> {
            entries()
                .flat_map(|(output, input)| self.curves.iter().flat_map(move |curve| values(curve, output, input)))
                .collect()
        };
        let magnitudes = of_all(|curve, output, input| curve.frf.magnitude_db(output, input));
        let phases = of_all(|curve, output, input| curve.frf.phase_deg(output, input));
        let frequencies = self.curves.iter().flat_map(|curve| curve.frf.frequency_hz.iter().copied());
        (
            Axis::frequency(frequencies, self.width),
            Axis::linear(magnitudes.into_iter(), self.magnitude),
            Axis::degrees(phases.into_iter(), self.phase.unwrap_or(self.magnitude)),
        )
    }

    /// Magnitude and phase of one entry, with its upper left corner at `corner`.
    fn cell(
        &self,
        figure: &mut Figure,
        corner: (f64, f64),
        entry: (usize, usize),
        axes: &(Axis, Axis, Axis),
        inks: &[Ink],
        edge: Edge,
    ) {
        let panel = |y: f64, height: f64, axis: &Axis| {
            let rect = Rect { x: corner.0, y, width: self.width, height };
            Panel { rect, x: axes.0.clone(), y: axis.clone() }
        };
        let magnitude = panel(corner.1, self.magnitude, &axes.1);
        magnitude.draw(figure, |figure| {
            self.curves.iter().zip(inks).for_each(|(curve, ink)| draw_magnitude(figure, &magnitude, curve, entry, ink));
        });
        if edge.left {
            magnitude.label_y(figure, "Magnitude in dB");
        }
        let mut lowest = magnitude;
        if let Some(height) = self.phase {
            let phase = panel(corner.1 + self.magnitude + GAP, height, &axes.2);
            phase.draw(figure, |figure| {
                self.curves.iter().zip(inks).for_each(|(curve, ink)| draw_phase(figure, &phase, curve, entry, ink));
            });
            if edge.left {
                phase.label_y(figure, "Phase in deg");
            }
            lowest = phase;
        }
        if edge.bottom {
            lowest.label_x(figure, "Frequency in Hz");
        }
    }
}

/// Whether a cell lies on the edge of the matrix that carries labels.
#[derive(Clone, Copy)]
struct Edge {
    left: bool,
    bottom: bool,
}

fn draw_magnitude(figure: &mut Figure, panel: &Panel, curve: &Curve, (output, input): (usize, usize), ink: &Ink) {
    let frf = curve.frf;
    if let Some(radius) = curve::region(curve, output, input) {
        let bound = |sign: f64| -> Vec<(f64, f64)> {
            let value = |k: usize| 20.0 * (frf.response[[k, output, input]].norm() + sign * radius[k]).max(0.0).log10();
            frf.frequency_hz.iter().enumerate().map(|(k, &hz)| (hz, value(k))).collect()
        };
        panel.band(figure, &bound(-1.0), &bound(1.0), ink.color);
    }
    let values: Vec<(f64, f64)> = frf.frequency_hz.iter().copied().zip(frf.magnitude_db(output, input)).collect();
    panel.curve(figure, &values, ink);
}

fn draw_phase(figure: &mut Figure, panel: &Panel, curve: &Curve, (output, input): (usize, usize), ink: &Ink) {
    let frf = curve.frf;
    let phase_deg = frf.phase_deg(output, input);
    let radius = curve::region(curve, output, input);
    for run in phase::runs(&phase_deg) {
        let shifted = |by: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            run.iter().map(|&(k, phase)| (frf.frequency_hz[k], phase + by(k))).collect()
        };
        if let Some(radius) = &radius {
            let half_width = |k: usize| match radius[k] / frf.response[[k, output, input]].norm() {
                ratio if ratio < 1.0 => ratio.asin().to_degrees(),
                _ => 180.0,
            };
            panel.band(figure, &shifted(&|k| -half_width(k)), &shifted(&half_width), ink.color);
        }
        panel.curve(figure, &shifted(&|_| 0.0), &Ink { marker: None, ..*ink });
    }
    let values: Vec<(f64, f64)> = frf.frequency_hz.iter().copied().zip(phase_deg).collect();
    panel.curve(figure, &values, &Ink { pen: None, ..*ink });
}
