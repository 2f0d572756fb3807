//! Spectra of runs: from samples to lines.

pub(crate) mod campaign;
pub(crate) mod excerpt;
pub(crate) mod line_dft;
