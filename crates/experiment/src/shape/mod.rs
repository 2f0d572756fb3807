//! Iterative shaping of a chirp in closed loop, with everything on disk.

pub(crate) mod begin;
pub(crate) mod folder;
pub(crate) mod in_memory;
pub(crate) mod iteration_files;
pub(crate) mod report;
