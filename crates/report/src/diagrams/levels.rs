//! Levels of a signal in dB over a logarithmic frequency axis: the frame that diagrams of levels share.

use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::geometry::Rect;
use crate::figure::ink::Ink;
use crate::figure::legend::Legend;
use crate::figure::panel::{LEFT, Panel};
use crate::validation;

const WIDTH: f64 = 540.0;
const HEIGHT: f64 = 230.0;
/// Room between the legend and the panel.
const ABOVE: f64 = 8.0;

/// What the frame has to hold.
pub(super) struct Levels<'a> {
    /// Names and inks of the curves.
    pub(super) legend: Vec<(&'a str, Ink)>,
    pub(super) frequency_hz: Vec<f64>,
    /// Amplitudes that are to be seen; what is not known is NaN.
    pub(super) shown: Vec<f64>,
    /// What an amplitude is, and the unit of the signal: "Rms of a line", "rad/s".
    pub(super) quantity: &'a str,
    pub(super) unit: &'a str,
}

impl Levels<'_> {
    /// The figure, with the curves that `draw` puts into the panel.
    ///
    /// # Errors
    /// [`ReportError`] without frequencies, or for one that is not a finite number above zero.
    pub(super) fn figure(
        &self,
        draw: impl FnOnce(&mut Figure, &Panel),
    ) -> Result<Figure, ReportError> {
        if self.frequency_hz.is_empty() {
            return Err(ReportError::empty("levels", "frequencies"));
        }
        validation::log_frequencies("a frequency_hz", self.frequency_hz.iter().copied())?;
        let legend = Legend::new(self.legend.iter().copied(), WIDTH);
        let mut figure = legend.figure(WIDTH, ABOVE + HEIGHT);
        let panel = self.panel(legend.bottom() + ABOVE);
        panel.draw(&mut figure, |figure| draw(figure, &panel));
        panel.label_y(&mut figure, &self.label());
        panel.label_x(&mut figure, "Frequency in Hz");
        Ok(figure)
    }

    fn panel(&self, top: f64) -> Panel {
        let shown = self.shown.iter().copied().map(decibel);
        Panel {
            rect: Rect {
                x: LEFT,
                y: top,
                width: WIDTH,
                height: HEIGHT,
            },
            x: Axis::frequency(self.frequency_hz.iter().copied(), WIDTH),
            y: Axis::padded(shown.filter(|db| db.is_finite()), HEIGHT),
        }
    }

    fn label(&self) -> String {
        let unit = if self.unit.is_empty() { "" } else { " of " };
        format!("{} in dB{unit}{}", self.quantity, self.unit)
    }
}

/// An amplitude in dB of its unit.
pub(super) fn decibel(amplitude: f64) -> f64 {
    20.0 * amplitude.log10()
}
