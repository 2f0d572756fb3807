//! Index of a measured period in a campaign.

/// Which period of a campaign: all indices from 0, sorted in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PeriodIndex {
    /// Draw of the random phases.
    pub realization: usize,
    /// Period or repetition.
    pub period: usize,
    /// Column of U.
    pub experiment: usize,
}

impl PeriodIndex {
    /// Realization and period, which all experiments of a block share.
    pub(crate) fn block(&self) -> (usize, usize) {
        (self.realization, self.period)
    }
}
