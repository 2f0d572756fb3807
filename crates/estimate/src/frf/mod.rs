//! Estimators of the FRF matrix from spectra.

pub(crate) mod bla;
pub(crate) mod excerpts;
pub(crate) mod joint_input_output;
pub(crate) mod right_division;
pub(crate) mod singular;
