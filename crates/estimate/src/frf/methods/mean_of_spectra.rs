//! Mean of spectra: averaged over periods before dividing, the better choice where the input is
//! measured with noise.
//!
//! `G_p = Y_p U_p^+`, and `T_pq = G_p + (Y_pq - G_p U_pq) U_p^+`, which is what period q contributes
//! to G_p to first order in the noise.

use crate::error::deficient_line::DeficientLine;
use crate::frf::blocks::{BlockEstimates, BlockMethod, Invertible, LineBlock, mean};
use crate::frf::matrices::Matrix;
use crate::frf::noise_bias::NoiseSeen;
use crate::frf::right_division::Divisor;

pub(crate) struct MeanOfSpectra;

impl BlockMethod for MeanOfSpectra {
    /// Each FRF is divided by the mean over the periods of a realization.
    fn noise_bias(&self, noise: &NoiseSeen) -> f64 {
        noise.bias_of_quotient(noise.n_periods)
    }

    fn estimates(
        &self,
        blocks: &[Vec<LineBlock>],
        invertible: &Invertible,
    ) -> Result<BlockEstimates, DeficientLine> {
        let mut condition = 0.0_f64;
        let mut estimate = |periods: &Vec<LineBlock>| {
            let u = mean(periods.iter().map(|block| &block.u));
            condition = condition.max(invertible(&u)?);
            Ok(contributions(periods, &u))
        };
        let blocks = blocks.iter().map(&mut estimate).collect::<Result<_, _>>()?;
        Ok(BlockEstimates {
            blocks,
            realizations: None,
            condition,
        })
    }
}

/// `T_pq` of the periods of a realization whose mean input is `u`.
fn contributions(periods: &[LineBlock], u: &Matrix) -> Vec<Matrix> {
    let y = mean(periods.iter().map(|block| &block.y));
    let divisor = Divisor::of(u);
    let response = divisor.divide(&y);
    let residuals = periods.iter().map(|block| &block.y - &response * &block.u);
    residuals
        .map(|residual| &response + divisor.divide(&residual))
        .collect()
}
