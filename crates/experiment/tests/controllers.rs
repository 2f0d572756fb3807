//! Controllers by their kind in `experiment.toml`: read, refused with their place, written, and
//! identified in closed loop.

use frfid_experiment::{ConfigError, Experiment, TomlText, silent};
use frfid_plant::LoopFrf;

const T: f64 = 1e-3;

/// A linear joint under a controller.
const DESCRIPTION: &str = r#"
seed = 3
sample_time_s = 1e-3
[robot.single_joint]
motor_inertia_kg_m2 = 35.0
link_inertia_kg_m2 = 150.0
damping_nms_per_rad = 400.0
stiffness_nm_per_rad = 1.5e5
CONTROLLER
[multisine]
low_hz = 1.0
high_hz = 60.0
resolution_hz = 0.5
peak_rad_s = [0.02]
[averaging]
realizations = 1
lead_in_s = 10.0
"#;

const FILTERED: &str = r#"
[controller]
kind = "filtered-pi"
[controller.pi]
gain_nms_per_rad = [1500.0]
integral_gain_nm_per_rad = [12000.0]
delay_samples = 1
[controller.low_pass]
corner_hz = [180.0]
[controller.notch]
frequency_hz = [11.6]
width_hz = [3.0]
gain = [0.2]
"#;

const PI: &str =
    "[controller]\ngain_nms_per_rad = [1500.0]\nintegral_gain_nm_per_rad = [12000.0]\n";

fn described(controller: &str) -> Result<Experiment, ConfigError> {
    let text = TomlText::new("x.toml", DESCRIPTION.replace("CONTROLLER", controller));
    Experiment::new(text, "nowhere".as_ref())
}

#[test]
fn a_filtered_loop_is_identified_as_its_linear_system_says() {
    let experiment = described(FILTERED).expect("sound");
    assert_eq!(experiment.warnings(), Vec::<String>::new());
    let outcome = experiment
        .measure(&*experiment.testbed(), 0, &silent)
        .expect("measured");
    let frf = outcome.result.frf;
    let controller = experiment.controller().expect("described");
    let of_loop = LoopFrf::new(
        &**experiment.model().expect("a robot"),
        &**controller,
        T,
        experiment.sensors(),
        &frf.frequency_hz,
    )
    .expect("regular");
    for (found, truth) in frf.response.iter().zip(&of_loop.plant.response) {
        assert!((found / truth - 1.0).norm() < 1e-6, "{found} for {truth}");
    }
    // the notch is in the torque: at its frequency the reference asks for a fifth of it
    let plan = experiment.plan();
    let run = plan
        .run(plan.run_ids().next().expect("one run"))
        .expect("sound");
    let record = experiment.testbed().run(&run).expect("simulated");
    let measured = |hz: f64| {
        let last = record.n_samples() - plan.period_samples().expect("sound");
        let line = |x: &ndarray::Array2<f64>| {
            let turn =
                |k: usize| num_complex::Complex64::cis(-std::f64::consts::TAU * hz * T * k as f64);
            (last..record.n_samples())
                .map(|k| x[[0, k]] * turn(k))
                .sum::<num_complex::Complex64>()
        };
        line(&record.u) / line(record.r.as_ref().expect("recorded"))
    };
    for (hz, truth) in frf
        .frequency_hz
        .iter()
        .zip(&of_loop.reference_to_torque.response)
    {
        assert!((measured(*hz) / truth - 1.0).norm() < 1e-6, "{hz} Hz");
    }
}

#[test]
fn a_description_with_a_kind_stands_alone_and_pi_is_written_without_one() {
    for controller in [
        FILTERED,
        PI,
        &PI.replace("[controller]", "[controller]\nkind = \"pi\""),
    ] {
        let experiment = described(controller).expect("sound");
        let again = TomlText::new("again.toml", experiment.to_toml());
        let again = Experiment::new(again, "nowhere".as_ref()).expect("sound");
        assert_eq!(again, experiment);
        assert_eq!(
            experiment.to_toml().contains("kind = \"filtered-pi\""),
            controller == FILTERED
        );
    }
    assert_eq!(
        described(PI).expect("sound").to_toml(),
        described(&PI.replace("[controller]", "[controller]\nkind = \"pi\""))
            .expect("sound")
            .to_toml()
    );
}

#[test]
fn what_is_wrong_in_a_controller_is_underlined() {
    let all = [
        (
            FILTERED,
            "filtered-pi",
            "filtred-pi",
            "unknown variant `filtred-pi`",
            "\"filtred-pi\"",
        ),
        (
            FILTERED,
            "corner_hz = [180.0]",
            "corner_hz = [-1.0]",
            "corner_hz is -1",
            "[-1.0]",
        ),
        (
            FILTERED,
            "corner_hz",
            "corner",
            "unknown field `corner`",
            "corner",
        ),
        (
            FILTERED,
            "width_hz = [3.0]",
            "width_hz = 3.0",
            "needed a list",
            "3.0",
        ),
        (
            FILTERED,
            "gain = [0.2]",
            "gain = [1.2]",
            "a notch takes out",
            "[1.2]",
        ),
        (
            FILTERED,
            "delay_samples = 1",
            "delay_samples = 101",
            "at most 100",
            "101",
        ),
        (
            FILTERED,
            "kind = \"filtered-pi\"",
            "",
            "unknown field `low_pass`",
            "low_pass",
        ),
        (PI, "[1500.0]", "[-1.0]", "gain_nms_per_rad is -1", "[-1.0]"),
        (
            PI,
            "[1500.0]",
            "[1.0, 2.0]",
            "has shape [2], needed (1)",
            "[1.0, 2.0]",
        ),
        (
            PI,
            "[controller]",
            "[controller]\nkind = 3",
            "needed: the name of a kind",
            "3",
        ),
    ];
    for (controller, from, to, says, marked) in all {
        assert!(controller.contains(from), "{from}");
        let error = described(&controller.replacen(from, to, 1)).expect_err(to);
        let place = error
            .place
            .clone()
            .unwrap_or_else(|| panic!("no place: {error}"));
        let text = place.text.chars().skip(place.column - 1);
        assert!(error.message.contains(says), "{error}");
        assert_eq!(
            text.take(place.width).collect::<String>(),
            marked,
            "{error}"
        );
    }
}
