//! Methods that work line by line, a file each.

pub(crate) mod instruments;
pub(crate) mod least_squares;
mod leverage;
pub(crate) mod local_models;
pub(crate) mod logarithmic_mean;
pub(crate) mod mean_of_frfs;
pub(crate) mod mean_of_spectra;
