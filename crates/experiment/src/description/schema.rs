//! JSON Schema of `experiment.toml`, for editors that complete and check it.

use schemars::schema_for;

use crate::description::config::Config;

/// JSON Schema (draft 2020-12) of `experiment.toml`.
#[must_use]
pub fn schema() -> serde_json::Value {
    schema_for!(Config).to_value()
}
