//! MCAP containers: read with every checksum, written, recovered.

pub(crate) mod chunk;
pub(crate) mod open;
pub(crate) mod read;
pub(crate) mod record;
pub(crate) mod recover;
pub(crate) mod summary;
pub(crate) mod write;
