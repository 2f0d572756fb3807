//! Lesson 9: in closed loop one asks for a velocity and wants a torque; iterative shaping finds the
//! reference (SK15 section 5.3).
//!
//! Run: cargo run --release --example 09_shaping

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use frfid::estimate::{ShapeOptions, Shaped, Step, shape};
use frfid::experiment::RobotTable;
use frfid::plant::{PiController, SimulatedRobot};
use frfid::signals::{Chirp, Limit, Phasing, Profile, SignalError};
use ndarray::Array3;

const T: f64 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let file = RobotTable::load(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/robots/manutec_r3.toml"),
    )?;
    let controller = PiController::new(vec![1500.0, 1500.0, 400.0], vec![12e3, 12e3, 3200.0]);
    let arm = file.robot()?;
    let testbed = SimulatedRobot {
        sensors: file.sensors(),
        ..SimulatedRobot::closed_loop(arm, Arc::new(controller), T)
    };
    let shaped_to = |amplitudes, step| -> Result<Shaped, Box<dyn Error>> {
        let options = ShapeOptions {
            step,
            coulomb_nm: Some(vec![42.0, 105.0, 42.0]),
            limits: [(Limit::Travel, vec![0.07; 3])].into_iter().collect(),
            ..ShapeOptions::default()
        };
        let start = chirps([0.006, 0.006, 0.012])?; // rad/s: friction holds every axis
        Ok(shape(
            &testbed,
            chirps(amplitudes)?,
            start,
            options,
            &mut |_| Ok(true),
        )?)
    };

    let shaped = shaped_to([200.0, 400.0, 200.0], Step::default())?; // N m
    for iteration in &shaped.iterations {
        let error = iteration
            .error
            .map_or("unknown".into(), |error| format!("{:.1} %", 100.0 * error));
        let stuck: Vec<String> = iteration
            .stuck_share
            .iter()
            .map(|share| format!("{:.0} %", 100.0 * share))
            .collect();
        println!(
            "iteration {}: error {error}, stuck {}",
            iteration.number,
            stuck.join(", ")
        );
    }
    println!(
        "{}; the best is iteration {}",
        shaped.stop, shaped.best.number
    );

    let paper = shaped_to([200.0, 400.0, 200.0], Step::Paper)?;
    let errors = paper
        .iterations
        .iter()
        .map(|iteration| iteration.error.map_or(f64::NAN, |error| 100.0 * error));
    let errors: Vec<String> = errors.map(|error| format!("{error:.0} %")).collect();
    println!("the paper's step without damping: {}", errors.join(", "));

    let weak = shaped_to([100.0, 150.0, 120.0], Step::default())?;
    println!("with table 1's torques instead:");
    weak.sticking
        .iter()
        .for_each(|sticking| println!("  {sticking}"));
    Ok(())
}

/// Each experiment with other signs, half the amplitude above 40 Hz; (experiment, channel, sample).
fn chirps(amplitudes: [f64; 3]) -> Result<Array3<f64>, SignalError> {
    let profile = |a: f64| Profile {
        points: vec![(2.0, a), (36.0, a), (44.0, a / 2.0), (60.0, a / 2.0)],
    };
    let chirp = Chirp {
        low_hz: 2.0,
        high_hz: 60.0,
        duration_s: 20.0,
        amplitude: amplitudes.map(profile).to_vec(),
        fade_s: 0.5,
        tail_s: 1.0,
    };
    chirp.sample(T, 3, Phasing::SignFlip)
}
