//! Tests of plans: bit for bit when all is well, refused when not.

use frfid_signals::{Injection, Run, RunId, RunKind};
use ndarray::Array2;

use crate::atomic_write::{BoxError, Overwrite};
use crate::plan::write::{write_plan, write_to};
use crate::plan::{PlanFile, PlanHead, PlannedRun};

fn head() -> PlanHead {
    PlanHead {
        joint_names: vec!["a".into(), "b".into()],
        sample_time_s: 1e-3,
        injection: Injection::Velocity,
        lead_in_samples: 100,
        period_samples: 1000,
        n_periods: 2,
        metadata: [("seed".to_string(), "7".to_string())].into(),
        experiment_toml: "[plan]\n".into(),
    }
}

fn planned(realization: usize, experiment: usize) -> PlannedRun {
    let id = RunId {
        kind: RunKind::Excitation,
        realization,
        experiment,
        repetition: 0,
    };
    let reference = Array2::from_shape_fn((2, 2100), |(row, k)| {
        ((realization * 7 + experiment * 3 + row) as f64 + 0.1 * k as f64).sin() / 3.0
    });
    let run = Run {
        id,
        sample_time_s: 1e-3,
        reference,
        velocity_rad_s: vec![0.1 + 0.2, 0.0],
        start_rad: vec![-0.1, 0.0],
    };
    PlannedRun {
        run,
        n_repetitions: 3,
    }
}

fn runs() -> impl Iterator<Item = Result<PlannedRun, BoxError>> {
    (0..4).flat_map(|p| (0..2).map(move |m| Ok(planned(p, m))))
}

fn bytes() -> Vec<u8> {
    let mut file = Vec::new();
    write_to(&mut file, &head(), runs()).expect("memory does not fail");
    file
}

#[test]
fn a_plan_comes_back_bit_for_bit_run_by_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("plan.mcap");
    write_plan(&path, Overwrite::Refuse, &head(), runs()).expect("sound");
    let plan = PlanFile::open(&path).expect("sound");
    assert_eq!(
        (&plan.head, plan.runs.len(), plan.run_ids().count()),
        (&head(), 8, 24)
    );
    for (id, repetition) in plan.run_ids().zip([0, 1, 2].into_iter().cycle()) {
        let expected = planned(id.realization, id.experiment).run;
        let found = plan.run(id).expect("sound");
        assert_eq!((found.id, id.repetition), (id, repetition));
        assert_eq!(
            Run {
                id: expected.id,
                ..found
            },
            expected
        );
    }
    let missing = RunId {
        repetition: 3,
        ..plan.runs[0].id
    };
    assert!(
        plan.run(missing)
            .expect_err("three repetitions")
            .to_string()
            .contains("no p000-m0-q3")
    );
    assert_eq!(bytes(), std::fs::read(&path).expect("written"));
}

#[test]
fn a_damaged_plan_never_gives_a_wrong_reference() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("plan.mcap");
    let whole = bytes();
    for k in 0..60 {
        let mut file = whole.clone();
        let at = k * (whole.len() / 60);
        if k % 2 == 0 {
            file.truncate(at);
        } else {
            file[at] ^= 16;
        }
        std::fs::write(&path, file).expect("written");
        let Ok(plan) = PlanFile::open(&path) else {
            continue;
        };
        for id in plan.run_ids() {
            let Ok(run) = plan.run(id) else { continue };
            assert_eq!(
                run.reference,
                planned(id.realization, id.experiment).run.reference,
                "byte {at}"
            );
        }
    }
}

#[test]
fn runs_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut wrong = planned(0, 0);
    wrong.run.reference[[0, 3]] = f64::NAN;
    let mut narrow = planned(0, 0);
    narrow.run.velocity_rad_s.pop();
    for (k, bad) in [wrong, narrow].into_iter().enumerate() {
        let path = folder.path().join(format!("{k}.mcap"));
        let error = write_plan(&path, Overwrite::Refuse, &head(), [Ok::<_, BoxError>(bad)])
            .expect_err("refused")
            .to_string();
        assert!(
            error.contains("run p000-m0-q0") && !path.exists(),
            "{error}"
        );
    }
}
