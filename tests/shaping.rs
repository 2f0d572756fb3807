//! Claim 7: iterative shaping reaches the desired torque from references in which every axis first
//! sticks (SK15 5.3, 7.2), on the experiment of `examples/experiments/r3_chirp.toml`.

use std::path::Path;
use std::sync::Arc;

use frfid::estimate::{Note, ShapeOptions, Shaped, Shaper, Step, shape};
use frfid::experiment::Experiment;
use frfid::plant::{PiController, SimulatedRobot, SingleJoint};
use frfid::signals::{Chirp, Limit, Phasing, Profile, Testbed};
use rayon::prelude::*;

/// Shapes an experiment of examples/ with some of its lines replaced.
fn r3(replace: &[(&str, &str)]) -> Shaped {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/experiments");
    let mut text = std::fs::read_to_string(folder.join("r3_chirp.toml")).expect("it is there");
    for (from, to) in replace {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let source = frfid::experiment::TomlText {
        name: "r3_chirp.toml".into(),
        text,
    };
    let experiment = Experiment::new(source, &folder).expect("a sound experiment");
    let testbed = experiment.testbed();
    finish(&*testbed, experiment.shaper().expect("a sound [shape]").0)
}

fn finish(testbed: &dyn Testbed, mut shaper: Shaper) -> Shaped {
    while shaper.stop().is_none() {
        let records: Result<Vec<_>, _> = shaper
            .runs()
            .par_iter()
            .map(|run| testbed.run(run))
            .collect();
        shaper
            .measured(records.expect("it runs"))
            .expect("it responds");
    }
    shaper.finish().expect("it was measured")
}

#[test]
fn claim_7_the_r3_gets_the_torque_asked_for_in_six_iterations_within_its_limits() {
    for mimo in ["sign-flip", "orthogonal"] {
        let shaped = r3(&[("mimo = \"sign-flip\"", &format!("mimo = \"{mimo}\""))]);
        assert!(
            shaped.iterations[0].notes.contains(&Note::AllStuck) && shaped.iterations.len() <= 6
        );
        let error = shaped.best.error().expect("complete");
        assert!(error < 0.10, "{mimo}: {error}");
        assert!(
            shaped.best.stuck_share.iter().all(|&share| share < 0.15),
            "{mimo}: {:?}",
            shaped.best.stuck_share
        );
        assert!(shaped.sticking.is_empty());
        for i in &shaped.iterations {
            assert!(i.within_limits, "{mimo}: {:?}", i.notes);
            assert!(
                i.peaks
                    .get(Limit::Travel)
                    .expect("measured")
                    .iter()
                    .all(|&travel| travel < 4f64.to_radians()),
                "{mimo}: {:?}",
                i.peaks
            );
        }
        // orthogonality made at u: 1, or 2 for the sign flip
        let (median, ideal) = (
            condition_of(&shaped, 0.5),
            if mimo == "orthogonal" { 1.0 } else { 2.0 },
        );
        assert!((median / ideal - 1.0).abs() < 0.08, "{mimo}: {median}");
        assert!(condition_of(&shaped, 0.9) < 1.15 * ideal, "{mimo}");
    }
}

/// The condition number of U, channels scaled alike, that a share of the lines stays below.
fn condition_of(shaped: &Shaped, share: f64) -> f64 {
    let mut condition = shaped
        .best
        .estimate
        .as_ref()
        .expect("complete")
        .condition
        .clone();
    condition.sort_by(f64::total_cmp);
    condition[(share * (condition.len() - 1) as f64) as usize]
}

#[test]
fn orthogonality_made_at_r_is_lost_on_the_way_to_u() {
    let shaped = r3(&[
        ("mimo = \"sign-flip\"", "mimo = \"orthogonal\""),
        ("[0.006, 0.006, 0.012]", "[0.15, 0.15, 0.3]"),
        ("n_iterations = 6", "n_iterations = 1"),
    ]);
    // made at u it is 1.06 in the median and 1.12 at nine of ten lines; here 1.08 and 1.30
    assert!(
        condition_of(&shaped, 0.9) > 1.25,
        "{}",
        condition_of(&shaped, 0.9)
    );
}

#[test]
fn claim_7_the_papers_step_diverges_with_friction() {
    let shaped = r3(&[
        ("step = \"damped\"", "step = \"paper\""),
        ("n_iterations = 6", "n_iterations = 10"),
    ]);
    let of_axis_1: Vec<f64> = shaped
        .iterations
        .iter()
        .filter_map(|i| Some(i.channel_error.as_ref()?[0]))
        .collect();
    let best = of_axis_1.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(
        of_axis_1[of_axis_1.len() - 1] > 1.2 * best && best > 0.10,
        "{of_axis_1:?}"
    );
}

#[test]
fn the_torques_of_table_1_leave_axis_2_of_the_r3_sticking_above_40_hz() {
    let shaped = r3(&[(
        "[[36.0, 200.0], [44.0, 100.0]],\n    [[36.0, 400.0], [44.0, 200.0]],\n    [[36.0, 200.0], [44.0, 100.0]],",
        "[[36.0, 100.0], [44.0, 50.0]],\n    [[36.0, 150.0], [44.0, 75.0]],\n    [[36.0, 120.0], [44.0, 60.0]],",
    )]);
    let axis_2 = shaped
        .sticking
        .iter()
        .find(|sticking| sticking.axis == 1)
        .expect("75 N m against 105 N m");
    assert!(
        (35.0..42.0).contains(&axis_2.low_hz) && axis_2.high_hz == 60.0 && axis_2.stuck_share > 0.9,
        "{axis_2}"
    );
    assert!(
        axis_2.to_string().starts_with("axis 2 sticks 9") && axis_2.coulomb_nm == Some(105.0),
        "{axis_2}"
    );
}

#[test]
fn claim_7_the_single_joint_gets_its_torque_too() {
    let controller = PiController::new(vec![2000.0], vec![16_000.0]);
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    let testbed = SimulatedRobot::closed_loop(Arc::new(joint), Arc::new(controller), 1e-3);
    let sample = |amplitude: f64| {
        let amplitude = vec![Profile::constant(amplitude)];
        let chirp = Chirp {
            low_hz: 2.0,
            high_hz: 60.0,
            duration_s: 20.0,
            amplitude,
            fade_s: 0.25,
            tail_s: 2.0,
        };
        chirp
            .sample(1e-3, 1, Phasing::SignFlip)
            .expect("a sound chirp")
    };
    let shaped = |step| {
        let options = ShapeOptions {
            step,
            good_enough: 0.005,
            n_iterations: 10,
            ..ShapeOptions::default()
        };
        shape(&testbed, sample(150.0), sample(0.006), options, &mut |_| {
            Ok(true)
        })
        .expect("it responds")
    };
    let damped = shaped(Step::default());
    assert_eq!(damped.iterations[0].notes[0], Note::AllStuck);
    assert!(
        damped.iterations[5].error.is_some_and(|error| error < 0.05)
            && damped.best.stuck_share[0] < 0.15
    );
    assert!(damped.best.error().is_some_and(|error| error < 0.01));
    let paper = shaped(Step::Paper);
    assert!(paper.best.error() > Some(0.02), "{:?}", paper.best.error());
}
