//! Time series: signals with their limits and envelopes, for design reports.

use ndarray::ArrayView1;

use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::geometry::Rect;
use crate::figure::ink::{COLORS, Ink, LIMIT, Pen};
use crate::figure::legend::Legend;
use crate::figure::panel::{GAP, LEFT, Panel, Value};
use crate::validation;

const WIDTH: f64 = 540.0;
const HEIGHT: f64 = 140.0;
/// Room between the legend and the first panel.
const ABOVE: f64 = 8.0;
const ENVELOPE: Ink = Ink::line(Pen::solid("#000000", 1.4));

/// One signal over time.
#[derive(Debug, Clone)]
pub struct Trace<'a> {
    /// Name in the legend; traces of one name share one entry.
    pub label: String,
    /// Samples, in the unit the panel's label states.
    pub samples: ArrayView1<'a, f64>,
}

/// Signals of one quantity on a common vertical axis.
#[derive(Debug, Clone)]
pub struct TimePanel<'a> {
    /// Quantity and unit: `Torque in N m`.
    pub label: String,
    /// The signals.
    pub traces: Vec<Trace<'a>>,
    /// Limit on the absolute value, drawn as two dashed lines.
    pub limit: Option<f64>,
    /// Amplitude over time that the signals should have, drawn as two black lines, positive and
    /// negative.
    pub envelope: Option<Trace<'a>>,
}

/// Signals over time in s, one panel per quantity on a common time axis; the first sample is at
/// time 0.
///
/// # Errors
/// [`ReportError`] if there are no panels, or `sample_time_s` is not a finite number above zero.
pub fn time_series(sample_time_s: f64, panels: &[TimePanel]) -> Result<Figure, ReportError> {
    check(sample_time_s, panels)?;
    let inks = trace_inks(panels);
    let legend = legend(panels, &inks);
    let rows = panels.len() as f64 * (HEIGHT + GAP) - GAP;
    let mut figure = legend.figure(WIDTH, ABOVE + rows);
    let time = time_axis(sample_time_s, panels);
    for (row, content) in panels.iter().enumerate() {
        let top = legend.bottom() + ABOVE + row as f64 * (HEIGHT + GAP);
        let panel = content.panel(top, time.clone());
        content.draw(&mut figure, &panel, sample_time_s, &inks);
        if row + 1 == panels.len() {
            panel.label_x(&mut figure, "Time in s");
        }
    }
    Ok(figure)
}

/// Refuses no panels, and a sample time that is not above zero.
fn check(sample_time_s: f64, panels: &[TimePanel]) -> Result<(), ReportError> {
    if panels.is_empty() {
        return Err(ReportError::empty("a time series", "panels"));
    }
    let needed = "a finite number above 0";
    validation::value("sample_time_s", sample_time_s, needed, |value| value > 0.0)
}

/// The time from 0 to the end of the longest trace of all panels.
fn time_axis(sample_time_s: f64, panels: &[TimePanel]) -> Axis {
    let longest = panels.iter().map(TimePanel::longest).max().unwrap_or(0);
    Axis::exact([0.0, longest as f64 * sample_time_s], WIDTH)
}

/// Every label of a trace once, in order, with its ink.
fn trace_inks<'a>(panels: &'a [TimePanel]) -> Vec<(&'a str, Ink)> {
    let mut inks: Vec<(&str, Ink)> = Vec::new();
    for trace in panels.iter().flat_map(|panel| &panel.traces) {
        if inks.iter().all(|(label, _)| *label != trace.label) {
            inks.push((&trace.label, trace_ink(inks.len())));
        }
    }
    inks
}

/// Solid lines only: dashes of a noisy signal cannot be told from its zigzag.
fn trace_ink(k: usize) -> Ink {
    Ink::line(Pen::solid(COLORS[k % COLORS.len()], 1.2))
}

/// The legend: traces, the first envelope, and limits if there are any.
fn legend<'a>(panels: &'a [TimePanel], inks: &[(&'a str, Ink)]) -> Legend<'a> {
    let envelope = panels.iter().find_map(|panel| panel.envelope.as_ref());
    let is_limited = panels.iter().any(|panel| panel.limit.is_some());
    let envelope = envelope.map(|trace| (trace.label.as_str(), ENVELOPE));
    let limit = is_limited.then_some(("limit", LIMIT));
    Legend::new(inks.iter().copied().chain(envelope).chain(limit), WIDTH)
}

impl TimePanel<'_> {
    /// Number of samples of the longest trace.
    fn longest(&self) -> usize {
        let lengths = self.traces.iter().map(|trace| trace.samples.len());
        lengths.max().unwrap_or(0)
    }

    /// The frame of the panel, on a vertical axis that holds signals, limits and envelope.
    fn panel(&self, top: f64, time: Axis) -> Panel {
        let envelope = self.envelope.iter().flat_map(|trace| &trace.samples);
        let values = self
            .traces
            .iter()
            .flat_map(|trace| trace.samples.iter().copied())
            .chain(self.limits())
            .chain(envelope.flat_map(|&amplitude| [-amplitude, amplitude]));
        Panel {
            rect: Rect {
                x: LEFT,
                y: top,
                width: WIDTH,
                height: HEIGHT,
            },
            x: time,
            y: Axis::padded(values, HEIGHT),
        }
    }

    /// The limit on both sides of zero.
    fn limits(&self) -> impl Iterator<Item = f64> {
        self.limit.into_iter().flat_map(|limit| [-limit, limit])
    }

    /// Draws the signals, the envelope and the limits, in this order, and what the panel shows.
    fn draw(&self, figure: &mut Figure, panel: &Panel, step: f64, inks: &[(&str, Ink)]) {
        panel.draw(figure, |figure| {
            for trace in &self.traces {
                if let Some((_, ink)) = inks.iter().find(|(label, _)| *label == trace.label) {
                    panel.curve(figure, &trace.points(step, 1.0), ink);
                }
            }
            self.draw_envelope(figure, panel, step);
            self.draw_limits(figure, panel, step);
        });
        panel.label_y(figure, &self.label);
    }

    fn draw_envelope(&self, figure: &mut Figure, panel: &Panel, step: f64) {
        if let Some(trace) = &self.envelope {
            for factor in [1.0, -1.0] {
                panel.curve(figure, &trace.points(step, factor), &ENVELOPE);
            }
        }
    }

    fn draw_limits(&self, figure: &mut Figure, panel: &Panel, step: f64) {
        let end = self.longest() as f64 * step;
        for limit in self.limits() {
            panel.curve(figure, &[(0.0, limit), (end, limit)], &LIMIT);
        }
    }
}

impl Trace<'_> {
    /// Pairs of time in s and value times a factor.
    fn points(&self, step: f64, factor: f64) -> Vec<Value> {
        self.samples
            .iter()
            .enumerate()
            .map(|(k, &y)| (k as f64 * step, factor * y))
            .collect()
    }
}
