//! Harmonics of a signal that a sweep makes, over the frequency that it passes: a curve for each order.

use std::iter::zip;

use frfid_signals::Amplitudes;
use ndarray::{ArrayView1, s};

use crate::diagrams::over_frequency::{OverFrequency, decibel, decibel_axis, decibel_label};
use crate::error::ReportError;
use crate::figure::Figure;
use crate::figure::ink::{COLORS, Ink, Pen};

/// Names of the orders, the fundamental first.
const NAMES: [&str; 5] = ["fundamental", "2nd", "3rd", "4th", "5th"];
const DASHES: [&str; 5] = ["", "7 3", "", "2 3", "7 3 2 3"];

/// The curve of an order.
struct Curve<'a> {
    name: &'static str,
    ink: Ink,
    amplitude: ArrayView1<'a, f64>,
}

/// Amplitudes of a channel in dB; `unit` is that of the signal. What does not stand out is a gap.
///
/// # Errors
/// [`ReportError`] without frequencies, or for one that is not a finite number above zero.
pub(crate) fn harmonics(
    (frequency_hz, orders): (&[f64], &[usize]),
    amplitudes: &Amplitudes,
    channel: usize,
    unit: &str,
) -> Result<Figure, ReportError> {
    let curves = curves(orders, amplitudes, channel);
    let shown = curves.iter().flat_map(|curve| curve.amplitude);
    let frame = OverFrequency {
        what: ["harmonics", "frequencies"],
        legend: curves.iter().map(|curve| (curve.name, curve.ink)).collect(),
        frequency_hz: frequency_hz.to_vec(),
        y: decibel_axis(shown.copied()),
        label: &decibel_label("Amplitude", unit),
    };
    frame.figure(|figure, panel| {
        for curve in &curves {
            panel.curve(figure, &curve.points(frequency_hz), &curve.ink);
        }
    })
}

/// The curves of the orders that are known somewhere.
fn curves<'a>(orders: &[usize], amplitudes: &'a Amplitudes, channel: usize) -> Vec<Curve<'a>> {
    let amplitude = |place| amplitudes.amplitude.slice(s![channel, place, ..]);
    let curves = orders.iter().enumerate();
    let curves = curves.filter_map(|(place, &order)| Curve::of(order, amplitude(place)));
    curves.collect()
}

impl<'a> Curve<'a> {
    /// That of an order; `None` where nothing is known, or of orders that are never told.
    fn of(order: usize, amplitude: ArrayView1<'a, f64>) -> Option<Self> {
        let place = order.checked_sub(1)?;
        let pen = Pen {
            color: COLORS.get(place)?,
            width: if order == 1 { 2.2 } else { 1.6 },
            dash: DASHES[place],
        };
        let is_known = amplitude.iter().any(|value| value.is_finite());
        is_known.then_some(Self {
            name: NAMES[place],
            ink: Ink::line(pen),
            amplitude,
        })
    }

    fn points(&self, frequency_hz: &[f64]) -> Vec<(f64, f64)> {
        let points = zip(frequency_hz, self.amplitude);
        points.map(|(&hz, &value)| (hz, decibel(value))).collect()
    }
}
