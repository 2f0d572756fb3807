//! Run of several axes on the lines of a band: torques, velocities and their signs.

use frfid_signals::checks::positive;
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::friction::signs::mean_signs;
use crate::spectra::Transform;
use crate::spectra::whole_record::WholeRecord;

/// What a run of several axes says of their friction.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionSpectra {
    pub(super) line_hz: Vec<f64>,
    /// Torques, `(axis, line)`, over the root of the number of samples, as the others.
    pub(super) u: Array2<Complex64>,
    /// Velocities.
    pub(super) y: Array2<Complex64>,
    /// Signs of the velocities.
    pub(super) signs: Array2<Complex64>,
    /// Share of the samples in which each axis does not slip all the time.
    pub(super) stuck_shares: Vec<f64>,
}

impl FrictionSpectra {
    /// A record `(axis, sample)` that begins and ends at rest, excited from `low_hz` to `high_hz`.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError`] for shapes that differ, samples that are not finite, a band that is not there.
    pub fn of(
        torque_nm: ArrayView2<f64>,
        velocity_rad_s: ArrayView2<f64>,
        sample_time_s: f64,
        [low_hz, high_hz]: [f64; 2],
    ) -> Result<Self, EstimateError> {
        positive("low_hz", low_hz)?;
        positive("high_hz - low_hz", high_hz - low_hz)?;
        let n_samples = torque_nm.ncols();
        if velocity_rad_s.dim() != torque_nm.dim() {
            let needed = format!("{:?} (axis, sample), as of the torque", torque_nm.dim());
            let found = velocity_rad_s.shape();
            return Err(EstimateError::shape("velocity", found, needed));
        }
        let whole = WholeRecord::new([low_hz, high_hz], sample_time_s, n_samples)?;
        let scale = Complex64::from((n_samples as f64).sqrt().recip());
        let spectra = |name, signal| -> Result<Array2<Complex64>, EstimateError> {
            Ok(whole.transform(name, signal)? * scale)
        };
        let signs = mean_signs(velocity_rad_s);
        Ok(Self {
            u: spectra("torque", torque_nm)?,
            y: spectra("velocity", velocity_rad_s)?,
            signs: spectra("signs", signs.view())?,
            stuck_shares: signs.rows().into_iter().map(unslipping).collect(),
            line_hz: whole.frequency_hz().to_vec(),
        })
    }

    pub(super) fn n_axes(&self) -> usize {
        self.u.nrows()
    }

    /// Distance of its lines in Hz.
    pub(super) fn spacing_hz(&self) -> f64 {
        match self.line_hz[..] {
            [first, second, ..] => second - first,
            _ => f64::INFINITY,
        }
    }
}

/// Share of signs that are not whole.
fn unslipping(signs: ndarray::ArrayView1<f64>) -> f64 {
    let n_partial = signs.iter().filter(|sign| sign.abs() < 1.0).count();
    n_partial as f64 / signs.len() as f64
}
