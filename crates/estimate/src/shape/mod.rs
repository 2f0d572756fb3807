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
pub(crate) mod options;
pub(crate) mod proposal;
pub(crate) mod shaper;
pub(crate) mod spectra;
pub(crate) mod step;
pub(crate) mod sticking;
#[cfg(test)]
mod tests;

use std::error::Error;

use frfid_signals::Testbed;
use ndarray::Array3;
use rayon::prelude::*;

use crate::shape::error::ShapeError;
use crate::shape::iteration::{Iteration, Shaped};
use crate::shape::options::ShapeOptions;
use crate::shape::shaper::Shaper;

/// Sees every iteration; `false` ends the shaping.
pub type Watcher<'a> = dyn FnMut(&Iteration) -> Result<bool, Box<dyn Error + Send + Sync>> + 'a;

/// Shapes a reference on a testbed until the target follows `desired`, from the reference `start`,
/// both `(experiment, channel, sample)` with as many experiments as channels; `watch` sees every
/// iteration and may end it with `false`. The experiments of an iteration run side by side.
///
/// This is the plain loop over [`Shaper`], which can also be fed with records from elsewhere.
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
    let mut shaper = Shaper::new(desired, start, options)?;
    while shaper.stop().is_none() {
        let records = shaper
            .runs()
            .par_iter()
            .map(|run| testbed.run(run))
            .collect::<Result<_, _>>()?;
        if !watch(shaper.measured(records)?).map_err(ShapeError::Watch)? {
            shaper.end();
        }
    }
    shaper.finish()
}
