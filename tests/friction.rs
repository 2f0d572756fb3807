//! The simulated joint against references that are not frfid's: exact matrix exponentials between
//! events, and scipy's sampled transfer functions (tests/golden/friction_reference.py,
//! friction_free.py).

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::Arc;

use frfid::plant::{
    Hold, Integration, Robot as _, Sensor, SimulatedRobot, SingleJoint, Torque, Trajectory,
    simulate, simulate_robots,
};
use frfid::signals::{Run, RunId};
use ndarray::{Array2, s};
use num_complex::Complex64;

/// Samples of the paper's period: 12.288 s at 1 ms.
const PERIOD: usize = 12288;
const SAMPLE_TIME_S: f64 = 1e-3;

fn golden(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/golden")
        .join(name)
}

/// Rows of a golden table, split at blanks.
fn table(name: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(golden(name)).expect("the golden file is there");
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    rows.map(|row| row.split(' ').map(str::to_owned).collect())
        .collect()
}

fn number(text: &str) -> f64 {
    text.parse().expect("golden numbers are numbers")
}

/// Lines and phases of the multisine.
fn multisine() -> Vec<(usize, f64)> {
    table("friction_phases.txt")
        .iter()
        .map(|row| (number(&row[0]) as usize, number(&row[1])))
        .collect()
}

/// `periods` of the multisine, largest sample 150 N m, `(1, sample)`.
fn torque(periods: usize) -> Array2<f64> {
    let lines = multisine();
    let angle = |n: usize, line: usize| TAU * (n * line % PERIOD) as f64 / PERIOD as f64;
    let sample = |n: usize| {
        lines
            .iter()
            .map(|&(line, phase)| (angle(n, line) + phase).sin())
            .sum::<f64>()
    };
    let period: Vec<f64> = (0..PERIOD).map(sample).collect();
    let largest = period
        .iter()
        .fold(0.0_f64, |peak, value| peak.max(value.abs()));
    Array2::from_shape_fn((1, periods * PERIOD), |(_, n)| {
        period[n % PERIOD] * 150.0 / largest
    })
}

fn run(joint: &SingleJoint, max_step_s: Option<f64>) -> Trajectory {
    simulate(
        joint,
        Torque::Zoh(torque(1).view()),
        SAMPLE_TIME_S,
        0.0,
        max_step_s,
    )
    .expect("the joint is sound")
}

/// Largest difference of the simulated velocity from the reference over the period, relative to the
/// reference's peak.
fn error(trajectory: &Trajectory, case: &str) -> f64 {
    let bytes =
        std::fs::read(golden(&format!("friction_{case}.f64"))).expect("the golden file is there");
    let reference: Vec<f64> = bytes
        .chunks_exact(8)
        .map(|b| f64::from_le_bytes(b.try_into().expect("eight bytes")))
        .collect();
    assert_eq!(reference.len(), PERIOD);
    let peak = reference
        .iter()
        .fold(0.0_f64, |peak, value| peak.max(value.abs()));
    let differences = trajectory
        .motor_velocity_rad_s
        .row(0)
        .into_iter()
        .zip(reference)
        .map(|(y, r)| (y - r).abs());
    differences.fold(0.0, f64::max) / peak
}

/// The golden cases: F_c and spring, and the share of time stuck that the reference prints.
fn cases() -> [(&'static str, SingleJoint, f64); 3] {
    let with = |coulomb_nm| {
        let mut robot = SingleJoint::default();
        robot.joint.friction.coulomb_nm = coulomb_nm;
        robot
    };
    let mut knee = with(20.0);
    knee.joint.spring.stiffness_beyond_nm_per_rad = 2.55e5;
    knee.joint.spring.knee_rad = 2e-4;
    [
        ("50", with(50.0), 0.518_649),
        ("120", with(120.0), 0.993_554),
        ("knee", knee, 0.055_527),
    ]
}

#[test]
fn with_friction_every_sample_of_the_period_agrees_with_the_reference() {
    for (case, joint, stuck) in cases() {
        let trajectory = run(&joint, None);
        let error = error(&trajectory, case);
        println!(
            "{case}: {error:.2e} of the peak, stuck {:.4} %",
            100.0 * trajectory.stuck_share[0]
        );
        assert!(error < 1e-6, "{case}: {error}");
        // the last interval of the period is not simulated: there is no sample behind it
        assert!(
            (trajectory.stuck_share[0] - stuck).abs() < 2e-4,
            "{case}: {}",
            trajectory.stuck_share[0]
        );
    }
}

/// All cases at once, twice, side by side or each alone; the trajectories in the order of the cases.
fn each_case(integration: Integration, side_by_side: bool) -> Vec<Trajectory> {
    let robot = |(_, joint, _): (_, SingleJoint, _)| SimulatedRobot {
        integration,
        ..SimulatedRobot::open_loop(Arc::new(joint))
    };
    let robots: Vec<SimulatedRobot> = cases().into_iter().chain(cases()).map(robot).collect();
    let run = Run {
        id: RunId::excitation(0, 0, 0),
        sample_time_s: SAMPLE_TIME_S,
        reference: torque(1),
        velocity_rad_s: vec![0.0],
        start_rad: vec![0.0],
    };
    let simulated = if side_by_side {
        simulate_robots(robots.iter().map(|robot| (robot, &run)), &|| true)
    } else {
        robots.iter().map(|robot| robot.simulate(&run)).collect()
    };
    let truth = simulated.into_iter().map(|run| run.expect("sound").truth);
    truth.collect()
}

#[test]
fn every_path_agrees_with_the_reference_and_exact_steps_do_to_its_last_digits() {
    for (integration, tolerance) in [(Integration::Rk4, 1e-6), (Integration::Exact, 1e-12)] {
        let alone = each_case(integration, false);
        assert_eq!(each_case(integration, true), alone);
        for ((case, _, stuck), trajectory) in cases().into_iter().zip(&alone) {
            let (error, share) = (error(trajectory, case), trajectory.stuck_share[0]);
            println!("{integration:?}, {case}: {error:.2e} of the peak");
            assert!(error < tolerance, "{integration:?}, {case}: {error:e}");
            assert!((share - stuck).abs() < 2e-4, "{case}: {share}");
        }
    }
}

#[test]
fn the_error_falls_with_the_fourth_power_of_the_step_through_every_event() {
    for (case, joint, _) in cases() {
        let errors = [1e-3, 5e-4, 2.5e-4].map(|step_s| error(&run(&joint, Some(step_s)), case));
        let ratios = [errors[0] / errors[1], errors[1] / errors[2]];
        println!("{case}: {errors:?}, ratios {ratios:?}");
        assert!(
            ratios.iter().all(|ratio| (12.0..20.0).contains(ratio)),
            "{case}: {errors:?}, {ratios:?}"
        );
    }
}

/// DFT at one line of the last period.
fn dft(x: &Array2<f64>, line: usize) -> Complex64 {
    let last = x.slice(s![0, x.ncols() - PERIOD..]);
    let turn = |n: usize| Complex64::cis(-TAU * (n * line % PERIOD) as f64 / PERIOD as f64);
    last.iter()
        .enumerate()
        .map(|(n, &value)| value * turn(n))
        .sum()
}

#[test]
fn without_friction_a_steady_period_gives_the_truth_and_a_sample_s_shift_does_not() {
    let joint = SingleJoint::default();
    let u = torque(2);
    let y = simulate(&joint, Torque::Zoh(u.view()), SAMPLE_TIME_S, 0.0, None)
        .expect("sound")
        .motor_velocity_rad_s;
    let late = Array2::from_shape_fn(y.dim(), |(_, n)| y[[0, n.saturating_sub(1)]]);
    for (line, _) in multisine() {
        let hz = line as f64 / (PERIOD as f64 * SAMPLE_TIME_S);
        let truth = joint
            .frf(&[hz], Hold::Zoh, SAMPLE_TIME_S)
            .expect("sound")
            .response[[0, 0, 0]];
        let found = dft(&y, line) / dft(&u, line);
        assert!(
            (found / truth - 1.0).norm() < 1e-9,
            "{hz} Hz: {}",
            (found / truth - 1.0).norm()
        );
        let turn = (dft(&late, line) / dft(&u, line) / truth)
            .arg()
            .to_degrees();
        assert!(
            (turn + 360.0 * hz * SAMPLE_TIME_S).abs() < 1e-6,
            "{hz} Hz: {turn} deg"
        );
    }
}

#[test]
fn the_linear_truth_is_scipy_s_under_every_hold() {
    for row in table("friction_free.txt") {
        let hold = match row[0].as_str() {
            "continuous" => Hold::Continuous,
            "zoh" => Hold::Zoh,
            _ => Hold::Linear,
        };
        let numbers: Vec<f64> = row[1..].iter().map(|text| number(text)).collect();
        let mut joint = SingleJoint::default();
        joint.joint.friction.viscous_nms_per_rad = numbers[0];
        let hz = numbers[1];
        for (differenced, value) in [false, true].into_iter().zip(numbers[2..].chunks(2)) {
            let sensor = Sensor {
                velocity_by_differencing: differenced,
                ..Sensor::default()
            };
            let found = joint
                .frf_through_sensors(&[hz], hold, SAMPLE_TIME_S, &[sensor])
                .expect("sound")
                .response[[0, 0, 0]];
            let error = (found / Complex64::new(value[0], value[1]) - 1.0).norm();
            assert!(
                error < 1e-12,
                "{hold:?}, differenced: {differenced}, {hz} Hz: {error}"
            );
        }
    }
}
