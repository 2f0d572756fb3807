//! Figures of signals for design reports: time series with their limits, and the lines of a
//! spectrum.

use ndarray::ArrayView1;

use crate::diagrams::curve::{COLORS, Ink};
use crate::error::ReportError;
use crate::figure::axis::Axis;
use crate::figure::legend::Legend;
use crate::figure::panel::{BELOW, GAP, LEFT, Panel, RIGHT};
use crate::figure::{Figure, Marker, Pen, Rect};

const WIDTH: f64 = 540.0;
const HEIGHT: f64 = 140.0;
const LIMIT: Ink = Ink {
    pen: Some(Pen {
        color: "#666666",
        width: 1.2,
        dash: "8 4",
    }),
    marker: None,
    color: "#666666",
};
const ENVELOPE: Ink = Ink {
    pen: Some(Pen {
        color: "#000000",
        width: 1.4,
        dash: "",
    }),
    marker: None,
    color: "#000000",
};

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
    if panels.is_empty() {
        return Err(ReportError::Empty {
            figure: "a time series",
            missing: "panels",
        });
    }
    if !(sample_time_s.is_finite() && sample_time_s > 0.0) {
        let needed = "a finite number above 0";
        return Err(ReportError::Value {
            what: "sample_time_s".to_owned(),
            found: sample_time_s,
            needed,
        });
    }
    let names = legend_names(panels);
    let inks: Vec<Ink> = (0..names.len()).map(trace_ink).collect();
    let limited = panels.iter().any(|panel| panel.limit.is_some());
    let envelope = panels
        .iter()
        .find_map(|panel| Some((panel.envelope.as_ref()?.label.as_str(), &ENVELOPE)));
    let entries = names
        .iter()
        .copied()
        .zip(&inks)
        .chain(envelope)
        .chain(limited.then_some(("limit", &LIMIT)));
    let legend = Legend::new(entries, WIDTH);
    let top = 16.0 + legend.height();
    let mut figure = Figure::new(
        LEFT + WIDTH + RIGHT,
        top + panels.len() as f64 * (HEIGHT + GAP) - GAP + BELOW,
    );
    legend.draw(&mut figure, LEFT, 8.0);
    let longest = panels
        .iter()
        .flat_map(|panel| &panel.traces)
        .map(|trace| trace.samples.len())
        .max()
        .unwrap_or(0);
    let time = Axis::exact([0.0, longest as f64 * sample_time_s].into_iter(), WIDTH);
    for (row, content) in panels.iter().enumerate() {
        let rect = Rect {
            x: LEFT,
            y: top + row as f64 * (HEIGHT + GAP),
            width: WIDTH,
            height: HEIGHT,
        };
        let limits = content.limit.into_iter().flat_map(|limit| [-limit, limit]);
        let envelope = content
            .envelope
            .iter()
            .flat_map(|trace| trace.samples.iter().flat_map(|&a| [-a, a]));
        let traces = content
            .traces
            .iter()
            .flat_map(|trace| trace.samples.iter().copied());
        let values = traces.chain(limits).chain(envelope);
        let panel = Panel {
            rect,
            x: time.clone(),
            y: Axis::padded(values, HEIGHT),
        };
        panel.draw(&mut figure, |figure| {
            draw_traces(figure, &panel, content, sample_time_s, &names, &inks);
        });
        panel.label_y(&mut figure, &content.label);
        if row + 1 == panels.len() {
            panel.label_x(&mut figure, "Time in s");
        }
    }
    Ok(figure)
}

/// Solid lines only: dashes of a noisy signal cannot be told from its zigzag.
fn trace_ink(k: usize) -> Ink {
    let color = COLORS[k % COLORS.len()];
    Ink {
        pen: Some(Pen {
            color,
            width: 1.2,
            dash: "",
        }),
        marker: None,
        color,
    }
}

/// Every label once, in order.
fn legend_names<'a>(panels: &'a [TimePanel]) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for trace in panels.iter().flat_map(|panel| &panel.traces) {
        if !names.contains(&trace.label.as_str()) {
            names.push(&trace.label);
        }
    }
    names
}

fn draw_traces(
    figure: &mut Figure,
    panel: &Panel,
    content: &TimePanel,
    step: f64,
    names: &[&str],
    inks: &[Ink],
) {
    let points = |trace: &Trace, factor: f64| -> Vec<(f64, f64)> {
        trace
            .samples
            .iter()
            .enumerate()
            .map(|(k, &y)| (k as f64 * step, factor * y))
            .collect()
    };
    for trace in &content.traces {
        let ink = names
            .iter()
            .zip(inks)
            .find(|(name, _)| **name == trace.label);
        if let Some((_, ink)) = ink {
            panel.curve(figure, &points(trace, 1.0), ink);
        }
    }
    for (trace, factor) in content
        .envelope
        .iter()
        .flat_map(|trace| [(trace, 1.0), (trace, -1.0)])
    {
        panel.curve(figure, &points(trace, factor), &ENVELOPE);
    }
    let end = content
        .traces
        .iter()
        .map(|trace| trace.samples.len())
        .max()
        .unwrap_or(0) as f64
        * step;
    for limit in content.limit.into_iter().flat_map(|limit| [-limit, limit]) {
        panel.curve(figure, &[(0.0, limit), (end, limit)], &LIMIT);
    }
}

/// What a line of the period is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineRole {
    /// It carries excitation.
    Excited,
    /// It was left out on purpose, to detect what the nonlinearities put there.
    Detection,
    /// Any other line.
    Other,
}

/// One line of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralLine {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Single-sided physical amplitude 2|X|/N, in the unit the figure's label states.
    pub amplitude: f64,
    /// What the line is for.
    pub role: LineRole,
}

/// Amplitudes of a period's lines over a logarithmic frequency axis: excited lines as stems with
/// dots, detection lines as rings, the others as grey stems. `label` names quantity and unit:
/// `Amplitude of torque in N m`.
///
/// # Errors
/// [`ReportError`] if there are no lines or a frequency is not a finite number above zero.
pub fn spectrum(lines: &[SpectralLine], label: &str) -> Result<Figure, ReportError> {
    if lines.is_empty() {
        return Err(ReportError::Empty {
            figure: "a spectrum",
            missing: "lines",
        });
    }
    if let Some(line) = lines
        .iter()
        .find(|line| !(line.frequency_hz.is_finite() && line.frequency_hz > 0.0))
    {
        let needed = "finite and above 0 (the frequency axis is logarithmic)";
        return Err(ReportError::Value {
            what: "a frequency_hz".to_owned(),
            found: line.frequency_hz,
            needed,
        });
    }
    let present = [LineRole::Excited, LineRole::Detection, LineRole::Other]
        .into_iter()
        .filter(|role| lines.iter().any(|line| line.role == *role));
    let entries: Vec<(&str, Ink)> = present.map(role_ink).collect();
    let legend = Legend::new(entries.iter().map(|(name, ink)| (*name, ink)), WIDTH);
    let (top, height) = (16.0 + legend.height(), 1.5 * HEIGHT);
    let mut figure = Figure::new(LEFT + WIDTH + RIGHT, top + height + BELOW);
    legend.draw(&mut figure, LEFT, 8.0);
    let amplitudes = lines
        .iter()
        .map(|line| line.amplitude)
        .chain(std::iter::once(0.0));
    let x = Axis::frequency(lines.iter().map(|line| line.frequency_hz), WIDTH);
    let panel = Panel {
        rect: Rect {
            x: LEFT,
            y: top,
            width: WIDTH,
            height,
        },
        x,
        y: Axis::linear(amplitudes, height),
    };
    panel.draw(&mut figure, |figure| {
        for SpectralLine {
            frequency_hz,
            amplitude,
            role,
        } in lines
        {
            let ink = role_ink(*role).1;
            let stem = Ink {
                pen: Some(Pen {
                    color: ink.color,
                    width: 1.0,
                    dash: "",
                }),
                marker: None,
                ..ink
            };
            panel.curve(
                figure,
                &[(*frequency_hz, 0.0), (*frequency_hz, *amplitude)],
                &stem,
            );
            panel.curve(
                figure,
                &[(*frequency_hz, *amplitude)],
                &Ink { pen: None, ..ink },
            );
        }
    });
    panel.label_y(&mut figure, label);
    panel.label_x(&mut figure, "Frequency in Hz");
    Ok(figure)
}

/// Name and ink of a role.
fn role_ink(role: LineRole) -> (&'static str, Ink) {
    let grey = "#888888";
    match role {
        LineRole::Excited => (
            "excited lines",
            Ink {
                pen: None,
                marker: Some(Marker::Dot),
                color: COLORS[1],
            },
        ),
        LineRole::Detection => (
            "detection lines",
            Ink {
                pen: None,
                marker: Some(Marker::Ring),
                color: COLORS[0],
            },
        ),
        LineRole::Other => (
            "other lines",
            Ink {
                pen: Some(Pen {
                    color: grey,
                    width: 1.0,
                    dash: "",
                }),
                marker: None,
                color: grey,
            },
        ),
    }
}
