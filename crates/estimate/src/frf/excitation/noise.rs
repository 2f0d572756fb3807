//! Noise of one period of a signal, and what stands out of it.

use crate::frf::f_distribution::f_tail;

/// Noise of one period.
pub(super) struct Noise {
    pub(super) power: f64,
    /// Complex degrees of freedom with which it is known.
    freedom: usize,
}

impl Noise {
    /// From a sum of squares; `None` without a degree of freedom.
    pub(super) fn of(squares: f64, freedom: usize) -> Option<Self> {
        let power = squares / freedom as f64;
        (freedom > 0).then_some(Self { power, freedom })
    }

    /// Whether a sum of so many powers is larger than noise makes it but by this chance.
    pub(super) fn is_below(&self, power: f64, terms: usize, chance: f64) -> bool {
        let ratio = power / (terms as f64 * self.power);
        self.power <= 0.0 || f_tail(ratio, terms, self.freedom as f64) <= chance
    }
}
