//! One file for each command: its arguments and what it does.

pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod design;
pub(crate) mod estimate;
pub(crate) mod export;
pub(crate) mod init;
pub(crate) mod man;
pub(crate) mod recover;
pub(crate) mod run;
pub(crate) mod schema;
pub(crate) mod shape;
