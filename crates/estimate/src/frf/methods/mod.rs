//! Methods that work line by line, a file each.

pub(crate) mod joint_input_output;
pub(crate) mod least_squares;
pub(crate) mod logarithmic_mean;
pub(crate) mod mean_of_frfs;
pub(crate) mod mean_of_spectra;
