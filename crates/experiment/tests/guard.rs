//! References beyond a limit are not sent to a machine, whatever door they come by.

use std::path::Path;

use frfid_experiment::{Experiment, Guarded, Template, TomlText};
use frfid_signals::{Record, Run, Testbed, TestbedError};

/// A machine that must not be asked.
struct Untouched;

impl Testbed for Untouched {
    fn n_inputs(&self) -> usize {
        1
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        panic!("run {} was sent", run.id)
    }
}

/// Why the first run of a template with replacements is not sent.
fn refused(template: &str, changes: &[(&str, &str)]) -> String {
    let mut text = Template::named(template).expect("built in").text();
    for (from, to) in changes {
        assert!(text.contains(from), "{from} is not in the template");
        text = text.replacen(from, to, 1);
    }
    let text = TomlText::new("x.toml", text);
    let experiment = Experiment::new(text, Path::new("nowhere")).unwrap_or_else(|e| panic!("{e}"));
    let plan = experiment.plan();
    let run = plan
        .run(plan.run_ids().next().expect("runs"))
        .expect("drawn");
    let guarded = Guarded::of(&experiment, &Untouched);
    guarded.run(&run).expect_err("beyond a limit").to_string()
}

#[test]
fn what_is_beyond_a_limit_by_itself_is_not_sent() {
    let short = ("resolution_hz = 0.1", "resolution_hz = 2.0");
    let torque = refused(
        "multisine",
        &[short, ("max_effort = [150.0]", "max_effort = [100.0]")],
    );
    assert!(torque.contains("max_effort is 100"), "{torque}");
    let rate = ("max_effort = [150.0]", "max_effort_rate = [41e3]");
    let rate = refused("multisine", &[short, rate]);
    assert!(
        rate.contains("max_effort_rate is 41000") && rate.contains("ramp_s"),
        "{rate}"
    );
    let signal = refused("drive-axis", &[("max_input = [1.0]", "max_input = [0.2]")]);
    assert!(signal.contains("max_input is 0.2"), "{signal}");
}
