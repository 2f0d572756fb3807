//! `experiment.toml`: the description of an experiment, its text and its tables.

pub(crate) mod config;
pub(crate) mod estimate;
pub(crate) mod excitation;
pub(crate) mod robot;
pub(crate) mod schema;
pub(crate) mod shape;
pub(crate) mod templates;
pub(crate) mod text;
