//! Numbers: ranges that parameters must lie in, named random streams, power and median.

pub mod checks;
pub mod format;
pub(crate) mod median;
pub mod power;
pub mod random;
pub(crate) mod spacing;
