//! Writes a small run and a small plan for readers that are not ours: `write_sample_run DIR` gives
//! DIR/run.mcap and DIR/plan.mcap. Every value is exact in binary and follows from `value` below,
//! so that a test can compute it again.

use std::error::Error;
use std::path::PathBuf;

use frfid_files::{BoxError, Overwrite, PlanHead, PlannedRun, RunFile, write_plan, write_run};
use frfid_signals::{Event, EventKind, Injection, InputKind, Record, Run, RunId, RunKind};
use ndarray::Array2;

const N: usize = 3000;

fn value(signal: usize, joint: usize, sample: usize) -> f64 {
    ((37 * sample + 11 * joint + 5 * signal) % 1000) as f64 / 64.0 - 5.0
}

fn signal(signal: usize) -> Array2<f64> {
    Array2::from_shape_fn((2, N), |(joint, sample)| value(signal, joint, sample))
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(
        std::env::args()
            .nth(1)
            .ok_or("give the folder to write to")?,
    );
    let id = RunId {
        kind: RunKind::Excitation,
        realization: 1,
        experiment: 0,
        repetition: 2,
    };
    let joint_names = vec!["shoulder".to_string(), "elbow".to_string()];
    let metadata = [("seed".to_string(), "42".to_string())];
    let experiment_toml = "[experiment]\nname = \"sample\"\n".to_string();
    let period = |period| Event {
        time_s: 1.5 * period as f64,
        kind: EventKind::PeriodStart { period },
    };
    let run = RunFile {
        joint_names: joint_names.clone(),
        run: id,
        injection: Injection::Velocity,
        record: Record {
            sample_time_s: 1e-3,
            u: signal(0),
            y: signal(1),
            r: Some(signal(2)),
            position_rad: Some(signal(3)),
            input_kind: InputKind::Commanded,
            events: vec![period(0), period(1)],
        },
        metadata: metadata.clone().into(),
        experiment_toml: experiment_toml.clone(),
    };
    write_run(&folder.join("run.mcap"), Overwrite::Replace, &run)?;
    let head = PlanHead {
        joint_names,
        sample_time_s: 1e-3,
        injection: Injection::Torque,
        lead_in_samples: 0,
        period_samples: N,
        n_periods: 1,
        metadata: metadata.into(),
        experiment_toml,
    };
    let planned = |realization| PlannedRun {
        run: Run {
            id: RunId {
                realization,
                repetition: 0,
                ..id
            },
            sample_time_s: 1e-3,
            reference: signal(10 + realization),
            velocity_rad_s: vec![0.25, 0.0],
            start_rad: vec![0.0, 0.0],
        },
        n_repetitions: 4,
    };
    write_plan(
        &folder.join("plan.mcap"),
        Overwrite::Replace,
        &head,
        (0..3).map(|p| Ok::<_, BoxError>(planned(p))),
    )?;
    Ok(())
}
