//! Channels of a machine without a model: designed, held against limits, measured on a machine and
//! estimated in their own units; what needs a model is refused.

use std::f64::consts::TAU;
use std::path::Path;

use frfid_experiment::{
    ConfigError, Experiment, ExperimentError, PlannedRuns, RunOptions, Template, TomlText, predict,
    run_to_folder, silent,
};
use frfid_files::Overwrite;
use frfid_signals::{InputKind, Record, Run, Testbed, TestbedError};
use ndarray::Array2;
use num_complex::Complex64;

fn template() -> String {
    Template::named("drive-axis").expect("built in").text()
}

/// The template with texts in it replaced.
fn described(changes: &[(&str, &str)]) -> Result<Experiment, ConfigError> {
    let mut text = template();
    for (from, to) in changes {
        assert!(text.contains(from), "{from} is not in the template");
        text = text.replacen(from, to, 1);
    }
    Experiment::new(TomlText::new("x.toml", text), Path::new("nowhere"))
}

/// A motor y[k+1] = A y[k] + B u[k] under its own velocity loop u = r - GAIN y.
struct Drive;

const A: f64 = 0.999;
const B: f64 = 0.02;
const GAIN: f64 = 2.0;

impl Testbed for Drive {
    fn n_inputs(&self) -> usize {
        1
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        let n = run.reference.ncols();
        let (mut u, mut y) = (Array2::zeros((1, n)), Array2::zeros((1, n)));
        for k in 0..n {
            u[[0, k]] = run.reference[[0, k]] - GAIN * y[[0, k]];
            if k + 1 < n {
                y[[0, k + 1]] = A * y[[0, k]] + B * u[[0, k]];
            }
        }
        Ok(Record {
            sample_time_s: run.sample_time_s,
            u,
            input_kind: InputKind::Measured,
            y,
            r: Some(run.reference.clone()),
            position_rad: None,
            events: Vec::new(),
        })
    }
}

#[test]
fn what_is_injected_on_top_of_a_running_loop_gives_the_plant_in_the_units_of_the_channels() {
    let experiment = described(&[]).unwrap_or_else(|error| panic!("{error}"));
    let outcome = experiment.measure(&Drive, 0, &silent).expect("measured");
    let result = outcome.result;
    assert_eq!(
        (&result.input_names[..], &result.input_units[..]),
        (&["axis_1 input".to_owned()][..], &["A".to_owned()][..])
    );
    assert_eq!(
        (&result.output_names[..], &result.output_units[..]),
        (&["axis_1 output".to_owned()][..], &["rad/s".to_owned()][..])
    );
    assert_eq!(
        (outcome.strength, outcome.load, result.torque_rms_nm),
        (None, None, None)
    );
    for (hz, found) in result.frf.frequency_hz.iter().zip(&result.frf.response) {
        let z = Complex64::from_polar(1.0, TAU * hz * experiment.plan().sample_time_s);
        let truth = B / (z - A);
        assert!(
            (found / truth - 1.0).norm() < 1e-6,
            "{hz} Hz: {found} for {truth}"
        );
    }
}

/// 16 kHz, two channels, the set-point of a velocity loop; the description travels as it is.
#[test]
fn channels_have_units_rates_and_limits_of_their_own() {
    let experiment = described(&[
        ("0.000250", "0.0000625"),
        ("[\"axis_1\"]", "[\"left\", \"right\"]"),
        ("\"A\"  ", "[\"rpm\", \"deg/s\"]"),
        ("injection = \"torque\"", ""),
        ("[0.5]", "[20.0, 90.0]"),
        ("[1.0]", "[30.0, 80.0]\nmax_input_rate = [1e6, inf]"),
    ]);
    let experiment = experiment.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(experiment.plan().injection.unit(), "rad/s", "a set-point");
    assert_eq!(experiment.reference_units(), ["rpm", "deg/s"]);
    let peaks = PlannedRuns::of(experiment.clone())
        .signal_peaks(0, &silent)
        .expect("sound");
    for (peak, largest) in peaks.peak.iter().zip([20.0, 90.0]) {
        assert!(*peak <= largest && *peak > 0.99 * largest, "{peak}");
    }
    let run = experiment
        .plan()
        .run(experiment.plan().run_ids().next().expect("runs"))
        .expect("drawn");
    let steps = run.reference.row(0).to_vec();
    let steepest = steps
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .fold(0.0, f64::max);
    assert!(peaks.rate[0] >= steepest / 0.0000625 * (1.0 - 1e-12));
    let error = experiment.check_signal(&peaks).expect_err("90 deg/s");
    assert!(error.message.starts_with("right would reach"), "{error}");
    assert!(
        error
            .message
            .contains("deg/s, max_input is 80 deg/s; multiply the amplitudes by 0.88"),
        "{error}"
    );
    let alone = Experiment::new(
        TomlText::new("y.toml", experiment.to_toml()),
        Path::new("nowhere"),
    );
    assert_eq!(alone.expect("sound"), experiment);
}

#[test]
fn what_needs_a_model_says_so() {
    let experiment = described(&[]).expect("sound");
    let is_refused = |error: ExperimentError| {
        assert!(error.to_string().starts_with("no robot model"), "{error}");
    };
    is_refused(predict(&experiment, 0, &silent).expect_err("no model"));
    let folder = tempfile::tempdir().expect("writable");
    let options = RunOptions {
        jobs: 1,
        index: None,
        overwrite: Overwrite::Resume,
    };
    let planned = PlannedRuns::of(experiment.clone());
    is_refused(
        run_to_folder(&planned, None, folder.path(), &options, &silent).expect_err("no model"),
    );
    let run = planned.run(planned.run_ids()[0]).expect("drawn");
    let error = experiment
        .testbed()
        .run(&run)
        .expect_err("no model")
        .to_string();
    assert!(error.contains("no robot model"), "{error}");
}

#[test]
fn what_does_not_fit_channels_is_refused_at_its_place() {
    let robot = "[robot.single_joint]\nmotor_inertia_kg_m2 = 1.0\nlink_inertia_kg_m2 = 1.0\ndamping_nms_per_rad = 1.0\n\
                 stiffness_nm_per_rad = 1.0\n[multisine]";
    for (from, to, needed, marked) in [
        (
            "peak = [0.5]",
            "peak_nm = [0.5]",
            "give peak instead of peak_nm",
            "peak_nm = [0.5]",
        ),
        (
            "peak = [0.5]",
            "peak = [0.5, 0.5]",
            "one for each of the 1 axes",
            "peak = [0.5, 0.5]",
        ),
        (
            "max_input = [1.0]",
            "max_travel = [1.0]",
            "max_travel needs the model",
            "max_travel = [1.0]",
        ),
        (
            "max_input = [1.0]",
            "max_input = [-1.0]",
            "above 0 for each of 1 channels",
            "max_input = [-1.0]",
        ),
        (
            "[\"axis_1\"]",
            "[\"a\", \"a\"]",
            "none twice",
            "names = [\"a\", \"a\"]",
        ),
        ("\"A\"  ", "\"\" ", "input_unit is empty", "input_unit"),
        (
            "\"A\"  ",
            "[\"A\", \"A\"]",
            "input_unit has 2 entries",
            "input_unit",
        ),
        (
            "[multisine]",
            robot,
            "a robot and channels are given",
            "[channels]",
        ),
        (
            "[multisine]",
            "[constant_velocity]\nvelocity_rad_s = [1.0]\n[multisine]",
            "[constant_velocity] needs a [robot]",
            "[constant_velocity]",
        ),
        (
            "[multisine]",
            "[controller]\ngain_nms_per_rad = [1.0]\nintegral_gain_nm_per_rad = [1.0]\n[multisine]",
            "[controller] needs a [robot]",
            "[controller]",
        ),
        (
            "\"torque\"",
            "\"force\"",
            "unknown variant `force`",
            "injection",
        ),
    ] {
        let error = described(&[(from, to)]).expect_err(needed);
        assert!(error.message.contains(needed), "{error}");
        let place = error.place.clone().expect("a place");
        assert!(place.text.contains(marked), "{error}");
    }
    let text = "seed = 1\nsample_time_s = 0.001\n";
    let error = Experiment::new(TomlText::new("x.toml", text), Path::new("")).expect_err("empty");
    assert!(
        error
            .message
            .starts_with("no machine: a table [robot] is needed, or [channels]"),
        "{error}"
    );
    let joint = Template::named("multisine").expect("built in").text();
    for (from, to, needed) in [
        ("max_effort", "max_input", "max_input is for [channels]"),
        ("peak_nm", "peak", "give peak_nm instead of peak"),
    ] {
        let text = TomlText::new("x.toml", joint.replacen(from, to, 1));
        let error = Experiment::new(text, Path::new("")).expect_err(needed);
        assert!(error.message.contains(needed), "{error}");
    }
}
