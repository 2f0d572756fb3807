//! Robots of several axes: runs of the Manutec r3 in closed loop with everything on, one and sixteen
//! side by side, RK4 steps, accelerations, one iteration of shaping.

#[allow(dead_code, reason = "this bench has multisines of its own")]
mod paper;

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use frfid::estimate::{LineDft, ShapeOptions, Shaper, Transform};
use frfid::experiment::{Experiment, RobotTable};
use frfid::plant::{Arm, Challenges, LoopFrf, Robot as _, SimulatedRobot};
use frfid::signals::random::{normal, stream};
use frfid::signals::{Chirp, Excitation, InputKind, Phasing, Profile, Record, Run, RunId, RunKind};
use nalgebra::DVector;
use ndarray::{Array2, Array3, Axis, s};
use paper::SAMPLE_TIME_S;

fn examples() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/examples"))
}

/// One run of the multisine on a constant velocity: friction, ripple, gravity, encoders, noise.
/// Criterion's elements are samples of 1 ms: a thousand of them a second is real time. The reading
/// must follow the reference as the linear loop says.
fn closed_loop(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("closed loop, everything on, 14.3 s");
    for (name, travel_rad) in [
        ("r3_multisine", &[0.136, 0.12, 0.128][..]),
        ("six_axis_multisine", &[0.135; 6]),
    ] {
        let experiment = strong(name, travel_rad);
        let testbed = experiment.testbed();
        let id = RunId {
            kind: RunKind::Excitation,
            realization: 0,
            experiment: 0,
            repetition: 0,
        };
        let run = experiment.plan().run(id).expect("sound");
        let work = || testbed.run(black_box(&run)).expect("stable");
        assert_follows(&experiment, &work());
        group.throughput(Throughput::Elements(run.reference.ncols() as u64));
        group.bench_function(name, |bencher| bencher.iter(work));
        let runs = runs(&run);
        assert_eq!(
            testbed.run_each(&runs, &|| true)[0].as_ref().ok(),
            Some(&work())
        );
        group.throughput(Throughput::Elements(
            (runs.len() * run.reference.ncols()) as u64,
        ));
        group.bench_function(format!("{name}, 16 runs side by side"), |bencher| {
            bencher.iter(|| testbed.run_each(black_box(&runs), &|| true));
        });
    }
    group.finish();
}

/// Sixteen of a run, each with noise of its own.
fn runs(run: &Run) -> Vec<Run> {
    let of = |repetition| Run {
        id: RunId {
            repetition,
            ..run.id
        },
        ..run.clone()
    };
    (0..16).map(of).collect()
}

/// RK4 steps of arms under gravity without friction, ripple and knees, for ten seconds under no other
/// torque than what holds them at first: one run, and sixteen side by side. Criterion's elements are
/// steps.
fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("RK4 steps, no friction");
    for name in ["manutec_r3", "six_axis"] {
        let mut arm = arm(name);
        arm.challenges = Challenges {
            coulomb_friction: Some(false),
            stiffening: Some(false),
            torque_ripple: Some(false),
            ..Challenges::default()
        };
        let (axes, step_s) = (arm.n_axes(), arm.default_step_s());
        let n_steps = (SAMPLE_TIME_S / step_s).ceil() as usize * 10_000;
        let robot = SimulatedRobot::open_loop(Arc::new(arm));
        let run = Run {
            id: RunId::excitation(0, 0, 0),
            sample_time_s: SAMPLE_TIME_S,
            reference: Array2::zeros((axes, 10_000)),
            velocity_rad_s: vec![0.1; axes],
            start_rad: vec![0.0; axes],
        };
        let all = runs(&run);
        for runs in [&all[..1], &all] {
            let simulated = robot.simulate_each(runs, &|| true);
            assert_eq!(
                simulated[0].as_ref().ok(),
                robot.simulate(&run).ok().as_ref()
            );
            group.throughput(Throughput::Elements((runs.len() * n_steps) as u64));
            group.bench_function(format!("{name}, runs: {}", runs.len()), |bencher| {
                bencher.iter(|| robot.simulate_each(black_box(runs), &|| true));
            });
        }
    }
    group.finish();
}

fn arm(name: &str) -> Arm {
    let table =
        RobotTable::load(&examples().join(format!("robots/{name}.toml"))).expect("an example");
    table.arm().expect("an arm")
}

/// The example at the strength and on the way of the paper, section 7: what is not linear is a small
/// part of what is measured.
fn strong(name: &str, travel_rad: &[f64]) -> Experiment {
    let path = examples().join(format!("experiments/{name}.toml"));
    let experiment = Experiment::load(&path).expect("an example");
    let changed = experiment.with(|config| {
        let multisine = config.multisine.as_mut().expect("a multisine");
        multisine.resolution_hz = 0.1;
        multisine.peak_of_velocity = Some(0.75);
        let velocity = config.constant_velocity.as_mut().expect("there");
        velocity.travel_rad = Some(travel_rad.to_vec());
        config.averaging.lead_in_s = Some(2.0);
    });
    changed.expect("sound")
}

/// Ripple, noise and the travelled way put a tenth (six axes: a sixth) beside the linear loop in a
/// single run, in the median.
fn assert_follows(experiment: &Experiment, record: &Record) {
    let Excitation::Multisine(signal) = &experiment.plan().excitation else {
        panic!("a multisine")
    };
    let controller = experiment.controller().expect("closed loop");
    let (robot, sensors) = (experiment.model().expect("a robot"), experiment.sensors());
    let linear = LoopFrf::new(
        &**robot,
        &**controller,
        SAMPLE_TIME_S,
        sensors,
        &signal.grid.lines_hz(),
    )
    .expect("stable");
    let dft = LineDft::new(signal.grid.n_samples, &signal.grid.excited).expect("sound");
    let last = s![.., record.n_samples() - signal.grid.n_samples..];
    let r = dft
        .transform("r", record.r.as_ref().expect("recorded").slice(last))
        .expect("finite");
    let y = dft.transform("y", record.y.slice(last)).expect("finite");
    let mut errors = Vec::new();
    for (line, response) in linear
        .reference_to_velocity
        .response
        .outer_iter()
        .enumerate()
    {
        let expected = response.dot(&r.column(line));
        errors.extend(
            expected
                .iter()
                .zip(y.column(line))
                .map(|(expected, y)| (y - expected).norm() / expected.norm()),
        );
    }
    errors.sort_by(f64::total_cmp);
    let median = errors[errors.len() / 2];
    assert!(
        record.stopped_at_s().is_none() && median < 0.25,
        "off by {median} from the linear loop"
    );
}

/// M^-1 (torque - C qo' - g) at a thousand random states; M times it and C qo' + g must give the
/// torque.
fn accelerations(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("link accelerations, 1000 states");
    for name in ["manutec_r3", "six_axis"] {
        let arm = arm(name);
        let mut rng = stream(1, "states of the bench", &[]);
        let mut vector = |size: f64| {
            (0..arm.n_axes())
                .map(|_| size * normal(&mut rng))
                .collect::<Vec<f64>>()
        };
        let states: Vec<[Vec<f64>; 3]> = (0..1000)
            .map(|_| [vector(1.0), vector(2.0), vector(500.0)])
            .collect();
        let work = || -> Vec<Vec<f64>> {
            states
                .iter()
                .map(|[q, qd, torque]| acceleration(&arm, q, qd, torque))
                .collect()
        };
        for ([q, qd, torque], found) in states.iter().zip(work()) {
            let inertial = arm.mass_matrix(q).expect("sound") * DVector::from_vec(found);
            let bias = arm.bias_nm(q, qd).expect("sound");
            let missing = torque
                .iter()
                .zip(&inertial)
                .zip(&bias)
                .map(|((t, m), b)| (t - m - b).abs());
            assert!(
                missing.fold(0.0, f64::max) < 1e-8,
                "{name}: torques do not balance"
            );
        }
        group.throughput(Throughput::Elements(1000));
        group.bench_function(format!("{name}, {} axes", arm.n_axes()), |bencher| {
            bencher.iter(work);
        });
    }
    group.finish();
}

fn acceleration(arm: &Arm, q: &[f64], qd: &[f64], torque: &[f64]) -> Vec<f64> {
    arm.link_acceleration(black_box(q), qd, torque)
        .expect("sound")
}

/// From three records of 22 s to the next references. On a machine whose torque is 500 times the
/// reference a step of 0.9 leaves a tenth of the error.
fn shaping(criterion: &mut Criterion) {
    let chirp = |amplitude: f64| {
        let amplitude = vec![Profile::constant(amplitude)];
        let chirp = Chirp {
            low_hz: 2.0,
            high_hz: 60.0,
            duration_s: 20.0,
            amplitude,
            fade_s: 0.2,
            tail_s: 2.0,
        };
        chirp
            .sample(SAMPLE_TIME_S, 3, Phasing::SignFlip)
            .expect("sound")
    };
    let gain = 500.0;
    let options = ShapeOptions {
        good_enough: 1e-9,
        ..ShapeOptions::default()
    };
    let shaper = Shaper::new(chirp(200.0), chirp(0.2), options).expect("sound");
    let answer = |reference: &Array3<f64>| {
        reference
            .axis_iter(Axis(0))
            .map(|r| record(gain, &r.to_owned()))
            .collect::<Vec<_>>()
    };
    let records = answer(shaper.reference());
    let mut tried = shaper.clone();
    let error = |shaper: &mut Shaper, records| {
        shaper
            .measured(records)
            .expect("it responds")
            .error()
            .expect("whole")
    };
    let first = error(&mut tried, records.clone());
    let next = answer(tried.reference());
    let second = error(&mut tried, next);
    assert!(
        (first - 0.5).abs() < 1e-6 && (second / first - 0.1).abs() < 0.02,
        "{first}, then {second}"
    );
    let mut group = criterion.benchmark_group("shaping");
    let setup = || (shaper.clone(), records.clone());
    group.bench_function("one iteration, 3 records x 3 axes x 22 s", |bencher| {
        bencher.iter_batched(
            setup,
            |(mut shaper, records)| {
                shaper.measured(records).expect("it responds");
                shaper
            },
            BatchSize::PerIteration,
        );
    });
    group.finish();
}

/// What a machine of that gain answers.
fn record(gain: f64, r: &Array2<f64>) -> Record {
    let position_rad = None;
    let (u, y) = (gain * r, r.clone());
    Record {
        sample_time_s: SAMPLE_TIME_S,
        u,
        y,
        r: Some(r.clone()),
        position_rad,
        input_kind: InputKind::Commanded,
        events: vec![],
    }
}

criterion_group! { name = benches; config = paper::criterion(); targets = closed_loop, steps, accelerations, shaping }
criterion_main!(benches);
