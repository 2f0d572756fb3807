//! Controller of an experiment: the table `[controller]`, whose `kind` says which; PI without it.

use std::sync::Arc;

use frfid_plant::{Controller, FilteredPi, PiController};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize, Serializer};

/// A controller of the motor velocity: the reference is a velocity then.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(tag = "kind", transform = pi_without_kind)]
pub enum ControllerTable {
    /// A sampled PI controller, with a position loop around it where one is asked for; `kind` may be
    /// left out.
    Pi(PiController),
    /// A PI controller with a low-pass and a notch on its torque.
    FilteredPi(FilteredPi),
}

impl ControllerTable {
    /// The controller.
    #[must_use]
    pub fn controller(&self) -> Arc<dyn Controller> {
        match self {
            Self::Pi(controller) => Arc::new(controller.clone()),
            Self::FilteredPi(controller) => Arc::new(controller.clone()),
        }
    }
}

/// As it stands in the file: with its kind, but for PI, of which older versions of frfid wrote none.
impl Serialize for ControllerTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        #[serde(tag = "kind", rename_all = "kebab-case")]
        enum OfKind<'a> {
            FilteredPi(&'a FilteredPi),
        }
        match self {
            Self::Pi(controller) => controller.serialize(serializer),
            Self::FilteredPi(controller) => OfKind::FilteredPi(controller).serialize(serializer),
        }
    }
}

/// PI is what a table without a kind describes.
fn pi_without_kind(schema: &mut Schema) {
    let first = schema.pointer_mut("/oneOf/0/required");
    if let Some(required) = first.and_then(|required| required.as_array_mut()) {
        required.retain(|key| key != "kind");
    }
}
