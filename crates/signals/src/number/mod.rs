//! Numbers: ranges that parameters must lie in, named random streams, power of signals.

pub mod checks;
pub mod format;
pub mod power;
pub mod random;
pub(crate) mod spacing;
