//! What is found in a recording that frfid did not make: its period, its lines, its transient.

pub(crate) mod lines;
pub(crate) mod period;
pub(crate) mod transient;
