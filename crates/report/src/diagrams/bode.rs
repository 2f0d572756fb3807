//! Bode diagrams: magnitude in dB above phase in degrees, over a logarithmic frequency axis in Hz.

use crate::diagrams::curve::{self, Curve, Ink, Labels, Mark, inks};
use crate::diagrams::phase;
use crate::error::ReportError;
use crate::figure::axis::Axis;
use crate::figure::legend::Legend;
use crate::figure::panel::{BELOW, GAP, LABEL_SIZE, LEFT, Panel, RIGHT, TICK_SIZE};
use crate::figure::{Align, Figure, Marker, Rect};

const TITLE: f64 = 24.0;
/// Half the height of a mark in pixels.
const MARK: f64 = 5.5;
/// The same of the cross at a flagged line.
const CROSS: f64 = 3.2;
/// Width that a matrix is given, and that of a cell at least and at most, in pixels.
const ACROSS: f64 = 1100.0;
const CELL: (f64, f64) = (170.0, 260.0);
/// What lies further below the highest magnitude is rounding and does not stretch the axis, in dB.
const DEEPEST_DB: f64 = 140.0;

/// Bode diagram of one entry `(output, input)` of several FRFs: magnitude above, phase below, as in
/// SK15 figures 4 and 5.
///
/// Magnitude in dB relative to 1 `labels.gain_unit`; phase in degrees, wrapped into (-180, 180],
/// with gaps where it wraps. Lines that are not finite, or zero, are left out. The shaded band is
/// the 95 % region |dG| <= rho of each entry: 20 lg(|G| -+ rho) and arg G -+ asin(rho / |G|).
///
/// # Errors
/// [`ReportError`] if there are no curves, they differ in size, `labels` does not fit, or a
/// frequency is not above zero.
pub fn bode(
    curves: &[Curve],
    output: usize,
    input: usize,
    labels: &Labels,
) -> Result<Figure, ReportError> {
    let (outputs, inputs) = curve::check("a Bode diagram", curves, labels)?;
    if output >= outputs || input >= inputs {
        let curve = curves[0].label.clone();
        return Err(ReportError::NoSuchEntry {
            curve,
            outputs,
            inputs,
            output,
            input,
        });
    }
    Ok(Sheet {
        curves,
        labels,
        marks: &[],
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
/// With `with_phase` every magnitude has its phase below it; without, the figure holds magnitudes
/// only (SK15 figures 8-10). `marks` point out magnitudes, as figure 9 does with peaks.
///
/// # Errors
/// As [`bode`], or if a mark belongs to no curve or entry.
pub fn bode_matrix(
    curves: &[Curve],
    labels: &Labels,
    with_phase: bool,
    marks: &[Mark],
) -> Result<Figure, ReportError> {
    let (outputs, inputs) = curve::check("a matrix of Bode diagrams", curves, labels)?;
    curve::check_marks(marks, curves, (outputs, inputs))?;
    Ok(Sheet {
        curves,
        labels,
        marks,
        rows: (0..outputs).collect(),
        columns: (0..inputs).collect(),
        width: (ACROSS / inputs as f64).clamp(CELL.0, CELL.1),
        magnitude: 150.0,
        phase: with_phase.then_some(100.0),
    }
    .draw())
}

/// The layout of a figure: which entries, and the size of a cell's panels in pixels.
struct Sheet<'a> {
    curves: &'a [Curve<'a>],
    labels: &'a Labels,
    marks: &'a [Mark],
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
        let special = self.special(&inks);
        let names = self
            .curves
            .iter()
            .map(|curve| curve.label.as_str())
            .zip(&inks);
        let legend = Legend::new(
            names.chain(special.iter().map(|(name, ink)| (*name, ink))),
            across,
        );
        let top = 8.0 + legend.height();
        let mut figure = Figure::new(
            LEFT + across + RIGHT,
            top + self.rows.len() as f64 * cell + BELOW + 10.0,
        );
        legend.draw(&mut figure, LEFT, 8.0);
        let reference = format!("0 dB = 1 {}", self.labels.gain_unit);
        figure.text(
            (LEFT + across, figure.height() - 8.0),
            &reference,
            TICK_SIZE,
            Align::Right,
        );
        let axes = self.axes();
        for (row, &output) in self.rows.iter().enumerate() {
            for (column, &input) in self.columns.iter().enumerate() {
                let (left, above) = (
                    LEFT + column as f64 * (self.width + GAP),
                    top + row as f64 * cell,
                );
                let title = self.labels.entry(output, input);
                figure.text(
                    (left + self.width / 2.0, above + TITLE - 7.0),
                    &title,
                    LABEL_SIZE,
                    Align::Center,
                );
                let edge = Edge {
                    left: column == 0,
                    bottom: row + 1 == self.rows.len(),
                };
                self.cell(
                    &mut figure,
                    (left, above + TITLE),
                    (output, input),
                    &axes,
                    &inks,
                    edge,
                );
            }
        }
        figure
    }

    /// Names and inks of what the legend explains besides the curves: marks and flagged lines.
    fn special(&self, inks: &[Ink]) -> Vec<(&str, Ink)> {
        let mut names: Vec<(&str, Ink)> = Vec::new();
        for mark in self.marks {
            if names.iter().all(|(name, _)| *name != mark.label) {
                names.push((&mark.label, mark.ink(inks)));
            }
        }
        for (curve, ink) in self.curves.iter().zip(inks) {
            if (0..curve.frf.n_frequencies()).any(|k| curve.is_flagged(k)) {
                names.push(("flagged line", cross(ink)));
            }
        }
        names
    }

    /// Axes that hold every curve of every entry: frequency, magnitude and phase.
    fn axes(&self) -> (Axis, Axis, Axis) {
        let entries = || {
            self.rows
                .iter()
                .flat_map(|&output| self.columns.iter().map(move |&input| (output, input)))
        };
        let of_all = |values: fn(&Curve, usize, usize) -> Vec<f64>| -> Vec<f64> {
            entries()
                .flat_map(|(output, input)| {
                    self.curves
                        .iter()
                        .flat_map(move |curve| values(curve, output, input))
                })
                .collect()
        };
        let mut magnitudes = of_all(|curve, output, input| curve.frf.magnitude_db(output, input));
        let highest = magnitudes
            .iter()
            .copied()
            .filter(|db| db.is_finite())
            .fold(f64::NEG_INFINITY, f64::max);
        magnitudes.retain(|db| *db >= highest - DEEPEST_DB);
        magnitudes.extend(self.marks.iter().map(|mark| mark.magnitude_db));
        let phases = of_all(|curve, output, input| curve.frf.phase_deg(output, input));
        let frequencies = self
            .curves
            .iter()
            .flat_map(|curve| curve.frf.frequency_hz.iter().copied());
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
            let rect = Rect {
                x: corner.0,
                y,
                width: self.width,
                height,
            };
            Panel {
                rect,
                x: axes.0.clone(),
                y: axis.clone(),
            }
        };
        let magnitude = panel(corner.1, self.magnitude, &axes.1);
        magnitude.draw(figure, |figure| {
            self.curves
                .iter()
                .zip(inks)
                .for_each(|(curve, ink)| draw_magnitude(figure, &magnitude, curve, entry, ink));
        });
        self.curves.iter().zip(inks).for_each(|(curve, ink)| {
            draw_flags(
                figure,
                &magnitude,
                curve,
                &curve.frf.magnitude_db(entry.0, entry.1),
                ink,
            );
        });
        for mark in self
            .marks
            .iter()
            .filter(|mark| (mark.output, mark.input) == entry)
        {
            magnitude.mark(
                figure,
                (mark.frequency_hz, mark.magnitude_db),
                &mark.ink(inks),
                MARK,
            );
        }
        if edge.left {
            magnitude.label_y(figure, "Magnitude in dB");
        }
        let mut lowest = magnitude;
        if let Some(height) = self.phase {
            let phase = panel(corner.1 + self.magnitude + GAP, height, &axes.2);
            phase.draw(figure, |figure| {
                self.curves
                    .iter()
                    .zip(inks)
                    .for_each(|(curve, ink)| draw_phase(figure, &phase, curve, entry, ink));
            });
            self.curves.iter().zip(inks).for_each(|(curve, ink)| {
                draw_flags(
                    figure,
                    &phase,
                    curve,
                    &curve.frf.phase_deg(entry.0, entry.1),
                    ink,
                );
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

fn draw_magnitude(
    figure: &mut Figure,
    panel: &Panel,
    curve: &Curve,
    (output, input): (usize, usize),
    ink: &Ink,
) {
    let frf = curve.frf;
    if let Some(radius) = curve::region(curve, output, input) {
        let bound = |sign: f64| -> Vec<(f64, f64)> {
            let value = |k: usize| {
                20.0 * (frf.response[[k, output, input]].norm() + sign * radius[k])
                    .max(0.0)
                    .log10()
            };
            frf.frequency_hz
                .iter()
                .enumerate()
                .map(|(k, &hz)| (hz, value(k)))
                .collect()
        };
        panel.band(figure, &bound(-1.0), &bound(1.0), ink.color);
    }
    let values: Vec<(f64, f64)> = frf
        .frequency_hz
        .iter()
        .copied()
        .zip(frf.magnitude_db(output, input))
        .collect();
    panel.curve(
        figure,
        &values,
        &Ink {
            marker: None,
            ..*ink
        },
    );
    draw_markers(figure, panel, curve, &values, ink);
}

/// The markers of a curve, where it is not flagged.
fn draw_markers(
    figure: &mut Figure,
    panel: &Panel,
    curve: &Curve,
    values: &[(f64, f64)],
    ink: &Ink,
) {
    let sound = values
        .iter()
        .enumerate()
        .filter(|(k, _)| !curve.is_flagged(*k))
        .map(|(_, value)| *value);
    panel.curve(
        figure,
        &sound.collect::<Vec<_>>(),
        &Ink { pen: None, ..*ink },
    );
}

/// Crosses where a curve is flagged, over all curves.
fn draw_flags(figure: &mut Figure, panel: &Panel, curve: &Curve, values: &[f64], ink: &Ink) {
    for (k, (&hz, &value)) in curve.frf.frequency_hz.iter().zip(values).enumerate() {
        if curve.is_flagged(k) {
            panel.mark(figure, (hz, value), &cross(ink), CROSS);
        }
    }
}

/// How flagged lines of a curve are drawn.
fn cross(ink: &Ink) -> Ink {
    Ink {
        pen: None,
        marker: Some(Marker::Cross),
        ..*ink
    }
}

fn draw_phase(
    figure: &mut Figure,
    panel: &Panel,
    curve: &Curve,
    (output, input): (usize, usize),
    ink: &Ink,
) {
    let frf = curve.frf;
    let phase_deg = frf.phase_deg(output, input);
    let radius = curve::region(curve, output, input);
    for run in phase::runs(&phase_deg) {
        let shifted = |by: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            run.iter()
                .map(|&(k, phase)| (frf.frequency_hz[k], phase + by(k)))
                .collect()
        };
        if let Some(radius) = &radius {
            let half_width = |k: usize| match radius[k] / frf.response[[k, output, input]].norm() {
                ratio if ratio < 1.0 => ratio.asin().to_degrees(),
                _ => 180.0,
            };
            panel.band(
                figure,
                &shifted(&|k| -half_width(k)),
                &shifted(&half_width),
                ink.color,
            );
        }
        panel.curve(
            figure,
            &shifted(&|_| 0.0),
            &Ink {
                marker: None,
                ..*ink
            },
        );
    }
    let values: Vec<(f64, f64)> = frf.frequency_hz.iter().copied().zip(phase_deg).collect();
    draw_markers(figure, panel, curve, &values, ink);
}
