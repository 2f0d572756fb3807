//! `joint_limits.yaml` beside a description: read, tightened by the keys beside it, carried along.

use std::path::Path;

use frfid_experiment::{ConfigError, Experiment, TomlText};
use frfid_signals::Limit;

const YAML: &str = "\
joint_limits:
  joint_1: {has_velocity_limits: true, max_velocity: 1.0, has_effort_limits: true, max_effort: 1.0e4}
  joint_2: {has_velocity_limits: true, max_velocity: 1.1}
";

/// The template of three axes with another table of limits, in a folder with the file.
fn read(limits: &str, yaml: Option<&str>) -> Result<Experiment, ConfigError> {
    let folder = tempfile::tempdir().expect("writable");
    if let Some(yaml) = yaml {
        std::fs::write(folder.path().join("joint_limits.yaml"), yaml).expect("writable");
    }
    let template = frfid_experiment::Template::named("r3-multisine")
        .expect("built in")
        .text();
    let (before, rest) = template.split_once("[limits]\n").expect("it has limits");
    let after = rest.split_once("\n[").map_or("", |(_, after)| after);
    let text = format!("{before}[limits]\n{limits}\n[{after}");
    Experiment::new(TomlText::new("x.toml", text), folder.path())
}

#[test]
fn the_tighter_of_file_and_keys_binds_and_travels_with_the_description() {
    let keys = "file = \"joint_limits.yaml\"\nmax_velocity = [0.9, 1.2, 1.3]";
    let experiment = read(keys, Some(YAML)).unwrap_or_else(|error| panic!("{error}"));
    let velocity = experiment.limits().get(Limit::Velocity).expect("given");
    assert_eq!(velocity, [0.9, 1.1, 1.3]);
    assert_eq!(
        experiment.config().limits.given.of(Limit::Torque, 2),
        f64::INFINITY
    );
    let note = "joint_limits.yaml has no entry for joint_3: it does not limit them";
    assert_eq!(experiment.warnings(), [note]);
    let alone = TomlText::new("plan.toml", experiment.to_toml());
    let alone =
        Experiment::new(alone, Path::new("nowhere")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((alone.limits(), &alone), (experiment.limits(), &experiment));
}

#[test]
fn what_is_wrong_is_shown_at_the_name_of_the_file() {
    for (yaml, needed) in [
        (None, "cannot read"),
        (
            Some("joint_limits: {joint_9: {}}"),
            "found limits of joint_9",
        ),
        (Some("a: ["), "joint_limits.yaml: not YAML"),
    ] {
        let error = read("file = \"joint_limits.yaml\"", yaml).expect_err(needed);
        let place = error.place.clone().expect("a place");
        assert!(error.message.contains(needed), "{error}");
        assert_eq!(place.text, "file = \"joint_limits.yaml\"");
    }
    let error = read("max_effrot = [1.0]", None).expect_err("misspelt");
    let place = error.place.clone().expect("a place");
    assert!(
        error.message.contains("did you mean `max_effort`?"),
        "{error}"
    );
    assert_eq!(place.text, "max_effrot = [1.0]");
}
