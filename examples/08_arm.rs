//! Lesson 8: an arm has a matrix for an FRF, and another one at every pose (SK15 section 2; the
//! Manutec r3).
//!
//! Run: cargo run --release --example 08_arm

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use frfid::estimate::{FrfOptions, estimate_bla};
use frfid::experiment::RobotTable;
use frfid::plant::{Arm, Challenges, Hold, PiController, Robot as _, SimulatedRobot};
use frfid::signals::{
    Draw, GridDesign, GridKind, Multisine, Phasing, Run, RunId, RunKind, Testbed as _,
};
use ndarray::{Array5, Axis, concatenate};

const T: f64 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let file = RobotTable::load(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/robots/manutec_r3.toml"),
    )?;
    let arm = file.arm().ok_or("the file describes an arm")?;
    let degrees: Vec<f64> = arm.pose_rad.iter().map(|rad| rad.to_degrees()).collect();
    let gravity: Vec<f64> = arm
        .gravity_torque_nm(&arm.pose_rad)?
        .into_iter()
        .map(f64::abs)
        .collect();
    println!(
        "{} axes at ({}) deg; gravity asks for {} N m",
        arm.n_axes(),
        listed(&degrees, 0),
        listed(&gravity, 1)
    );
    print!("elastic modes at {} Hz, ", listed(&arm.modes_hz()?, 2));
    println!(
        "with the motors locked at {} Hz",
        listed(&arm.locked_motor_hz()?, 2)
    );

    let upright = Arm {
        pose_rad: vec![0.0; 3],
        ..arm.clone()
    };
    println!(
        "stretched upwards instead at {} Hz: stay within a few degrees",
        listed(&upright.modes_hz()?, 2)
    );

    let hz = [2.0, 10.0, 60.0];
    let truth = arm.frf(&hz, Hold::Zoh, T)?.response;
    let coupling =
        [0, 1, 2].map(|line| 20.0 * (truth[[line, 1, 2]] / truth[[line, 1, 1]]).norm().log10());
    let [a, b, c] = coupling.map(|db| format!("{db:+.0} dB"));
    println!("a torque on axis 3 moves axis 2 by {a}, {b}, {c} more than one on axis 2 does");
    let seen = arm
        .frf_through_sensors(&hz, Hold::Zoh, T, &file.sensors())?
        .response;
    let lag = -(seen[[2, 0, 0]] / truth[[2, 0, 0]]).arg().to_degrees();
    println!("velocities by differencing lag by {lag:.1} deg at 60 Hz");

    // A small excitation of an arm without friction, ripple and sensors under its controller finds
    // this matrix.
    let off = Some(false);
    let linear = Challenges {
        coulomb_friction: off,
        torque_ripple: off,
        sensing: off,
        ..file.challenges
    };
    let linear = RobotTable {
        challenges: linear,
        ..file
    }
    .arm()
    .ok_or("the file describes an arm")?;
    for peak in [1e-3, 1e-4] {
        let error = small_experiment(&linear, peak)?;
        println!(
            "references up to {} rad/s: the 3 x 3 FRF equals the truth to {error:.0e} of its peak",
            2.0 * peak
        );
    }
    Ok(())
}

/// Largest error of the BLA over the largest entry of the truth.
fn small_experiment(arm: &Arm, peak: f64) -> Result<f64, Box<dyn Error>> {
    let controller = PiController::new(vec![1500.0, 1500.0, 400.0], vec![12e3, 12e3, 3200.0]);
    let testbed = SimulatedRobot::closed_loop(Arc::new(arm.clone()), Arc::new(controller), T);
    let design = GridDesign {
        low_hz: 2.0,
        high_hz: 60.0,
        sample_time_s: T,
        resolution_hz: 0.5,
        n_lines: Some(40),
        kind: GridKind::Odd,
        seed: 0,
    };
    let multisine = Multisine::flat(design.design()?, vec![peak, peak, 2.0 * peak]);
    let draw = Draw {
        seed: 1,
        realization: 0,
        phasing: Phasing::Orthogonal,
    };
    let periods = multisine.realize(&draw)?.signal;
    let n = multisine.grid.n_samples;
    let [mut u, mut y] = [(); 2].map(|()| Array5::zeros((1, 3, 1, 3, n)));
    for (experiment, period) in periods.axis_iter(Axis(0)).enumerate() {
        let record = testbed.run(&Run {
            id: RunId {
                kind: RunKind::Excitation,
                realization: 0,
                experiment,
                repetition: 0,
            },
            sample_time_s: T,
            reference: concatenate(Axis(1), &[period; 3])?,
            velocity_rad_s: vec![0.0; 3],
            start_rad: vec![0.0; 3],
        })?;
        for ((axis, sample), _) in period.indexed_iter() {
            u[[0, experiment, 0, axis, sample]] = record.u[[axis, 2 * n + sample]];
            y[[0, experiment, 0, axis, sample]] = record.y[[axis, 2 * n + sample]];
        }
    }
    let frf = estimate_bla(
        u.view(),
        y.view(),
        None,
        T,
        &multisine.grid.excited,
        &FrfOptions::default(),
    )?;
    let truth = arm.frf(&frf.frequency_hz, Hold::Zoh, T)?.response;
    let error = (&frf.response - &truth)
        .iter()
        .map(|x| x.norm())
        .fold(0.0, f64::max);
    Ok(error / truth.iter().map(|x| x.norm()).fold(0.0, f64::max))
}

/// Numbers with commas between them.
fn listed(values: &[f64], decimals: usize) -> String {
    values
        .iter()
        .map(|value| format!("{value:.decimals$}"))
        .collect::<Vec<_>>()
        .join(", ")
}
