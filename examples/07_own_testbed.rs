//! Lesson 7: the whole workflow from one description, on a machine of your own.
//!
//! Run: cargo run --release --example 07_own_testbed

use std::error::Error;
use std::fs;
use std::path::Path;

use frfid::experiment::{Experiment, predict, silent};
use frfid::plant::{SingleJoint, Torque, simulate};
use frfid::report::result_figure;
use frfid::signals::{InputKind, Limit, Record, Run, Testbed, TestbedError};

/// Anything with `run(&Run) -> Record`. Here it is a simulation; a driver of a real robot
/// looks the same.
struct MyRobot {
    joint: SingleJoint,
}

impl Testbed for MyRobot {
    fn n_inputs(&self) -> usize {
        1
    }

    fn run(&self, run: &Run) -> Result<Record, TestbedError> {
        let u = run.reference.clone();
        let motion = simulate(
            &self.joint,
            Torque::Zoh(u.view()),
            run.sample_time_s,
            0.0,
            None,
        );
        let motion = motion.map_err(|error| TestbedError::Foreign {
            run: run.id,
            source: Box::new(error),
        })?;
        Ok(Record {
            sample_time_s: run.sample_time_s,
            u,
            y: motion.motor_velocity_rad_s,
            r: Some(run.reference.clone()),
            position_rad: None,
            input_kind: InputKind::Commanded,
            events: Vec::new(),
        })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/experiments/multisine.toml");
    let experiment = Experiment::load(&path)?;
    let plan = experiment.plan();
    let first = plan.run_ids().next().ok_or("the plan has a run")?;
    println!(
        "{} runs, {:.1} s on the robot, the first of them {first}, reference {:?} (channel, sample)",
        plan.n_runs(),
        plan.robot_time_s()?,
        plan.run(first)?.reference.dim()
    );
    let peaks = predict(&experiment, 0, &silent)?.load.peaks;
    let peak = |limit| peaks.get(limit).map_or(f64::NAN, |peaks| peaks[0]);
    println!(
        "predicted peaks: {:.0} N m, {:.3} rad/s",
        peak(Limit::Torque),
        peak(Limit::Velocity)
    );

    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    let outcome = experiment.measure(&MyRobot { joint }, 0, &silent)?;
    for warning in &outcome.warnings {
        println!("warned: {warning}");
    }
    let frf = &outcome.result.frf;
    let hz = &frf.frequency_hz;
    println!(
        "FRF at {} frequencies from {:.4} Hz to {:.4} Hz",
        hz.len(),
        hz[0],
        hz[hz.len() - 1]
    );
    println!(
        "noise variance measured: {}, total variance measured: {}",
        frf.noise.is_some(),
        frf.total.is_some()
    );
    let provenance = experiment.provenance();
    println!(
        "made with seed {} from the description with the hash {:.12}",
        provenance["seed"], provenance["config_sha256"]
    );

    let described = experiment.testbed(); // the simulated robot
    let same = experiment.measure(&*described, 0, &silent)?.result.frf;
    println!(
        "the simulated robot gives the same FRF to the last bit: {}",
        same.response == frf.response
    );
    let figure = result_figure("G", &outcome.result)?;
    fs::write("07_own_testbed.svg", figure.svg())?;
    println!("07_own_testbed.svg: its Bode diagram, with the 95 % region");
    Ok(())
}
