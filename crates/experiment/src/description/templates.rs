//! Templates of `experiment.toml`, one for each kind of experiment: the very files under
//! `examples/`.

/// A template.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Template {
    /// Name, as given to `frfid init`.
    pub kind: &'static str,
    /// What it is for, in a few words.
    pub purpose: &'static str,
    text: &'static str,
    /// Name and text of its robot's file.
    robot: (&'static str, &'static str),
}

/// The robots, as they stand in `examples/robots/`.
const PAPER_JOINT: (&str, &str) = (
    "paper_joint",
    include_str!("../../../../examples/robots/paper_joint.toml"),
);
const MANUTEC_R3: (&str, &str) = (
    "manutec_r3",
    include_str!("../../../../examples/robots/manutec_r3.toml"),
);
const SIX_AXIS: (&str, &str) = (
    "six_axis",
    include_str!("../../../../examples/robots/six_axis.toml"),
);

/// The channels stand in the template itself.
const NO_ROBOT: (&str, &str) = ("", "");

/// Every template.
pub const TEMPLATES: [Template; 9] = [
    Template {
        kind: "multisine",
        purpose: "odd random multisine, best linear approximation",
        text: include_str!("../../../../examples/experiments/multisine.toml"),
        robot: PAPER_JOINT,
    },
    Template {
        kind: "chirp",
        purpose: "exponential chirp, evaluated by excerpts",
        text: include_str!("../../../../examples/experiments/chirp.toml"),
        robot: PAPER_JOINT,
    },
    Template {
        kind: "stepped-sine",
        purpose: "one frequency after the other, each settled and measured over whole periods",
        text: include_str!("../../../../examples/experiments/stepped_sine.toml"),
        robot: PAPER_JOINT,
    },
    Template {
        kind: "constant-velocity",
        purpose: "multisine on a constant velocity, clear of Coulomb friction",
        text: include_str!("../../../../examples/experiments/constant_velocity.toml"),
        robot: PAPER_JOINT,
    },
    Template {
        kind: "drive-axis",
        purpose: "a drive without a model: current injected on top of its velocity loop",
        text: include_str!("../../../../examples/experiments/drive_axis.toml"),
        robot: NO_ROBOT,
    },
    Template {
        kind: "r3-multisine",
        purpose: "three axes in closed loop, multisines on a constant velocity",
        text: include_str!("../../../../examples/experiments/r3_multisine.toml"),
        robot: MANUTEC_R3,
    },
    Template {
        kind: "r3-chirp",
        purpose: "three axes in closed loop, a chirp to be shaped; a lesson about friction",
        text: include_str!("../../../../examples/experiments/r3_chirp.toml"),
        robot: MANUTEC_R3,
    },
    Template {
        kind: "six-axis-multisine",
        purpose: "six axes in closed loop, multisines on a constant velocity; a lesson about orthogonality",
        text: include_str!("../../../../examples/experiments/six_axis_multisine.toml"),
        robot: SIX_AXIS,
    },
    Template {
        kind: "six-axis-chirp",
        purpose: "six axes in closed loop, a chirp to be shaped",
        text: include_str!("../../../../examples/experiments/six_axis_chirp.toml"),
        robot: SIX_AXIS,
    },
];

impl Template {
    /// The template of this name.
    #[must_use]
    pub fn named(kind: &str) -> Option<&'static Self> {
        TEMPLATES.iter().find(|template| template.kind == kind)
    }

    /// The text, the robot's tables in place of the robot's file: it stands alone wherever it is
    /// written.
    #[must_use]
    pub fn text(&self) -> String {
        let (name, robot) = self.robot;
        self.text.replace(
            &format!("[robot]\nfile = \"../robots/{name}.toml\"\n"),
            &within_robot(robot),
        )
    }
}

/// A robot file's text as it stands in `experiment.toml`: its tables are `[robot.TABLE]`, its keys
/// those of `[robot]`.
fn within_robot(text: &str) -> String {
    let mut lines: Vec<String> = text.lines().map(table_within_robot).collect();
    if let Some(first) = lines.iter().position(|line| is_entry(line))
        && !lines[first].starts_with('[')
    {
        lines.insert(first, "[robot]".to_owned());
    }
    lines.join("\n") + "\n"
}

/// Whether a line is a key or a header.
fn is_entry(line: &str) -> bool {
    !line.is_empty() && !line.starts_with('#')
}

/// A line, in which the name of a table is put beneath `robot`; lines within a list are indented
/// and no headers.
fn table_within_robot(line: &str) -> String {
    match line.strip_prefix("[[") {
        Some(name) => format!("[[robot.{name}"),
        None => line
            .strip_prefix('[')
            .map_or_else(|| line.to_owned(), |name| format!("[robot.{name}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::text::TomlText;
    use crate::experiment::Experiment;

    #[test]
    fn every_template_stands_alone_and_is_sound() {
        for template in TEMPLATES {
            let source = TomlText {
                name: template.kind.into(),
                text: template.text(),
            };
            let experiment = Experiment::new(source, "nowhere".as_ref()).expect(template.kind);
            let axes = [("six", 6), ("r3", 3), ("", 1)]
                .into_iter()
                .find(|(kind, _)| template.kind.starts_with(kind));
            assert_eq!(axes.map(|(_, axes)| axes), Some(experiment.plan.n_inputs));
            assert_eq!(
                experiment.warnings(),
                Vec::<String>::new(),
                "{}",
                template.kind
            );
        }
    }
}
