//! Curves of Bode diagrams: FRFs with their names, how each is drawn, and their 95 % regions.

use frfid_signals::{Frf, Uncertainty};
use ndarray::s;

use crate::diagrams::style::{Style, Swatch};

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
    /// Lines not to be trusted, one value per frequency: they have ticks at the upper edge. `None`
    /// where all are sound.
    pub flagged: Option<Vec<bool>>,
    /// Its place in the palette; `None` for the next that is free in a diagram.
    pub swatch: Option<Swatch>,
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
            swatch: None,
        }
    }

    /// The same curve at a place of the palette, of colours and of dashes or markers.
    #[must_use]
    pub fn with_swatch(self, color: usize, shape: usize) -> Self {
        let swatch = Some(Swatch { color, shape });
        Self { swatch, ..self }
    }

    /// Its style and place in the palette.
    pub(crate) fn look(&self) -> (Style, Option<Swatch>) {
        (self.style, self.swatch)
    }

    /// Number of outputs and inputs.
    pub(crate) fn size(&self) -> (usize, usize) {
        (self.frf.n_outputs(), self.frf.n_inputs())
    }

    /// Whether the line of that number is not to be trusted.
    pub(crate) fn is_flagged(&self, k: usize) -> bool {
        self.flagged.as_ref().is_some_and(|flagged| flagged[k])
    }

    /// Whether any line is not to be trusted.
    pub(crate) fn has_flags(&self) -> bool {
        self.flagged.iter().flatten().any(|is_flagged| *is_flagged)
    }

    /// |G| of one entry over frequency.
    pub(crate) fn sizes(&self, (output, input): (usize, usize)) -> impl Iterator<Item = f64> {
        let entry = self.frf.response.slice(s![.., output, input]);
        entry.into_iter().map(|value| value.norm())
    }

    /// Radius of the 95 % region of one entry over frequency, for the band asked for; `None` where
    /// it was not measured, not a number on lines without an estimate.
    pub(crate) fn region(&self, (output, input): (usize, usize)) -> Option<Vec<f64>> {
        let frf = self.frf;
        let (known, variance) = match self.band {
            Band::None => return None,
            Band::Noise => (frf.noise.as_ref()?, frf.noise_variance()?),
            Band::Total => (frf.total.as_ref()?, frf.total_variance()?),
        };
        let factor = confidence_radius(known)?;
        let variances = variance.slice(s![.., output, input]);
        let radius = |variance: &f64| factor * variance.clamp(0.0, f64::INFINITY).sqrt();
        Some(variances.iter().map(radius).collect())
    }
}

/// Radius of the 95 % region of an entry over the square root of its variance; `None` without
/// degrees of freedom.
pub(crate) fn confidence_radius(known: &Uncertainty) -> Option<f64> {
    Some(known.confidence_factor_95().sqrt()).filter(|radius| radius.is_finite())
}
