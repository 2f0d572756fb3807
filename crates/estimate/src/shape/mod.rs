//! Iterative shaping of closed-loop excitations, SK15 section 5.3, eqs. (17)-(19): references whose
//! answer is the torque that was asked for.
//!
//! The plant input cannot be excited directly in closed loop. From a conservatively small reference
//! r_1 the response G_i from r to the target is estimated in every iteration, and the next
//! reference is what should lead to the desired spectrum. The paper's step,
//! `R_{i+1} = G_i^-1 U_des`, is a fixed point that Coulomb friction pushes apart; the damped step
//! `R_{i+1} = R_i + lambda G_i^-1 (U_des - U_i)` with a smoothed G_i corrects only what is missing
//! and converges. Spectra are those of whole records, tail included, with experiments as columns.

pub(crate) mod error;
pub(crate) mod iteration;
pub(crate) mod limits;
pub(crate) mod measure;
pub(crate) mod note;
pub(crate) mod options;
pub(crate) mod proposal;
pub(crate) mod shaper;
pub(crate) mod spectra;
pub(crate) mod step;
pub(crate) mod sticking;
pub(crate) mod summary;
#[cfg(test)]
mod tests;
pub(crate) mod trace;

use std::error::Error;

use frfid_signals::{Record, Testbed};
use ndarray::Array3;
use rayon::prelude::*;

use crate::shape::error::ShapeError;
use crate::shape::iteration::Iteration;
use crate::shape::options::ShapeOptions;
use crate::shape::shaper::Shaper;
use crate::shape::summary::Shaped;

/// Driver of a shaping: it does the runs and sees the iterations.
pub trait Driver {
    /// Why it cannot go on.
    type Error: From<ShapeError>;

    /// The records of [`Shaper::runs`], in their order.
    ///
    /// # Errors
    /// Whatever keeps a run from being done.
    fn records(&mut self, shaper: &Shaper) -> Result<Vec<Record>, Self::Error>;

    /// Sees an iteration; `false` ends the shaping.
    ///
    /// # Errors
    /// Whatever keeps the shaping from going on.
    fn iterated(&mut self, iteration: &Iteration) -> Result<bool, Self::Error>;
}

impl Shaper {
    /// Goes on until it ends.
    ///
    /// # Errors
    /// Those of the driver, and [`ShapeError`].
    pub fn drive<D: Driver>(mut self, driver: &mut D) -> Result<Shaped, D::Error> {
        while self.stop().is_none() {
            let records = driver.records(&self)?;
            if !driver.iterated(self.measured(records)?)? {
                self.end();
            }
        }
        Ok(self.finish()?)
    }
}

/// Sees every iteration; `false` ends the shaping.
pub type Watcher<'a> = dyn FnMut(&Iteration) -> Result<bool, Box<dyn Error + Send + Sync>> + 'a;

/// Shapes a reference on a testbed until the target follows `desired`, from the reference `start`,
/// both `(experiment, channel, sample)` with as many experiments as channels; `watch` sees every
/// iteration and may end it with `false`. The experiments of an iteration run side by side.
///
/// # Errors
/// [`ShapeError`]; one of `watch` ends the shaping as [`ShapeError::Watch`].
pub fn shape(
    testbed: &dyn Testbed,
    desired: Array3<f64>,
    start: Array3<f64>,
    options: ShapeOptions,
    watch: &mut Watcher,
) -> Result<Shaped, ShapeError> {
    Shaper::new(desired, start, options)?.drive(&mut Watched { testbed, watch })
}

/// A testbed, and who watches what happens on it.
struct Watched<'a, 'w> {
    testbed: &'a dyn Testbed,
    watch: &'a mut Watcher<'w>,
}

impl Driver for Watched<'_, '_> {
    type Error = ShapeError;

    fn records(&mut self, shaper: &Shaper) -> Result<Vec<Record>, ShapeError> {
        let runs = shaper.runs();
        let groups = runs.par_chunks(self.testbed.n_at_once().max(1));
        let records: Vec<Vec<_>> = groups
            .map(|runs| self.testbed.run_each(runs, &|| true))
            .collect();
        let records = records.into_iter().flatten();
        records.map(|record| Ok(record?)).collect()
    }

    fn iterated(&mut self, iteration: &Iteration) -> Result<bool, ShapeError> {
        (self.watch)(iteration).map_err(ShapeError::Watch)
    }
}
