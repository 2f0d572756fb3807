//! The stepped sine from its description to the FRF: on linear robots it finds their truth.

use std::path::Path;

use frfid::experiment::{Experiment, Template, TomlText, silent};
use frfid::plant::Hold;
use frfid::signals::{Excitation, RunId};

/// Largest error of any entry beside the truth's entry of the same output and input.
fn largest_error(experiment: &Experiment) -> f64 {
    let outcome = experiment
        .measure(&*experiment.testbed(), 0, &silent)
        .expect("measured");
    let frf = outcome.result.frf;
    let truth = experiment
        .truth(&frf.frequency_hz, Hold::Zoh, true)
        .expect("sound");
    assert_eq!(frf.response.dim(), truth.response.dim());
    let errors = frf.response.iter().zip(&truth.response);
    errors
        .map(|(found, truth)| (found / truth - 1.0).norm())
        .fold(0.0, f64::max)
}

#[test]
fn a_linear_joint_s_truth_is_found_to_a_millionth() {
    let template = Template::named("stepped-sine").expect("built in");
    let experiment = Experiment::of_template(template).expect("sound");
    let linear = experiment
        .with(|config| {
            let joint = config.robot.single_joint.as_mut().expect("a single joint");
            joint.coulomb_nm = 0.0;
            config.averaging.repetitions = 1;
            config.limits = Default::default();
        })
        .expect("sound");
    let error = largest_error(&linear);
    println!("largest error {error:.2e}");
    assert!(error < 1e-6, "{error:e}");
}

/// Its friction is a constant on the constant velocity, and its stiffness does not change.
#[test]
fn the_joint_that_glides_has_the_truth_too_and_repetitions_tell_the_noise() {
    let template = Template::named("stepped-sine").expect("built in");
    let experiment = Experiment::of_template(template).expect("sound");
    assert!(largest_error(&experiment) < 1e-6);
    let outcome = experiment
        .measure(&*experiment.testbed(), 0, &silent)
        .expect("measured");
    assert_eq!(outcome.warnings, Vec::<String>::new());
    assert!(outcome.result.frf.noise.is_some());
}

/// The Manutec r3 in closed loop, small and linear.
const THREE_AXES: &str = r#"
seed = 1
sample_time_s = 1e-3
[robot]
file = "robots/manutec_r3.toml"
challenges = { coulomb_friction = false, torque_ripple = false, sensing = false }
[controller]
gain_nms_per_rad = [1500.0, 1500.0, 400.0]
integral_gain_nm_per_rad = [12000.0, 12000.0, 3200.0]
[stepped_sine]
low_hz = 3.0
high_hz = 50.0
n_frequencies = 8
amplitude_rad_s = [1e-7, [[3.0, 1e-7], [50.0, 5e-8]], 1e-7]
settle_s = 4.0
mimo = "PHASING"
"#;

#[test]
fn three_axes_in_closed_loop_by_sign_flip_and_one_at_a_time() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    for phasing in ["sign-flip", "one-at-a-time", "orthogonal"] {
        let text = TomlText::new("three_axes.toml", THREE_AXES.replace("PHASING", phasing));
        let experiment = Experiment::new(text, &examples).expect("sound");
        let error = largest_error(&experiment);
        println!("{phasing}: largest error {error:.2e}");
        // the integrator keeps the arm's FRF to about a millionth of the truth
        assert!(error < 2e-6, "{phasing}: {error:e}");
    }
}

#[test]
fn a_plan_with_a_stepped_sine_is_written_and_read_and_does_it_once() {
    let template = Template::named("stepped-sine").expect("built in");
    let experiment = Experiment::of_template(template).expect("sound");
    let again = TomlText::new("again", experiment.to_toml());
    assert_eq!(
        Experiment::new(again, Path::new("")).expect("sound").plan(),
        experiment.plan()
    );
    let plan = experiment.plan();
    assert!(matches!(plan.excitation, Excitation::SteppedSine(_)));
    let run = plan.run(RunId::excitation(0, 0, 1)).expect("in the plan");
    assert_eq!(Ok(run.reference.ncols()), plan.run_samples());
    let refused = experiment.with(|config| config.averaging.periods = 2);
    let message = refused.expect_err("done once").to_string();
    assert!(
        message.contains("periods is 2, needed: 1 with a stepped-sine"),
        "{message}"
    );
}
