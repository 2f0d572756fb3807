//! Templates of `experiment.toml`, one for each kind of experiment: the very files under `examples/`.

/// A template.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Template {
    /// Name, as given to `frfid init`.
    pub kind: &'static str,
    /// What it is for, in a few words.
    pub purpose: &'static str,
    text: &'static str,
}

/// The paper's joint, as it stands in `examples/robots/`.
const PAPER_JOINT: &str = include_str!("../../../examples/robots/paper_joint.toml");

/// Every template.
pub const TEMPLATES: [Template; 3] = [
    Template {
        kind: "multisine",
        purpose: "odd random multisine, best linear approximation",
        text: include_str!("../../../examples/experiments/multisine.toml"),
    },
    Template {
        kind: "chirp",
        purpose: "exponential chirp, evaluated by excerpts",
        text: include_str!("../../../examples/experiments/chirp.toml"),
    },
    Template {
        kind: "constant-velocity",
        purpose: "multisine on a constant velocity, clear of Coulomb friction",
        text: include_str!("../../../examples/experiments/constant_velocity.toml"),
    },
];

impl Template {
    /// The template of this name.
    #[must_use]
    pub fn named(kind: &str) -> Option<&'static Self> {
        TEMPLATES.iter().find(|template| template.kind == kind)
    }

    /// The text, the robot's tables in place of the robot's file: it stands alone wherever it is written.
    #[must_use]
    pub fn text(&self) -> String {
        let table = PAPER_JOINT.replace("[single_joint]", "[robot.single_joint]");
        self.text.replace("[robot]\nfile = \"../robots/paper_joint.toml\"\n", &table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Experiment, Source};

    #[test]
    fn every_template_stands_alone_and_is_sound() {
        for template in TEMPLATES {
            let source = Source { name: template.kind.into(), text: template.text() };
            let experiment = Experiment::new(source, "nowhere".as_ref()).expect(template.kind);
            assert_eq!(experiment.plan.n_inputs, 1);
        }
    }
}
