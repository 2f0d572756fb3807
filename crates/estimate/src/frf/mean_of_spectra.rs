//! Mean of spectra: averaged over periods before dividing, the better choice where the input is
//! measured with noise.
//!
//! `G_p = Y_p U_p^+`, and `T_pq = G_p + (Y_pq - G_p U_pq) U_p^+`, which is what period q contributes
//! to G_p to first order in the noise.

use crate::error::deficient_line::DeficientLine;
use crate::frf::blocks::{BlockEstimates, BlockMethod, Invertible, LineBlock, mean};
use crate::frf::right_division::right_divide;

pub(crate) struct MeanOfSpectra;

impl BlockMethod for MeanOfSpectra {
    fn estimates(
        &self,
        blocks: &[Vec<LineBlock>],
        invertible: &Invertible,
    ) -> Result<BlockEstimates, DeficientLine> {
        let mut condition = 0.0_f64;
        let mut estimate = |periods: &Vec<LineBlock>| {
            let u = mean(periods.iter().map(|block| &block.u));
            condition = condition.max(invertible(&u)?);
            let response = right_divide(&mean(periods.iter().map(|block| &block.y)), &u);
            let contribution = |block: &LineBlock| {
                &response + right_divide(&(&block.y - &response * &block.u), &u)
            };
            Ok(periods.iter().map(contribution).collect())
        };
        let blocks = blocks.iter().map(&mut estimate).collect::<Result<_, _>>()?;
        Ok(BlockEstimates { blocks, condition })
    }
}
