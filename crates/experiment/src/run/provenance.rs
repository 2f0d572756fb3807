//! Provenance of a file: version, seed and hashes, the same in plans, records and results. No
//! clock and no machine in it: the same description gives the same bytes.

use std::collections::BTreeMap;

use frfid_files::sha256_hex;
use frfid_signals::Plan;

use crate::experiment::Experiment;

/// Names and values that say where a file comes from.
pub(crate) type Metadata = BTreeMap<String, String>;

/// Key of the plan itself, as JSON.
pub(crate) const PLAN: &str = "plan";
/// Key of the hash of the plan: records with the same one belong together.
pub(crate) const DESIGN: &str = "design_sha256";
/// Key of the hash of the whole description, robot included: a run with the same one needs not be
/// done again.
pub(crate) const CONFIG: &str = "config_sha256";

impl Experiment {
    /// SHA-256 of the whole description, robot included.
    pub(crate) fn config_sha256(&self) -> String {
        sha256_hex(self.to_toml().as_bytes())
    }

    /// Version, seed, hashes and the plan itself, as they stand in the metadata record `frfid` of
    /// plans and runs.
    #[must_use]
    pub fn provenance(&self) -> Metadata {
        let plan = plan_json(&self.plan);
        metadata([
            ("frfid_version", env!("CARGO_PKG_VERSION").to_owned()),
            ("seed", self.config.seed.to_string()),
            (CONFIG, self.config_sha256()),
            (DESIGN, sha256_hex(plan.as_bytes())),
            (PLAN, plan),
        ])
    }
}

/// Names with their values.
pub(crate) fn metadata<const N: usize>(entries: [(&str, String); N]) -> Metadata {
    entries.map(|(name, value)| (name.to_owned(), value)).into()
}

/// The plan as JSON.
fn plan_json(plan: &Plan) -> String {
    serde_json::to_string(plan).expect("a plan is structs, lists and finite numbers")
}
