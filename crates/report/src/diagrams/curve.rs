//! Curves of Bode diagrams: FRFs with their names, how each is drawn, and their 95 % regions.

use frfid_signals::{Frf, Uncertainty};

use crate::diagrams::style::Style;

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

impl<'a> Curve<'a> {
    /// An FRF without its uncertainty, every line of it sound.
    #[must_use]
    pub fn new(label: impl Into<String>, frf: &'a Frf, style: Style) -> Self {
        Self {
            label: label.into(),
            frf,
            style,
            band: Band::None,
            flagged: None,
        }
    }

    /// Number of outputs and inputs.
    pub(crate) fn size(&self) -> (usize, usize) {
        (self.frf.n_outputs(), self.frf.n_inputs())
    }

    /// Whether the line of that number is not to be trusted.
    pub(crate) fn is_flagged(&self, k: usize) -> bool {
        self.flagged.as_ref().is_some_and(|flagged| flagged[k])
    }

    /// Radius of the 95 % region of one entry over frequency, for the band asked for; `None` where
    /// it was not measured.
    pub(crate) fn region(&self, (output, input): (usize, usize)) -> Option<Vec<f64>> {
        let frf = self.frf;
        let (known, variance) = match self.band {
            Band::None => return None,
            Band::Noise => (frf.noise.as_ref()?, frf.noise_variance()?),
            Band::Total => (frf.total.as_ref()?, frf.total_variance()?),
        };
        let factor = confidence_radius(known)?;
        let radius = |k: usize| factor * variance[[k, output, input]].max(0.0).sqrt();
        Some((0..frf.n_frequencies()).map(radius).collect())
    }
}

/// Radius of the 95 % region of an entry over the square root of its variance; `None` without
/// degrees of freedom.
pub(crate) fn confidence_radius(known: &Uncertainty) -> Option<f64> {
    Some(known.confidence_factor_95().sqrt()).filter(|radius| radius.is_finite())
}
