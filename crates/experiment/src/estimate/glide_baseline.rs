//! Baseline of the glides: what is taken off the records of a constant velocity before their
//! spectra are taken (SK15 section 4.4 E).

use frfid_estimate::{RippleTorque, subtract_glide};
use frfid_signals::{Frf, Record, SignalError};
use ndarray::Array2;

use crate::error::ExperimentError;

/// What every run of a campaign carries besides the answer to its excitation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Baseline {
    /// Nothing that is known.
    None,
    /// The mean of the glides, sample by sample.
    Glide(Record),
    /// The same, and the ripple at the run's own motor positions.
    Ripple(RippleTorque),
}

impl Baseline {
    /// The mean of the glides; nothing if there is none.
    ///
    /// # Errors
    /// [`ExperimentError::Signal`] if they differ in shape.
    pub(crate) fn of_glides(glides: &[&Record]) -> Result<Self, ExperimentError> {
        let Some(&first) = glides.first() else {
            return Ok(Self::None);
        };
        Ok(Self::Glide(Record {
            u: mean("u of a glide", glides.iter().map(|glide| &glide.u))?,
            y: mean("y of a glide", glides.iter().map(|glide| &glide.y))?,
            position_rad: mean_position(glides),
            ..first.clone()
        }))
    }

    /// The same with the ripple over the motor position, for which a first estimate of the plant is
    /// needed.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for glides without positions, or a plant that does not fit.
    pub(crate) fn with_ripple(&self, plant: &Frf) -> Result<Self, ExperimentError> {
        match self {
            Self::Glide(glide) => Ok(Self::Ripple(RippleTorque::of_glide(glide, plant)?)),
            known => Ok(known.clone()),
        }
    }

    /// Variance in s^2 of the time by which the noise of the glides is shifted in a record; 0 where they
    /// are subtracted in time.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for a record without positions.
    pub(crate) fn wander_s2(&self, record: &Record) -> Result<f64, ExperimentError> {
        Ok(match self {
            Self::None | Self::Glide(_) => 0.0,
            Self::Ripple(ripple) => ripple.wander_s2(record)?,
        })
    }

    /// The record without it.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for a record that does not fit the glide.
    pub(crate) fn subtract_from(&self, record: &Record) -> Result<Option<Record>, ExperimentError> {
        Ok(match self {
            Self::None => None,
            Self::Glide(glide) => Some(subtract_glide(record, glide)?),
            Self::Ripple(ripple) => Some(ripple.subtract_glide(record)?),
        })
    }
}

/// The mean of a signal over the glides.
fn mean<'a>(
    name: &'static str,
    signals: impl ExactSizeIterator<Item = &'a Array2<f64>> + Clone,
) -> Result<Array2<f64>, SignalError> {
    let n_glides = signals.len() as f64;
    let shape = signals.clone().next().map(Array2::dim);
    let mut sum = Array2::zeros(shape.unwrap_or_default());
    for signal in signals {
        if signal.dim() != sum.dim() {
            return Err(SignalError::Shape {
                name,
                found: signal.shape().to_vec(),
                needed: format!("{:?}, as in the first glide", sum.shape()),
            });
        }
        sum += signal;
    }
    Ok(sum / n_glides)
}

/// The mean position of the glides, where all have one of the same shape.
fn mean_position(glides: &[&Record]) -> Option<Array2<f64>> {
    let mut sum = Array2::zeros(glides.first()?.position_rad.as_ref()?.dim());
    for glide in glides {
        let position = glide.position_rad.as_ref();
        sum += position.filter(|position| position.dim() == sum.dim())?;
    }
    Some(sum / glides.len() as f64)
}
