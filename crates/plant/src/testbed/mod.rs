//! Testbeds: a run goes in, a record comes out, sample by sample.

pub(crate) mod closed_loop;
pub(crate) mod open_loop;
pub(crate) mod recorder;
pub(crate) mod run_loop;
pub(crate) mod simulate;
