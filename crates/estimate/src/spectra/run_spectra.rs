//! Spectra of one run: of its input, output and reference.

use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::error::EstimateError;
use crate::spectra::Transform;

/// Spectra of one run (one period of one experiment), `(channel, line)`.
#[derive(Debug, Clone, PartialEq)]
pub struct RunSpectra {
    /// Plant input.
    pub u: Array2<Complex64>,
    /// Plant output.
    pub y: Array2<Complex64>,
    /// Reference, as many channels as `u`, for methods that estimate through it; in all runs of a
    /// campaign or in none.
    pub r: Option<Array2<Complex64>>,
}

impl RunSpectra {
    /// Transforms one run of `u`, `y` and, if there is one, `r`, each `(channel, sample)`.
    ///
    /// # Errors
    /// As [`Transform::transform`], naming the signal.
    pub fn of(
        transform: &dyn Transform,
        u: ArrayView2<f64>,
        y: ArrayView2<f64>,
        r: Option<ArrayView2<f64>>,
    ) -> Result<Self, EstimateError> {
        let r = r.map(|r| transform.transform("r", r)).transpose()?;
        Ok(Self {
            u: transform.transform("u", u)?,
            y: transform.transform("y", y)?,
            r,
        })
    }

    /// The signals by name.
    pub(super) fn signals(&self) -> [(&'static str, Option<&Array2<Complex64>>); 3] {
        [
            ("u", Some(&self.u)),
            ("y", Some(&self.y)),
            ("r", self.r.as_ref()),
        ]
    }

    /// Shapes of u, y and r.
    pub(super) fn shapes(&self) -> Shapes {
        self.signals().map(|(_, signal)| signal.map(Array2::dim))
    }

    /// Shapes that its signals must have on so many lines: channels, and as many of r as of u.
    pub(super) fn needed_shapes(&self, n_lines: usize) -> Shapes {
        let shape = |channels: usize| Some((channels.max(1), n_lines));
        let r = self.r.as_ref().and_then(|_| shape(self.u.nrows()));
        [shape(self.u.nrows()), shape(self.y.nrows()), r]
    }
}

/// Shapes of u, y and r, `(channel, line)`, where there is one.
pub(super) type Shapes = [Option<(usize, usize)>; 3];

/// Refuses spectra of another shape than needed.
pub(super) fn check_shape(
    name: &'static str,
    found: Option<&Array2<Complex64>>,
    needed: Option<(usize, usize)>,
) -> Result<(), EstimateError> {
    if found.map(Array2::dim) == needed {
        return Ok(());
    }
    let shape = found.map_or(&[][..], |found| found.shape());
    let needed = match needed {
        Some(needed) => format!("{needed:?} (channel, line)"),
        None => "no r, as in the runs before".into(),
    };
    Err(EstimateError::shape(name, shape, needed))
}
