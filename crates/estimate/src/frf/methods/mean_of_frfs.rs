//! Mean of FRFs, SK15 (13): the paper's arithmetic mean of (7), `T_pq = Y_pq U_pq^+`; unbiased where
//! the input is known exactly.

use crate::error::deficient_line::DeficientLine;
use crate::frf::blocks::{BlockEstimates, BlockMethod, Invertible, LineBlock};
use crate::frf::right_division::right_divide;

pub(crate) struct MeanOfFrfs;

impl BlockMethod for MeanOfFrfs {
    fn estimates(
        &self,
        blocks: &[Vec<LineBlock>],
        invertible: &Invertible,
    ) -> Result<BlockEstimates, DeficientLine> {
        let mut condition = 0.0_f64;
        let mut estimate = |block: &LineBlock| {
            condition = condition.max(invertible(&block.u)?);
            Ok(right_divide(&block.y, &block.u))
        };
        let blocks = blocks
            .iter()
            .map(|periods| periods.iter().map(&mut estimate).collect())
            .collect::<Result<_, _>>()?;
        Ok(BlockEstimates {
            blocks,
            realizations: None,
            condition,
        })
    }
}
