//! Results in files: JSON, and exports for other tools.

pub(crate) mod arrays;
pub(crate) mod csv;
pub(crate) mod exports;
pub(crate) mod float;
mod harmonics_json;
pub(crate) mod json;
pub(crate) mod json_array;
pub(crate) mod mat;
pub(crate) mod npz;
pub(crate) mod packed_numbers;
pub(crate) mod result_file;
mod sealed;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod uff;
pub(crate) mod verdict;
pub(crate) mod verdict_table;
