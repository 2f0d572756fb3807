//! One file for each command: its arguments and what it does.

pub(crate) mod check;
pub(crate) mod completions;
pub(crate) mod design;
pub(crate) mod init;
pub(crate) mod man;
pub(crate) mod schema;
