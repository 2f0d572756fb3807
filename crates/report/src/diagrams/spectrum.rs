//! Spectrum of a period: its excited, detection and other lines.

use crate::diagrams::over_frequency::{HEIGHT, OverFrequency};
use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::ink::{COLORS, Ink, Marker, Pen};
use crate::figure::panel::Panel;

const GREY: &str = "#888888";

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
    let amplitudes = lines.iter().map(|line| line.amplitude);
    let frame = OverFrequency {
        what: ["a spectrum", "lines"],
        legend: legend(lines),
        frequency_hz: lines.iter().map(|line| line.frequency_hz).collect(),
        y: Axis::linear(amplitudes.chain([0.0]), HEIGHT), // every line stands on 0
        label,
    };
    frame.figure(|figure, panel| {
        for line in lines {
            draw_line(figure, panel, line);
        }
    })
}

/// The legend: the roles that occur.
fn legend(lines: &[SpectralLine]) -> Vec<(&'static str, Ink)> {
    let roles = [LineRole::Excited, LineRole::Detection, LineRole::Other].into_iter();
    let drawn = roles.filter(|role| lines.iter().any(|line| line.role == *role));
    drawn.map(|role| (role.name(), role.ink())).collect()
}

/// Draws a stem and its marker.
fn draw_line(figure: &mut Figure, panel: &Panel, line: &SpectralLine) {
    let ink = line.role.ink();
    let stem = Ink::line(Pen::solid(ink.color, 1.0));
    let (foot, head) = (
        (line.frequency_hz, 0.0),
        (line.frequency_hz, line.amplitude),
    );
    panel.curve(figure, &[foot, head], &stem);
    panel.curve(figure, &[head], &ink.without_line());
}

impl LineRole {
    /// Its name in the legend.
    fn name(self) -> &'static str {
        match self {
            Self::Excited => "excited lines",
            Self::Detection => "detection lines",
            Self::Other => "other lines",
        }
    }

    /// Its ink in the legend.
    fn ink(self) -> Ink {
        match self {
            Self::Excited => Ink::markers(Marker::Dot, COLORS[1]),
            Self::Detection => Ink::markers(Marker::Ring, COLORS[0]),
            Self::Other => Ink::line(Pen::solid(GREY, 1.0)),
        }
    }
}
