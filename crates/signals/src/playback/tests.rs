//! Tests of playbacks: rest to rest, consistent, inside the limits, equal to the plan in between.

use ndarray::{ArrayView1, s};

use super::*;
use crate::excitation::{Chirp, Excitation, GridDesign, GridKind, Multisine, Phasing, Profile};
use crate::number::random::{stream, uniform};

const POSE_RAD: [f64; 2] = [0.3, -1.0];

fn plan(excitation: Excitation, velocity_rad_s: f64) -> Plan {
    let is_chirp = matches!(excitation, Excitation::Chirp(_));
    Plan {
        seed: 3,
        sample_time_s: 1e-3,
        n_inputs: 2,
        excitation,
        phasing: if is_chirp {
            Phasing::SignFlip
        } else {
            Phasing::Orthogonal
        },
        injection: Injection::Velocity,
        n_realizations: 1,
        n_repetitions: 1,
        n_periods: if is_chirp { 1 } else { 2 },
        lead_in_samples: 700,
        ramp_samples: 0,
        velocity_rad_s: vec![velocity_rad_s, -0.5 * velocity_rad_s],
        n_glides: 1,
    }
}

fn multisine(velocity_rad_s: f64) -> Plan {
    let design = GridDesign {
        low_hz: 2.0,
        high_hz: 60.0,
        sample_time_s: 1e-3,
        resolution_hz: 0.5,
        n_lines: Some(20),
        kind: GridKind::Odd,
        seed: 0,
    };
    let signal = Multisine::flat(design.design().expect("sound"), vec![0.04, 0.02]);
    plan(Excitation::Multisine(signal), velocity_rad_s)
}

fn ramped() -> Plan {
    Plan {
        ramp_samples: 600,
        ..multisine(0.06)
    }
}

fn chirp() -> Plan {
    let signal = Chirp {
        low_hz: 2.0,
        high_hz: 50.0,
        duration_s: 4.0,
        amplitude: vec![Profile::constant(0.03)],
        fade_s: 0.1,
        tail_s: 0.5,
    };
    plan(Excitation::Chirp(signal), 0.0)
}

fn player(rate_hz: f64) -> Player {
    Player {
        rate_hz,
        rest_s: 0.25,
        pose_rad: POSE_RAD.to_vec(),
        limits: Limits::default(),
    }
}

fn motion(playback: &Playback) -> &Motion {
    match &playback.played {
        Played::Motion(motion) => motion,
        Played::Torque(_) => panic!("a motion"),
    }
}

fn first_run(plan: &Plan) -> Run {
    plan.run(RunId::excitation(0, 0, 0)).expect("in the plan")
}

/// Largest difference between the positions and the integral of the velocities, by the rule of two
/// points with three derivatives, whose error is of order 7 in the step.
fn inconsistency(motion: &Motion, h: f64) -> f64 {
    let step = |row: ArrayView1<f64>, weights: [f64; 2], scale: f64| -> Vec<f64> {
        let pairs = row.iter().zip(row.iter().skip(1));
        pairs
            .map(|(a, b)| scale * (weights[0] * a + weights[1] * b))
            .collect()
    };
    let rows = 0..motion.position_rad.nrows();
    let of_row = |row: usize| {
        let way = step(motion.position_rad.row(row), [-1.0, 1.0], 1.0);
        let by_v = step(motion.velocity_rad_s.row(row), [1.0, 1.0], h / 2.0);
        let by_a = step(
            motion.acceleration_rad_s2.row(row),
            [1.0, -1.0],
            h * h / 10.0,
        );
        let by_j = step(motion.jerk_rad_s3.row(row), [1.0, 1.0], h * h * h / 120.0);
        let mut sum = 0.0;
        let errors = (0..way.len()).map(|k| {
            sum += way[k] - by_v[k] - by_a[k] - by_j[k];
            f64::abs(sum)
        });
        errors.fold(0.0, f64::max)
    };
    rows.map(of_row).fold(0.0, f64::max)
}

#[test]
fn a_playback_holds_the_run_sample_by_sample() {
    for plan in [multisine(0.0), multisine(0.06), ramped(), chirp()] {
        let run = first_run(&plan);
        let playback = plan.playback(&run, &player(1000.0)).expect("sound");
        let motion = motion(&playback);
        let n = playback.run_samples;
        assert_eq!(n, run.reference.ncols());
        let first = playback.first_sample;
        let played = motion.velocity_rad_s.slice(s![.., first..first + n]);
        let error = (&played - &run.reference)
            .iter()
            .fold(0.0, |e: f64, x| e.max(x.abs()));
        assert!(error < 1e-13, "{error}");
        for (channel, pose) in POSE_RAD.iter().enumerate() {
            let start = motion.position_rad[[channel, first]];
            assert!((start - pose - run.start_rad[channel]).abs() < 1e-14);
        }
    }
}

#[test]
fn it_rests_at_the_pose_at_both_ends() {
    for plan in [multisine(0.06), chirp()] {
        let playback = plan
            .playback(&first_run(&plan), &player(500.0))
            .expect("sound");
        let motion = motion(&playback);
        let rest = (0.25 * 500.0) as usize;
        let n = playback.n_samples();
        for k in (0..rest).chain(n - rest..n) {
            for (channel, pose) in POSE_RAD.iter().enumerate() {
                assert!((motion.position_rad[[channel, k]] - pose).abs() < 1e-12);
                assert_eq!(motion.velocity_rad_s[[channel, k]], 0.0);
                assert_eq!(motion.acceleration_rad_s2[[channel, k]], 0.0);
            }
        }
    }
}

#[test]
fn its_derivatives_belong_to_each_other_at_every_rate() {
    for plan in [multisine(0.06), chirp()] {
        for rate_hz in [4000.0, 2718.28] {
            let playback = plan
                .playback(&first_run(&plan), &player(rate_hz))
                .expect("sound");
            let error = inconsistency(motion(&playback), playback.sample_time_s);
            assert!(error < 1e-9, "{error} at {rate_hz} Hz");
        }
    }
}

/// A random design with random limits about what it needs.
fn random_design(number: u64) -> (Plan, Player) {
    let mut random = stream(5, "random designs", &[number]);
    let mut around = |value: f64| value * (0.5 + uniform(&mut random));
    let mut plan = if number.is_multiple_of(3) {
        chirp()
    } else {
        multisine(around(0.06))
    };
    plan.seed = number;
    let mut player = player(around(600.0).round());
    for (limit, value) in [
        (Limit::Velocity, 0.25),
        (Limit::Acceleration, 12.0),
        (Limit::Jerk, 4000.0),
        (Limit::Travel, 0.3),
    ] {
        player.limits.set(limit, vec![around(value), around(value)]);
    }
    (plan, player)
}

#[test]
fn two_hundred_random_designs_keep_their_limits_or_say_so() {
    let mut n_kept = 0;
    for number in 0..200 {
        let (plan, player) = random_design(number);
        let playback = plan.playback(&first_run(&plan), &player).expect("sound");
        let (motion, exceeded) = (motion(&playback), playback.excesses(&player));
        let ways = &motion.position_rad - &ndarray::arr2(&[[POSE_RAD[0]], [POSE_RAD[1]]]);
        for (limit, signal) in [
            (Limit::Velocity, &motion.velocity_rad_s),
            (Limit::Acceleration, &motion.acceleration_rad_s2),
            (Limit::Jerk, &motion.jerk_rad_s3),
            (Limit::Travel, &ways),
        ] {
            for (axis, row) in signal.rows().into_iter().enumerate() {
                let allowed = player.limits.of(limit, axis) * (1.0 + 1e-9);
                let is_said = exceeded
                    .iter()
                    .any(|excess| (excess.limit, excess.axis) == (limit, axis));
                assert_eq!(row.iter().any(|value| value.abs() > allowed), is_said);
            }
        }
        n_kept += usize::from(exceeded.is_empty());
    }
    assert!((50..150).contains(&n_kept), "{n_kept}");
}

#[test]
fn a_torque_has_ramps_only() {
    let mut plan = multisine(0.0);
    plan.injection = Injection::Torque;
    let run = first_run(&plan);
    let playback = plan.playback(&run, &player(1000.0)).expect("sound");
    let Played::Torque(torque) = &playback.played else {
        panic!("a torque")
    };
    let first = playback.first_sample;
    let played = torque.slice(s![.., first..first + playback.run_samples]);
    assert!(
        (&played - &run.reference)
            .iter()
            .all(|error| error.abs() < 1e-12)
    );
    assert_eq!(
        (torque[[0, 0]], torque[[1, torque.ncols() - 1]]),
        (0.0, 0.0)
    );
}

#[test]
fn what_no_player_can_play_is_refused() {
    let slow = multisine(0.06).playback(&first_run(&multisine(0.06)), &player(100.0));
    assert!(
        slow.expect_err("too slow")
            .to_string()
            .contains("at least 150")
    );
    let mut plan = multisine(0.06);
    plan.injection = Injection::Torque;
    let held = plan.playback(&first_run(&plan), &player(500.0));
    assert!(
        held.expect_err("a torque")
            .to_string()
            .contains("velocity loop")
    );
    let long = chirp().playback(&first_run(&multisine(0.0)), &player(500.0));
    assert!(matches!(
        long,
        Err(SignalError::Shape {
            name: "reference",
            ..
        })
    ));
}
