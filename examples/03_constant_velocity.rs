//! Lesson 3: riding on a constant velocity, the joint never sticks and friction is a constant
//! torque (SK15 section 6.2).
//!
//! Run: cargo run --release --example 03_constant_velocity

use std::error::Error;
use std::sync::Arc;

use frfid::estimate::{FrfOptions, estimate_bla};
use frfid::paper::Measured;
use frfid::plant::{Hold, Robot as _, SimulatedRobot, SingleJoint};
use frfid::signals::{
    Draw, GridDesign, GridKind, Multisine, Phasing, Run, RunId, RunKind, Testbed as _,
};
use ndarray::{Axis, concatenate, s};

const T: f64 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    let testbed = SimulatedRobot::open_loop(Arc::new(joint.clone()));
    let (kind, seed) = (GridKind::Odd, 0);
    let design = GridDesign {
        low_hz: 1.0,
        high_hz: 60.0,
        sample_time_s: T,
        resolution_hz: 0.1,
        n_lines: Some(80),
        kind,
        seed,
    };
    let multisine = Multisine::flat(design.design()?, vec![150.0]);
    let draw = Draw {
        seed: 1,
        realization: 0,
        phasing: Phasing::Orthogonal,
    };
    let period = multisine.realize(&draw)?.signal.index_axis_move(Axis(0), 0);
    let reference = concatenate![Axis(1), period, period, period, period];

    for velocity in [0.25, 0.011] {
        // the testbed starts at this velocity and adds the torque that holds it against friction
        let id = RunId {
            kind: RunKind::Excitation,
            realization: 0,
            experiment: 0,
            repetition: 0,
        };
        let reference = reference.clone();
        let record = testbed.run(&Run {
            id,
            sample_time_s: T,
            reference,
            velocity_rad_s: vec![velocity],
            start_rad: vec![0.0],
        })?;
        // the last period, once the start has died out: (realization, experiment, period, channel,
        // sample)
        let last = s![
            ndarray::NewAxis,
            ndarray::NewAxis,
            ndarray::NewAxis,
            ..,
            -(period.ncols() as isize)..
        ];
        let (u, y) = (record.u.slice(last), record.y.slice(last));
        let frf = estimate_bla(
            u,
            y,
            None,
            T,
            &multisine.grid.excited,
            &FrfOptions::default(),
        )?;
        let truth = joint.frf(&frf.frequency_hz, Hold::Zoh, T)?;
        let worst = Measured { frf, truth }.worst_relative_error();
        let slowest = record.y.iter().copied().fold(f64::INFINITY, f64::min);
        println!(
            "v = {velocity} rad/s: slowest {slowest:+.3} rad/s, largest error of the FRF {worst:.1e}"
        );
    }
    println!(
        "the smallest velocity decides: once it changes sign, the joint sticks and the FRF is wrong"
    );
    Ok(())
}
