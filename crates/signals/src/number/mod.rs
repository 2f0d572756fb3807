//! Numbers: ranges that parameters must lie in, room for arrays, named random streams, power, median and divisor.

pub mod checks;
pub(crate) mod divisor;
pub mod format;
pub(crate) mod median;
pub mod power;
pub mod random;
pub mod room;
pub(crate) mod spacing;
