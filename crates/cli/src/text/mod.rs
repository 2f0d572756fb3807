//! Texts for people: tables of what was designed, reached and checked.

pub(crate) mod checks;
pub(crate) mod load;
pub(crate) mod plan;
pub(crate) mod strength;
pub(crate) mod table;
