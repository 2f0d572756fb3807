//! Residual of the torque ripple: which lines it still disturbs, seen on the lines around them that
//! are not excited.

use std::collections::BTreeMap;

use frfid_estimate::{FreeLines, PeriodIndex, Transform};
use frfid_signals::{Excitation, Frf, Multisine, Plan};
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::description::estimate::{EstimateTable, GlideSubtraction};
use crate::error::ExperimentError;

/// Free lines looked at around each excited line.
const NEIGHBOURS: usize = 12;
/// Realizations looked at: more tell no more of the level, and the memory of a campaign shall not
/// grow with its length.
const REALIZATIONS: usize = 4;

/// Spectra of u and y on the free lines of one period.
#[derive(Debug, Clone)]
pub(crate) struct FreeSpectra {
    pub(crate) place: PeriodIndex,
    pub(crate) signals: OnFreeLines,
}

/// u and y on the free lines.
#[derive(Debug, Clone)]
pub(crate) struct OnFreeLines {
    pub(crate) u: Array2<Complex64>,
    pub(crate) y: Array2<Complex64>,
}

/// Realization and experiment: what was applied.
type Reference = (usize, usize);

/// Looks at the free lines of a plan.
pub(crate) struct RippleResidual {
    lines: FreeLines,
}

/// Whether the free lines of a period are looked at.
pub(crate) fn is_looked_at(place: PeriodIndex) -> bool {
    place.realization < REALIZATIONS
}

fn is_subtracted_and_repeated(plan: &Plan, options: &EstimateTable) -> bool {
    plan.n_glides > 0
        && plan.n_repetitions * plan.n_periods > 1
        && options.glide_subtraction != GlideSubtraction::None
}

impl RippleResidual {
    /// For the plans on which it can be seen: multisines on a constant velocity with glides,
    /// repeated.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for lines that do not fit the period.
    pub(crate) fn of_plan(
        plan: &Plan,
        options: &EstimateTable,
    ) -> Result<Option<Self>, ExperimentError> {
        let Excitation::Multisine(Multisine { grid, .. }) = &plan.excitation else {
            return Ok(None);
        };
        if !is_subtracted_and_repeated(plan, options) {
            return Ok(None);
        }
        Ok(Some(Self {
            lines: FreeLines::new(grid.n_samples, &grid.excited, NEIGHBOURS)?,
        }))
    }

    /// Spectra of one period of a glide, or a run.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for samples that are not finite.
    pub(crate) fn spectra(
        &self,
        u: ArrayView2<f64>,
        y: ArrayView2<f64>,
    ) -> Result<OnFreeLines, ExperimentError> {
        Ok(OnFreeLines {
            u: self.lines.transform("u", u)?,
            y: self.lines.transform("y", y)?,
        })
    }

    /// Whether what `plant` does not explain exceeds its noise and that of the glides, line by line;
    /// `None` without a repeated reference.
    ///
    /// # Errors
    /// [`ExperimentError::Estimate`] for spectra of different shapes.
    pub(crate) fn exceeds_noise(
        &self,
        mut free: Vec<FreeSpectra>,
        glides: &[OnFreeLines],
        plant: &Frf,
    ) -> Result<Option<Vec<bool>>, ExperimentError> {
        // a mean must not depend on the order in which the records came
        free.sort_by_key(|FreeSpectra { place, .. }| {
            (place.realization, place.experiment, place.period)
        });
        let references: Vec<_> = self.unexplained(free, plant)?.into_values().collect();
        if !references.iter().any(|repetitions| repetitions.len() > 1) {
            return Ok(None);
        }
        let glides = glides
            .iter()
            .map(|glide| self.lines.unexplained(&glide.u, &glide.y, plant));
        let glides: Vec<_> = glides.collect::<Result<_, _>>()?;
        Ok(Some(
            self.lines.level(&references, &glides)?.exceeds_noise(),
        ))
    }

    /// What `plant` does not explain in the repetitions of every reference.
    fn unexplained(
        &self,
        free: Vec<FreeSpectra>,
        plant: &Frf,
    ) -> Result<BTreeMap<Reference, Vec<Array2<Complex64>>>, ExperimentError> {
        let mut references: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for FreeSpectra { place, signals } in free {
            let repetitions = references.entry((place.realization, place.experiment));
            let unexplained = self.lines.unexplained(&signals.u, &signals.y, plant)?;
            repetitions.or_default().push(unexplained);
        }
        Ok(references)
    }
}
