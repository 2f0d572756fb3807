//! Run files: what one run measured, and where it comes from.

pub(crate) mod header;
pub(crate) mod read;
#[cfg(test)]
pub(crate) mod tests;
pub(crate) mod topics;
pub(crate) mod write;
