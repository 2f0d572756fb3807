//! Experiments on arms: the numbers of their designs, limits of robot and experiment together, and
//! what is refused.

use frfid_experiment::{ConfigError, Experiment, Load, Template, TomlText, predict, silent};
use frfid_signals::{Excitation, Limit, RunId, RunKind};

/// The template `kind` with every `from` replaced by its `to`.
fn described(kind: &str, changes: &[(&str, &str)]) -> Result<Experiment, ConfigError> {
    let mut text = Template::named(kind).expect("built in").text();
    for (from, to) in changes {
        assert!(text.contains(from), "{from} is not in {kind}");
        text = text.replacen(from, to, 1);
    }
    Experiment::new(
        TomlText {
            name: "x.toml".into(),
            text,
        },
        "nowhere".as_ref(),
    )
}

fn experiment(kind: &str, changes: &[(&str, &str)]) -> Experiment {
    described(kind, changes).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_multisines_of_section_7_ride_on_a_velocity_whose_sign_they_never_change() {
    let experiment = experiment("r3-multisine", &[]);
    let plan = experiment.plan();
    let Excitation::Multisine(signal) = &plan.excitation else {
        panic!("a multisine")
    };
    assert_eq!(
        (signal.grid.excited.len(), plan.n_runs()),
        (76, 10 * 3 * 5 + plan.n_glides)
    );
    assert!((signal.grid.period_s() - 12.288).abs() < 1e-12);
    let run_s = plan.run_samples().expect("sound") as f64 * 1e-3;
    let travel = experiment
        .config()
        .constant_velocity
        .as_ref()
        .and_then(|table| table.travel_rad.clone())
        .expect("given");
    for ((velocity, peak), travel) in plan.velocity_rad_s.iter().zip(&signal.peak).zip(&travel) {
        assert!((velocity * run_s - travel).abs() < 1e-12 && (peak - 0.4 * velocity).abs() < 1e-15);
    }
    let id = RunId {
        kind: RunKind::Excitation,
        realization: 3,
        experiment: 1,
        repetition: 2,
    };
    assert!(
        plan.run(id)
            .expect("in the plan")
            .reference
            .iter()
            .all(|&r| r > 0.0)
    );
    assert!(
        (plan.start_rad().expect("sound")[0] + 0.5 * travel[0]).abs() < 1e-12,
        "half the way before the pose"
    );
}

#[test]
fn the_design_of_section_7_stays_inside_its_limits() {
    let few = [
        ("realizations = 10", "realizations = 1"),
        ("repetitions = 5", "repetitions = 1"),
    ];
    let prediction = predict(&experiment("r3-multisine", &few), 0, &silent).expect("simulated");
    assert_eq!(prediction.excesses, vec![]);
    let travel = prediction.load.peaks.get(Limit::Travel).expect("measured");
    assert!(
        travel.iter().all(|travel| (0.06..0.0698).contains(travel)),
        "{travel:?}"
    );
    let lowest = prediction.load.peaks.get(Limit::LowestPosition);
    let lowest = lowest.expect("measured");
    assert!(
        (lowest[0] + 60.0_f64.to_radians() + travel[0]).abs() < 2e-3,
        "{lowest:?}"
    );
    // gravity pulls axis 2 along with 460.57 N m at the pose, of which friction takes 105 N m;
    // ripple comes on top
    let torque = |load: &Load| load.peaks.get(Limit::Torque).expect("measured")[1];
    let resting = torque(&prediction.baseline);
    assert!(
        (355.0..440.0).contains(&resting) && resting < torque(&prediction.load),
        "{resting}"
    );
}

#[test]
fn the_tighter_limit_binds_and_says_how_much_is_left() {
    let few = [
        ("realizations = 10", "realizations = 1"),
        ("repetitions = 5", "repetitions = 1"),
    ];
    let free = predict(&experiment("r3-multisine", &few), 0, &silent).expect("simulated");
    let jerk = |load: &Load| load.peaks.get(Limit::Jerk).expect("predicted")[2];
    let middle = 0.5 * (jerk(&free.baseline) + jerk(&free.load));
    let limits = format!(
        "[limits]\nmax_effort = [5000.0, 800.0, 5000.0]\nmax_jerk = [inf, inf, {middle}]\n"
    );
    let limited = experiment("r3-multisine", &[few[0], few[1], ("[limits]\n", &limits)]);
    assert_eq!(
        limited.limits().get(Limit::Torque),
        Some(&[1098.0, 800.0, 627.0][..])
    );
    assert!(
        limited.limit_is_robots_own(Limit::Torque, 0)
            && !limited.limit_is_robots_own(Limit::Torque, 1)
    );
    let prediction = predict(&limited, 0, &silent).expect("simulated");
    let excess = prediction.binding().expect("a jerk beyond its limit");
    assert_eq!(
        (excess.axis, excess.limit, excess.allowed),
        (2, Limit::Jerk, middle)
    );
    assert!(
        (prediction.feasible_factor().expect("likewise") - 0.5).abs() < 1e-9,
        "half of what the excitation adds"
    );
}

#[test]
fn what_cannot_be_is_refused_with_its_place() {
    let multisine = "r3-multisine";
    let limit = "max_travel = [0.0698, 0.0698, 0.0698]";
    let all = [
        (
            multisine,
            limit,
            "max_effort = [500.0, 300.0, 500.0]",
            "no amplitude is left: without any excitation axis 2",
            "[500.0, 300.0, 500.0]",
        ),
        (
            multisine,
            "max_effort = 2195.0",
            "max_effort = 300.0",
            "(joint_2) is at 3",
            "robot",
        ),
        (
            multisine,
            limit,
            "max_travel = [0.05, 0.0698, 0.0698]",
            "axis 1 (joint_1) is at 0.06",
            "[0.05, 0.0698, 0.0698]",
        ),
        (
            multisine,
            limit,
            "max_position = [0.0, 0.4, 9.0]",
            "axis 2 (joint_2) is at 0.4",
            "[0.0, 0.4, 9.0]",
        ),
        (
            multisine,
            limit,
            "max_jerk = [0.0, 1.0, 1.0]",
            "a number above 0",
            "[0.0, 1.0, 1.0]",
        ),
        (
            multisine,
            "peak_of_velocity = 0.4",
            "peak_of_velocity = 0.0",
            "leaves no peak",
            "0.0",
        ),
        (
            multisine,
            "peak_of_velocity = 0.4",
            "peak_of_velocity = 0.4\npeak_rad_s = [1, 1, 1]",
            "instead of another",
            "0.4",
        ),
        (
            multisine,
            "travel_rad = [",
            "velocity_rad_s = [0.1, 0.1, 0.1]\ntravel_rad = [",
            "one of the two",
            "constant_velocity",
        ),
        (
            multisine,
            "travel_rad = [",
            "travel_rad = [0.1, ",
            "4 entries, needed: one for each of the 3 axes",
            "[0.1, 0.1",
        ),
        (
            multisine,
            "gain_nms_per_rad = [1500.0, ",
            "gain_nms_per_rad = [",
            "gain_nms_per_rad has shape [2]",
            "[1500.0, 400.0]",
        ),
        (
            multisine,
            "gain_nms_per_rad = [1500.0",
            "gain_nms_per_rad = [-1500.0",
            "gain_nms_per_rad is -1500",
            "[-1500.0, 1500.0, 400.0]",
        ),
        (
            multisine,
            "pose_rad = [-1.0471975511965976, ",
            "pose_rad = [",
            "one for each of the 3 joints",
            "[0.3490658503988659, 1.5707963267948966]",
        ),
    ];
    for (kind, from, to, reason, marked) in all {
        let error = described(kind, &[(from, to)]).expect_err(to);
        let place = error
            .place
            .clone()
            .unwrap_or_else(|| panic!("no place: {error}"));
        let found: String = place
            .text
            .chars()
            .skip(place.column - 1)
            .take(place.width)
            .collect();
        assert!(error.message.contains(reason), "{error}");
        assert!(found.starts_with(marked), "{found}: {error}");
    }
}

#[test]
fn gains_that_cannot_be_stable_are_warned_of_with_axis_and_gain() {
    let wild = experiment(
        "r3-multisine",
        &[(
            "gain_nms_per_rad = [1500.0, ",
            "gain_nms_per_rad = [1.0e6, ",
        )],
    );
    let warnings = wild.warnings();
    assert!(
        warnings.len() == 1 && warnings[0].contains("1000000"),
        "{warnings:?}"
    );
}

#[test]
fn a_description_that_was_written_out_stands_alone_and_is_the_same() {
    for kind in ["r3-chirp", "six-axis-multisine"] {
        let experiment = experiment(kind, &[]);
        let text = experiment.to_toml();
        let again = Experiment::new(
            TomlText {
                name: "again".into(),
                text,
            },
            "nowhere".as_ref(),
        )
        .expect("sound");
        assert_eq!(
            (again.config(), again.plan()),
            (experiment.config(), experiment.plan())
        );
    }
}
