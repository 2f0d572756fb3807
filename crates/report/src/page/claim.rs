//! Claim of the paper beside our number.

use serde::Serialize;

/// One row of the table of claims.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Claim {
    /// Number as in the list of claims: 1, 2a, ...
    pub id: &'static str,
    /// What is claimed.
    pub statement: &'static str,
    /// What the paper says, or the number to be met.
    pub expected: &'static str,
    /// What we find.
    pub found: String,
    /// Whether it holds.
    pub holds: bool,
}
