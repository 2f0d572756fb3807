//! Quantity over a logarithmic frequency axis: the frame that diagrams of lines and levels share.

use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::geometry::Rect;
use crate::figure::ink::Ink;
use crate::figure::legend::Legend;
use crate::figure::panel::{LEFT, Panel};
use crate::validation;

const WIDTH: f64 = 540.0;
/// Length of the vertical axis.
pub(super) const HEIGHT: f64 = 210.0;
/// Room between the legend and the panel.
const ABOVE: f64 = 8.0;

/// What the frame has to hold.
pub(super) struct OverFrequency<'a> {
    /// What is drawn, of what it consists: "a spectrum", "lines".
    pub(super) what: [&'static str; 2],
    /// Names and inks of the curves.
    pub(super) legend: Vec<(&'a str, Ink)>,
    pub(super) frequency_hz: Vec<f64>,
    /// The vertical axis, of length [`HEIGHT`].
    pub(super) y: Axis,
    /// Its quantity and unit.
    pub(super) label: &'a str,
}

impl OverFrequency<'_> {
    /// The figure, with the curves that `draw` puts into the panel.
    ///
    /// # Errors
    /// [`ReportError`] without frequencies, or for one that is not a finite number above zero.
    pub(super) fn figure(
        self,
        draw: impl FnOnce(&mut Figure, &Panel),
    ) -> Result<Figure, ReportError> {
        if self.frequency_hz.is_empty() {
            let [what, parts] = self.what;
            return Err(ReportError::empty(what, parts));
        }
        validation::log_frequencies("a frequency_hz", self.frequency_hz.iter().copied())?;
        let legend = Legend::new(self.legend.into_iter(), WIDTH);
        let mut figure = legend.figure(WIDTH, ABOVE + HEIGHT);
        let panel = Panel {
            rect: Rect {
                x: LEFT,
                y: legend.bottom() + ABOVE,
                width: WIDTH,
                height: HEIGHT,
            },
            x: Axis::frequency(self.frequency_hz, WIDTH),
            y: self.y,
        };
        panel.draw(&mut figure, |figure| draw(figure, &panel));
        panel.label_y(&mut figure, self.label);
        panel.label_x(&mut figure, "Frequency in Hz");
        Ok(figure)
    }
}

/// The vertical axis of amplitudes in dB; what is not known is NaN.
pub(super) fn decibel_axis(amplitudes: impl IntoIterator<Item = f64>) -> Axis {
    let shown = amplitudes.into_iter().map(decibel);
    Axis::padded(shown.filter(|db| db.is_finite()), HEIGHT)
}

/// An amplitude in dB of its unit.
pub(super) fn decibel(amplitude: f64) -> f64 {
    20.0 * amplitude.log10()
}

/// A quantity in dB of a unit, which may be empty: "Amplitude in dB of rad/s".
pub(super) fn decibel_label(quantity: &str, unit: &str) -> String {
    let of = if unit.is_empty() { "" } else { " of " };
    format!("{quantity} in dB{of}{unit}")
}
