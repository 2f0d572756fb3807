//! Logarithmic mean: FRFs of single periods averaged as magnitude and phase, entry by entry; less
//! biased than the arithmetic mean where the input is noisy, and no single block outweighs it.
//!
//! ```text
//! G = exp(1/n_p sum_p 1/n_q sum_q log T_pq),   T_pq = Y_pq U_pq^+
//! ```
//!
//! A logarithm's phase is only known up to whole turns; here each phase is the one closest to that of
//! the arithmetic mean. To first order in the noise block (p, q) contributes
//! `G (1 + log T_pq - log G)`, whose mean is G and whose spread its covariance. An entry that is
//! exactly 0 in a block has no logarithm and keeps its arithmetic mean.
//!
//! E. Wernholt, S. Moberg, Experimental comparison of methods for multivariable frequency response
//! function estimation, IFAC World Congress 2008, section 3.

use num_complex::Complex64;

use crate::error::deficient_line::DeficientLine;
use crate::frf::blocks::{
    BlockEstimates, BlockMethod, Invertible, LineBlock, map_blocks, mean, means_over_periods,
};
use crate::frf::matrices::Matrix;
use crate::frf::methods::mean_of_frfs::MeanOfFrfs;

pub(crate) struct LogarithmicMean;

impl BlockMethod for LogarithmicMean {
    fn estimates(
        &self,
        blocks: &[Vec<LineBlock>],
        invertible: &Invertible,
    ) -> Result<BlockEstimates, DeficientLine> {
        let mut estimates = MeanOfFrfs.estimates(blocks, invertible)?;
        let arithmetic = mean(&means_over_periods(&estimates.blocks));
        let logarithms = map_blocks(&estimates.blocks, |t| logarithm(t, &arithmetic));
        let logarithm = mean(&means_over_periods(&logarithms));
        let centre = Centre {
            arithmetic,
            logarithm,
        };
        let of_blocks = estimates.blocks.iter_mut().flatten();
        for (matrix, logarithm) in of_blocks.zip(logarithms.iter().flatten()) {
            centre.put_contribution(matrix, logarithm);
        }
        Ok(estimates)
    }
}

/// The mean of all blocks.
struct Centre {
    arithmetic: Matrix,
    /// Of the logarithms, with phases from those of the arithmetic mean.
    logarithm: Matrix,
}

impl Centre {
    /// Replaces the estimate of a block, of which this is the logarithm, by what it contributes to the
    /// logarithmic mean; entries without a logarithm stay.
    fn put_contribution(&self, block: &mut Matrix, logarithm: &Matrix) {
        for (entry, value) in block.iter_mut().enumerate() {
            let centre = self.logarithm[entry];
            if centre.is_finite() {
                let response = direction(self.arithmetic[entry]) * centre.exp();
                *value = response * (Complex64::ONE + logarithm[entry] - centre);
            }
        }
    }
}

/// Logarithm of every entry, its phase counted from that of a centre.
fn logarithm(block: &Matrix, centre: &Matrix) -> Matrix {
    block.zip_map(centre, |t, centre| (t / direction(centre)).ln())
}

/// The unit number with the phase of this one.
fn direction(value: Complex64) -> Complex64 {
    Complex64::cis(value.arg())
}
