//! The paper's joint over one period of the multisine, from rest: `simulate`, linear, with
//! friction, with growing stiffness; and runs of it with friction, by RK4 and by exact steps, one and sixteen
//! side by side.

mod paper;

use std::f64::consts::TAU;
use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use frfid::plant::{Integration, SimulatedRobot, SingleJoint, Torque, simulate};
use frfid::signals::{Run, RunId};
use nalgebra::{Matrix5, Vector5};
use ndarray::Array2;
use paper::{PERIOD, SAMPLE_TIME_S};

/// The torque of tests/golden/friction_reference.py, largest sample 150 N m, `(1, sample)`.
fn torque() -> Array2<f64> {
    let table = include_str!("../tests/golden/friction_phases.txt")
        .lines()
        .filter(|line| !line.starts_with('#'));
    let sines: Vec<(usize, f64)> = table
        .filter_map(|row| row.split_once(' '))
        .map(|(line, phase)| {
            (
                line.parse().expect("a line"),
                phase.parse().expect("a phase"),
            )
        })
        .collect();
    let angle = |line: usize, n: usize| TAU * (line * n % PERIOD) as f64 / PERIOD as f64;
    let u = Array2::from_shape_fn((1, PERIOD), |(_, n)| {
        sines
            .iter()
            .map(|&(line, phase)| (angle(line, n) + phase).sin())
            .sum::<f64>()
    });
    let largest = u.iter().fold(0.0_f64, |peak, value| peak.max(value.abs()));
    u * (150.0 / largest)
}

/// Exact motor velocity of the linear joint: a matrix exponential from sample to sample.
fn linear_reference(u: &Array2<f64>) -> Vec<f64> {
    let joint = SingleJoint::default();
    let (motor, link) = (joint.joint.motor_inertia_kg_m2, joint.link_inertia_kg_m2);
    let (d, k) = (
        joint.joint.damping_nms_per_rad,
        joint.joint.spring.stiffness_nm_per_rad,
    );
    #[rustfmt::skip]
    let generator = Matrix5::new(
        0.0, 0.0, 1.0, 0.0, 0.0,
        0.0, 0.0, 1.0, -1.0, 0.0,
        0.0, -k / motor, -d / motor, d / motor, 1.0 / motor,
        0.0, k / link, d / link, -d / link, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0,
    );
    let step = (generator * SAMPLE_TIME_S).exp();
    let mut x = Vector5::zeros();
    let velocity = u.iter().map(|&torque| {
        let velocity = x[2];
        x[4] = torque;
        x = step * x;
        velocity
    });
    velocity.collect()
}

/// Motor velocity by Runge-Kutta steps of 5 us that look for no event: the knee then costs second
/// order, about 1e-9.
fn stiffening_reference(joint: &SingleJoint, u: &Array2<f64>) -> Vec<f64> {
    let (k1, k2, knee) = (
        joint.joint.spring.stiffness_nm_per_rad,
        joint.joint.spring.stiffness_beyond_nm_per_rad,
        joint.joint.spring.knee_rad,
    );
    let derivative = |[deflection, motor, link]: [f64; 3], torque: f64| {
        let within = deflection.clamp(-knee, knee);
        let transmitted = k1 * within
            + k2 * (deflection - within)
            + joint.joint.damping_nms_per_rad * (motor - link);
        [
            motor - link,
            (torque - transmitted) / joint.joint.motor_inertia_kg_m2,
            transmitted / joint.link_inertia_kg_m2,
        ]
    };
    let along = |x: [f64; 3], dx: [f64; 3], step: f64| std::array::from_fn(|i| x[i] + step * dx[i]);
    let steps = 200;
    let h = SAMPLE_TIME_S / f64::from(steps);
    let mut x = [0.0; 3];
    let velocity = u.iter().map(|&torque| {
        let velocity = x[1];
        for _ in 0..steps {
            let first = derivative(x, torque);
            let second = derivative(along(x, first, 0.5 * h), torque);
            let third = derivative(along(x, second, 0.5 * h), torque);
            let fourth = derivative(along(x, third, h), torque);
            x = std::array::from_fn(|i| {
                x[i] + h / 6.0 * (first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i])
            });
        }
        velocity
    });
    velocity.collect()
}

fn period(criterion: &mut Criterion) {
    let u = torque();
    let mut friction = SingleJoint::default();
    friction.joint.friction.coulomb_nm = 50.0;
    let mut stiffening = SingleJoint::default();
    stiffening.joint.spring.stiffness_beyond_nm_per_rad = 2.55e5;
    let golden = include_bytes!("../tests/golden/friction_50.f64").chunks_exact(8);
    let golden: Vec<f64> = golden
        .map(|bytes| f64::from_le_bytes(bytes.try_into().expect("eight bytes")))
        .collect();
    let cases = [
        ("linear", SingleJoint::default(), linear_reference(&u), 1e-9),
        ("friction F_c = 50 N m", friction, golden, 1e-6),
        (
            "stiffness k2 = 1.7 k1",
            stiffening.clone(),
            stiffening_reference(&stiffening, &u),
            1e-7,
        ),
    ];
    let mut group = criterion.benchmark_group("simulate, 12.288 s");
    for (name, joint, reference, tolerance) in cases {
        let run = || {
            simulate(
                black_box(&joint),
                Torque::Zoh(u.view()),
                SAMPLE_TIME_S,
                0.0,
                None,
            )
            .expect("sound")
        };
        let y = run().motor_velocity_rad_s;
        let peak = reference
            .iter()
            .fold(0.0_f64, |peak, value| peak.max(value.abs()));
        let error = y
            .iter()
            .zip(&reference)
            .map(|(y, r)| (y - r).abs())
            .fold(0.0, f64::max)
            / peak;
        assert!(
            y.len() == reference.len() && error < tolerance,
            "{name}: off by {error:e} of the peak"
        );
        group.bench_function(name, |bencher| bencher.iter(run));
    }
    group.finish();
}

/// Runs of the joint with friction, each with another multiple of the torque: what one takes alone, and what
/// one takes beside others.
fn runs(criterion: &mut Criterion) {
    let u = torque();
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    let robot = SimulatedRobot::open_loop(Arc::new(joint));
    let exact = SimulatedRobot {
        integration: Integration::Exact,
        ..robot.clone()
    };
    let run = |number: usize| Run {
        id: RunId::excitation(0, 0, number),
        sample_time_s: SAMPLE_TIME_S,
        reference: &u * (1.0 - 0.02 * number as f64),
        velocity_rad_s: vec![0.0],
        start_rad: vec![0.0],
    };
    let all: Vec<Run> = (0..16).map(run).collect();
    let mut group = criterion.benchmark_group("SimulatedRobot::simulate_each, 12.288 s");
    let kinds = [("", &robot), ("exact, ", &exact)];
    let cases = kinds.map(|kind| [(kind, &all[..1]), (kind, &all[..])]);
    for ((kind, robot), runs) in cases.concat() {
        let simulated = robot.simulate_each(runs, &|| true);
        for (run, simulated) in runs.iter().zip(&simulated) {
            assert_eq!(robot.simulate(run).ok().as_ref(), simulated.as_ref().ok());
        }
        let n_samples = runs.len() * PERIOD;
        group.throughput(Throughput::Elements(n_samples as u64));
        group.bench_function(format!("{kind}runs: {}", runs.len()), |bencher| {
            bencher.iter(|| robot.simulate_each(black_box(runs), &|| true));
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = paper::criterion(); targets = period, runs }
criterion_main!(benches);
