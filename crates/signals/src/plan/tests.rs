//! Plans: what each run injects, and what is refused.

use ndarray::{Axis, s};

use crate::error::SignalError;
use crate::excitation::{
    Chirp, Excitation, GridDesign, GridKind, Injection, Multisine, Phases, Phasing, Profile,
};
use crate::plan::Plan;
use crate::plan::run::{Run, RunId, RunKind};

fn plan() -> Plan {
    let design = GridDesign {
        low_hz: 1.0,
        high_hz: 60.0,
        sample_time_s: 1e-3,
        resolution_hz: 1.0,
        n_lines: Some(20),
        kind: GridKind::Odd,
        seed: 0,
    };
    let grid = design.design().expect("sound");
    let signal = Multisine {
        grid,
        shape: Profile::constant(1.0),
        phases: Phases::Random,
        peak: vec![1.0, 2.0],
    };
    Plan {
        seed: 3,
        sample_time_s: 1e-3,
        n_inputs: 2,
        excitation: Excitation::Multisine(signal),
        phasing: Phasing::Orthogonal,
        injection: Injection::Torque,
        n_realizations: 3,
        n_repetitions: 2,
        n_periods: 2,
        lead_in_samples: 100,
        ramp_samples: 0,
        velocity_rad_s: vec![0.0, 0.0],
        n_glides: 1,
    }
}

#[test]
fn a_run_is_its_period_continued_both_ways() {
    let (plan, n) = (plan(), plan().period_samples().expect("sound"));
    let id = RunId {
        kind: RunKind::Excitation,
        realization: 1,
        experiment: 1,
        repetition: 0,
    };
    let (run, period) = (
        plan.run(id).expect("in the plan"),
        plan.period(1).expect("sound"),
    );
    assert_eq!(run.reference.ncols(), 100 + 2 * n);
    for (k, column) in run.reference.axis_iter(Axis(1)).enumerate() {
        assert_eq!(column, period.slice(s![1, .., (k + n - 100) % n]));
    }
    let of_realization = |id: &RunId| id.kind == RunKind::Excitation && id.realization == 1;
    let ids: Vec<RunId> = plan.run_ids().filter(of_realization).collect();
    assert_eq!((ids.len(), plan.run(ids[2])), (4, Ok(run)));
    assert_eq!((plan.run_ids().count(), plan.n_runs()), (13, 13));
}

#[test]
fn a_chirp_rests_before_its_start_and_rides_on_the_velocity() {
    let chirp = Chirp {
        low_hz: 1.0,
        high_hz: 60.0,
        duration_s: 2.0,
        amplitude: vec![Profile::constant(0.1)],
        fade_s: 0.0,
        tail_s: 0.5,
    };
    let plan = Plan {
        excitation: Excitation::Chirp(chirp),
        injection: Injection::Velocity,
        n_realizations: 1,
        n_periods: 1,
        velocity_rad_s: vec![0.25, 0.0],
        ..plan()
    };
    let run = plan
        .run(RunId {
            kind: RunKind::Excitation,
            realization: 0,
            experiment: 0,
            repetition: 0,
        })
        .expect("in the plan");
    assert_eq!(run.reference.ncols(), 2600);
    assert!(run.reference.slice(s![0, ..101]).iter().all(|&r| r == 0.25));
    assert_eq!(run.reference[[1, 2599]], 0.0);
    let glide = plan
        .run(RunId {
            kind: RunKind::Glide,
            realization: 0,
            experiment: 0,
            repetition: 0,
        })
        .expect("in the plan");
    assert!(glide.reference.row(0).iter().all(|&r| r == 0.25));
}

#[test]
fn runs_and_numbers_that_do_not_fit_are_refused() {
    let missing = RunId {
        kind: RunKind::Excitation,
        realization: 3,
        experiment: 0,
        repetition: 0,
    };
    assert!(matches!(
        plan().run(missing),
        Err(SignalError::NoSuchRun { .. })
    ));
    let refused = |change: fn(&mut Plan)| {
        let mut bad = plan();
        change(&mut bad);
        let error = bad.check().expect_err("out of range");
        error.path().join(".")
    };
    assert_eq!(refused(|plan| plan.n_inputs = 1), "velocity_rad_s");
    assert_eq!(refused(|plan| plan.n_realizations = 0), "realizations");
    assert_eq!(
        refused(|plan| plan.n_realizations = usize::MAX),
        "realizations"
    );
    assert_eq!(refused(|plan| plan.n_periods = usize::MAX), "periods");
    assert_eq!(refused(|plan| plan.lead_in_samples = usize::MAX), "periods");
    assert_eq!(
        refused(|plan| plan.velocity_rad_s[0] = f64::NAN),
        "velocity_rad_s"
    );
}

#[test]
fn ramps_lead_from_rest_into_the_lead_in_and_from_the_last_period_to_rest() {
    let without = plan();
    let with = Plan {
        ramp_samples: 80,
        ..plan()
    };
    let id = RunId::excitation(0, 0, 0);
    let [plain, ramped] = [&without, &with].map(|plan| plan.run(id).expect("in the plan"));
    let end = plain.reference.ncols();
    assert_eq!(ramped.reference.ncols(), end + 80);
    let steady = s![.., 80..end];
    assert_eq!(
        ramped.reference.slice(steady),
        plain.reference.slice(steady)
    );
    // zero at both ends, half way in the middle of each ramp, and no steeper than in between
    for (k, of) in [(0, 0), (end + 79, 279)] {
        let factor = ramped.reference[[0, k]] / plain.reference[[0, of]];
        assert!(factor.abs() < 1e-15, "{factor}");
    }
    assert!((ramped.reference[[0, 40]] / plain.reference[[0, 40]] - 0.5).abs() < 1e-12);
    let rate = |run: &Run| run.steepest_per_s(Injection::Torque);
    let inside: f64 = {
        let row = plain.reference.row(0);
        let changes = (1..end).map(|k| (row[k] - row[k - 1]).abs() / 1e-3);
        changes.fold(0.0, f64::max)
    };
    assert!(rate(&ramped)[0] <= inside);
    assert!(rate(&plain)[0] >= plain.reference[[0, 0]].abs() / 1e-3);
    for (ramp_samples, fits) in [(100, true), (101, false)] {
        let plan = Plan {
            ramp_samples,
            ..plan()
        };
        assert_eq!(plan.check().is_ok(), fits);
    }
}
