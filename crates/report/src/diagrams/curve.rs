//! What is drawn in a Bode diagram: FRFs, how each is drawn, and the names of the channels.

use frfid_signals::{Frf, Uncertainty};

use crate::error::ReportError;
use crate::figure::{Marker, Pen};
use crate::validation;

/// How an FRF is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A thin black line: the truth, or whatever the others are compared with.
    Reference,
    /// A coloured line, for estimates on a dense grid (chirp).
    Line,
    /// Coloured markers at the lines, for estimates on a sparse grid (multisine).
    Markers,
}

/// Which 95 % region is shaded around a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Band {
    /// None.
    #[default]
    None,
    /// That of the measurement noise.
    Noise,
    /// That of noise and nonlinear distortion together.
    Total,
}

/// One FRF of a figure or report.
#[derive(Debug, Clone)]
pub struct Curve<'a> {
    /// Name in the legend.
    pub label: String,
    /// The FRF.
    pub frf: &'a Frf,
    /// How it is drawn.
    pub style: Style,
    /// What is shaded around it; nothing where that variance was not measured.
    pub band: Band,
    /// Lines not to be trusted, one value per frequency: they are drawn as crosses. `None` where
    /// all are sound.
    pub flagged: Option<Vec<bool>>,
}

impl Curve<'_> {
    /// Whether the line of that number is not to be trusted.
    pub(crate) fn is_flagged(&self, k: usize) -> bool {
        self.flagged.as_ref().is_some_and(|flagged| flagged[k])
    }
}

/// Names of the channels and the unit of the gain, as they appear in titles and on axes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Labels {
    /// One name per input (`τ₁`).
    pub inputs: Vec<String>,
    /// One name per output (`q̇₁`).
    pub outputs: Vec<String>,
    /// Unit of the FRF, to which 0 dB refers: `rad/s per N m`.
    pub gain_unit: String,
}

impl Labels {
    /// Motor torques `τ1`, `τ2`, ... to motor velocities `dq1/dt`, `dq2/dt`, ... in rad/s per N m.
    #[must_use]
    pub fn torque_to_velocity(n_outputs: usize, n_inputs: usize) -> Self {
        let inputs = (1..=n_inputs).map(|k| format!("τ{k}")).collect();
        let outputs = (1..=n_outputs).map(|k| format!("dq{k}/dt")).collect();
        Self {
            inputs,
            outputs,
            gain_unit: "rad/s per N m".to_owned(),
        }
    }

    /// Title of one entry: `τ1 → dq2/dt`.
    pub(crate) fn entry(&self, output: usize, input: usize) -> String {
        let name = |names: &[String], k: usize| {
            names.get(k).cloned().unwrap_or_else(|| (k + 1).to_string())
        };
        format!(
            "{} → {}",
            name(&self.inputs, input),
            name(&self.outputs, output)
        )
    }
}

/// The shape of a [`Mark`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkShape {
    /// An open circle.
    Circle,
    /// A cross.
    Cross,
}

/// A point of a matrix of Bode diagrams that is pointed out, in the colour of a curve: a peak, or
/// where another entry has its.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Name in the legend; marks of one name share one entry, an empty name has none.
    pub label: String,
    /// Number of the curve it belongs to.
    pub curve: usize,
    /// Row of the matrix.
    pub output: usize,
    /// Column of the matrix.
    pub input: usize,
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Magnitude in dB.
    pub magnitude_db: f64,
    /// How it is drawn.
    pub shape: MarkShape,
}

impl Mark {
    /// Its ink, in a figure with curves of these inks.
    pub(crate) fn ink(&self, curves: &[Ink]) -> Ink {
        let marker = match self.shape {
            MarkShape::Circle => Marker::Circle,
            MarkShape::Cross => Marker::Cross,
        };
        Ink {
            pen: None,
            marker: Some(marker),
            color: curves[self.curve].color,
        }
    }
}

/// The ink of one curve, told apart by colour, dash and marker so that it survives a
/// black-and-white printer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ink {
    pub pen: Option<Pen>,
    pub marker: Option<Marker>,
    pub color: &'static str,
}

/// Dark members of the colour-blind safe palette of Okabe and Ito.
pub(crate) const COLORS: [&str; 5] = ["#d55e00", "#0072b2", "#009e73", "#aa3377", "#8c6d00"];
const DASHES: [&str; 4] = ["", "7 3", "7 2 2 2", "2 2"];
const MARKERS: [Marker; 4] = [Marker::Dot, Marker::Diamond, Marker::Square, Marker::Ring];

/// One ink per style: each colour once, each dash once among the lines and each marker once among
/// the markers, as far as they reach.
pub(crate) fn inks(styles: impl Iterator<Item = Style>) -> Vec<Ink> {
    let (mut lines, mut markers) = (0, 0);
    let mut ink = |style| {
        let color = COLORS[(lines + markers) % COLORS.len()];
        match style {
            Style::Reference => Ink {
                pen: Some(Pen {
                    color: "#000000",
                    width: 1.0,
                    dash: "",
                }),
                marker: None,
                color: "#000000",
            },
            Style::Line => {
                lines += 1;
                Ink {
                    pen: Some(Pen {
                        color,
                        width: 1.8,
                        dash: DASHES[(lines - 1) % DASHES.len()],
                    }),
                    marker: None,
                    color,
                }
            }
            Style::Markers => {
                markers += 1;
                Ink {
                    pen: None,
                    marker: Some(MARKERS[(markers - 1) % MARKERS.len()]),
                    color,
                }
            }
        }
    };
    styles.map(&mut ink).collect()
}

/// Refuses no curves, curves of different sizes, labels that do not fit them, and frequencies a
/// logarithmic axis cannot hold. Returns the number of outputs and inputs.
pub(crate) fn check(
    figure: &'static str,
    curves: &[Curve],
    labels: &Labels,
) -> Result<(usize, usize), ReportError> {
    let first = curves
        .first()
        .ok_or(ReportError::Empty {
            figure,
            missing: "curves",
        })?
        .frf;
    let (outputs, inputs) = (first.n_outputs(), first.n_inputs());
    let size = |what: String, found_outputs, found_inputs| {
        let fits = (found_outputs, found_inputs) == (outputs, inputs);
        if fits {
            Ok(())
        } else {
            Err(ReportError::Size {
                what,
                found_outputs,
                found_inputs,
                outputs,
                inputs,
            })
        }
    };
    for Curve {
        label,
        frf,
        flagged,
        ..
    } in curves
    {
        size(
            format!("curve \"{label}\""),
            frf.n_outputs(),
            frf.n_inputs(),
        )?;
        frf.check()?;
        if let Some(flagged) = flagged {
            validation::length(
                &format!("flagged of curve \"{label}\""),
                flagged.len(),
                frf.n_frequencies(),
            )?;
        }
        if let Some(&found) = frf
            .frequency_hz
            .iter()
            .find(|hz| !(hz.is_finite() && **hz > 0.0))
        {
            let needed = "finite and above 0 (the frequency axis is logarithmic)";
            return Err(ReportError::Value {
                what: format!("a frequency_hz of curve \"{label}\""),
                found,
                needed,
            });
        }
    }
    if curves.iter().all(|curve| curve.frf.frequency_hz.is_empty()) {
        return Err(ReportError::Empty {
            figure,
            missing: "frequencies",
        });
    }
    size(
        "the list of channel names".to_owned(),
        labels.outputs.len(),
        labels.inputs.len(),
    )?;
    Ok((outputs, inputs))
}

/// Refuses marks that belong to no curve or no entry of an `outputs` x `inputs` matrix.
pub(crate) fn check_marks(
    marks: &[Mark],
    curves: &[Curve],
    (outputs, inputs): (usize, usize),
) -> Result<(), ReportError> {
    for &Mark {
        curve,
        output,
        input,
        ..
    } in marks
    {
        let found = curve as f64;
        validation::value(
            "the curve of a mark",
            found,
            "the number of a curve, from 0",
            |_| curve < curves.len(),
        )?;
        if output >= outputs || input >= inputs {
            let curve = curves[curve].label.clone();
            return Err(ReportError::NoSuchEntry {
                curve,
                outputs,
                inputs,
                output,
                input,
            });
        }
    }
    Ok(())
}

/// Radius of the 95 % region of an entry over the square root of its variance; `None` without
/// degrees of freedom.
pub(crate) fn confidence_radius(known: &Uncertainty) -> Option<f64> {
    Some(known.confidence_factor_95().sqrt()).filter(|radius| radius.is_finite())
}

/// Radius of the 95 % region of one entry over frequency, for the band asked for; `None` where it
/// was not measured.
pub(crate) fn region(curve: &Curve, output: usize, input: usize) -> Option<Vec<f64>> {
    let (known, variance) = match curve.band {
        Band::None => return None,
        Band::Noise => (curve.frf.noise.as_ref()?, curve.frf.noise_variance()?),
        Band::Total => (curve.frf.total.as_ref()?, curve.frf.total_variance()?),
    };
    let factor = confidence_radius(known)?;
    Some(
        (0..curve.frf.n_frequencies())
            .map(|k| factor * variance[[k, output, input]].max(0.0).sqrt())
            .collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inks_differ_in_colour_and_in_dash_or_marker() {
        let inks = inks(
            [
                Style::Reference,
                Style::Markers,
                Style::Line,
                Style::Markers,
                Style::Line,
            ]
            .into_iter(),
        );
        for (k, a) in inks.iter().enumerate() {
            for b in &inks[..k] {
                let dash = |ink: &Ink| ink.pen.map(|pen| (pen.dash, pen.width.to_bits()));
                assert!(a.color != b.color && (dash(a), a.marker) != (dash(b), b.marker));
            }
        }
    }
}
