//! Small signals: without friction, ripple and quantisation a closed-loop experiment on the Manutec
//! r3 finds the linear truth, with gravity and everything that depends on position left on; what is
//! left is the amplitude, and it goes with it.

use std::path::Path;

use frfid::estimate::{FrfOptions, estimate_bla};
use frfid::experiment::{Experiment, TomlText};
use frfid::plant::{LoopFrf, Sensor, SimulatedRobot};
use frfid::signals::{Excitation, Frf};
use ndarray::{Array5, s};

/// The multisine of section 7 without a constant velocity: the second of two periods is measured.
const DESCRIPTION: &str = "\
seed = 1
sample_time_s = 0.001

[robot]
file = \"robots/manutec_r3.toml\"
challenges = { coulomb_friction = false, torque_ripple = false, sensing = false }

[controller]
gain_nms_per_rad = [1500.0, 1500.0, 400.0]
integral_gain_nm_per_rad = [12000.0, 12000.0, 3200.0]

[multisine]
low_hz = 2.0
high_hz = 60.0
resolution_hz = 0.1
n_lines = 80
grid = \"odd\"
peak_rad_s = [PEAK]
mimo = \"orthogonal\"

[averaging]
lead_in_s = 12.288
";

/// What an experiment of one amplitude found.
struct Found {
    /// Largest torque about its mean in N m on every axis.
    torque_nm: [f64; 3],
    /// Largest errors of u to y, r to u and r to y.
    errors: [Errors; 3],
}

/// Largest |G - P|, each relative to |P| of the entry itself, and to the largest entry of its line.
#[derive(Debug)]
struct Errors {
    own: f64,
    line: f64,
}

fn errors(found: &Frf, truth: &Frf) -> Errors {
    let mut errors = Errors {
        own: 0.0,
        line: 0.0,
    };
    for (found, truth) in found.response.outer_iter().zip(truth.response.outer_iter()) {
        let largest = truth.iter().map(|p| p.norm()).fold(0.0, f64::max);
        for (g, p) in found.iter().zip(truth) {
            errors.own = errors.own.max((g - p).norm() / p.norm());
            errors.line = errors.line.max((g - p).norm() / largest);
        }
    }
    errors
}

/// Three experiments whose references stay below a peak in rad/s; the integrator's steps at most
/// `max_step_s`.
fn experiment(peak_rad_s: f64, max_step_s: Option<f64>, velocity_by_differencing: bool) -> Found {
    let text = DESCRIPTION.replace(
        "PEAK",
        &[peak_rad_s; 3].map(|peak| format!("{peak:e}")).join(", "),
    );
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let source = TomlText {
        name: "small_signal.toml".into(),
        text,
    };
    let experiment = Experiment::new(source, &examples).expect("sound");
    let robot = experiment.model().expect("a robot");
    let controller = experiment.controller().expect("described");
    let testbed = SimulatedRobot {
        max_step_s,
        sensors: vec![
            Sensor {
                velocity_by_differencing,
                ..Sensor::default()
            };
            3
        ],
        ..SimulatedRobot::closed_loop(robot.clone(), controller.clone(), 1e-3)
    };
    let n = experiment.plan().period_samples().expect("sound");
    let [mut r, mut u, mut y] = [(); 3].map(|()| Array5::<f64>::zeros((1, 3, 1, 3, n)));
    for id in experiment.plan().run_ids() {
        let run = experiment.plan().run(id).expect("sound");
        let record = testbed.simulate(&run).expect("stable").record;
        for (all, signal) in [
            (&mut r, record.r.as_ref().expect("recorded")),
            (&mut u, &record.u),
            (&mut y, &record.y),
        ] {
            all.slice_mut(s![0, id.experiment, 0, .., ..])
                .assign(&signal.slice(s![.., record.n_samples() - n..]));
        }
    }
    let torque_nm = std::array::from_fn(|axis| {
        let of_axis = u.slice(s![0, .., 0, axis, ..]);
        of_axis
            .outer_iter()
            .map(|u| u.fold(0.0, |peak: f64, x| peak.max((x - u.sum() / n as f64).abs())))
            .fold(0.0, f64::max)
    });
    let Excitation::Multisine(signal) = &experiment.plan().excitation else {
        panic!("a multisine")
    };
    let frf = |from: &Array5<f64>, to: &Array5<f64>| {
        estimate_bla(
            from.view(),
            to.view(),
            None,
            1e-3,
            &signal.grid.excited,
            &FrfOptions::default(),
        )
        .expect("regular")
    };
    let truth = LoopFrf::new(
        &**robot,
        &**controller,
        1e-3,
        &testbed.sensors,
        &signal.grid.lines_hz(),
    )
    .expect("stable");
    let errors = [
        errors(&frf(&u, &y), &truth.plant),
        errors(&frf(&r, &u), &truth.reference_to_torque),
        errors(&frf(&r, &y), &truth.reference_to_velocity),
    ];
    Found { torque_nm, errors }
}

/// So fine that the amplitude alone counts.
const FINE_STEP_S: Option<f64> = Some(5e-5);

/// The error is proportional to the amplitude, since the way of a run lies beside the pose by as
/// much as the amplitude. (Quadratic distortion falls on even lines, where nothing is measured.)
/// Entries that are weak beside the others of their line take most of it: relative to themselves
/// they need three hundred times less torque.
#[test]
fn the_errors_fall_with_the_amplitude_below_1e_5() {
    let peaks = [1e-3, 1e-4, 3e-6];
    let found = peaks.map(|peak| experiment(peak, FINE_STEP_S, false));
    for (peak, Found { torque_nm, errors }) in peaks.iter().zip(&found) {
        println!(
            "{peak} rad/s, {torque_nm:.4?} N m: u to y {:?}, r to u {:?}, r to y {:?}",
            errors[0], errors[1], errors[2]
        );
    }
    let [one, tenth, least] = &found;
    let near = |found: [f64; 3], needed: [f64; 3]| {
        found
            .iter()
            .zip(needed)
            .all(|(f, n)| (f / n - 1.0).abs() < 0.01)
    };
    assert!(
        near(one.torque_nm, [1.303, 1.449, 0.437]),
        "{:?}",
        one.torque_nm
    );
    assert!(
        near(
            least.torque_nm,
            [1.303, 1.449, 0.437].map(|torque| 3e-3 * torque)
        ),
        "{:?}",
        least.torque_nm
    );
    for path in 0..3 {
        let [one, tenth, least] = [one, tenth, least].map(|found| &found.errors[path]);
        assert!(
            one.line < 1e-5,
            "relative to the largest entry of a line, at 1.4 N m: {one:?}"
        );
        assert!(
            least.own < 1e-5,
            "every entry relative to itself, at 4.3 mN m: {least:?}"
        );
        for ratio in [
            one.line / 1e-3 / (tenth.line / 1e-4),
            one.own / 1e-3 / (tenth.own / 1e-4),
            one.own / 1e-3 / (least.own / 3e-6),
        ] {
            assert!((ratio - 1.0).abs() < 0.02, "not proportional: {ratio}");
        }
    }
}

/// With the default step what is left without amplitude is the integrator's shift of the
/// resonances; it is linear.
#[test]
fn the_default_step_leaves_less_than_a_millionth_and_differenced_readings_are_in_the_truth() {
    for velocity in [false, true] {
        let Found { torque_nm, errors } = experiment(1e-5, None, velocity);
        println!("{velocity:?}, default step, {torque_nm:.4?} N m: {errors:?}");
        assert!(errors.iter().all(|errors| errors.line < 1e-6), "{errors:?}");
    }
}
