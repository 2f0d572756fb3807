//! Lesson 6: a robot moves under its controller; the reference is a velocity, the torque is what
//! the controller makes of it.
//!
//! Run: cargo run --release --example 06_closed_loop

use std::error::Error;
use std::fs;
use std::sync::Arc;

use frfid::estimate::{Method, estimate_bla};
use frfid::plant::{Hold, PiController, Robot as _, Sensor, SimulatedRobot, SingleJoint};
use frfid::report::{Curve, Labels, Style, bode};
use frfid::signals::{
    Draw, GridDesign, GridKind, Multisine, Phasing, Run, RunId, RunKind, Testbed as _, power::rms,
};
use ndarray::{Array2, Array5, Axis, concatenate};

const T: f64 = 1e-3;
const N_PERIODS: usize = 50;

fn main() -> Result<(), Box<dyn Error>> {
    let joint = SingleJoint::default();
    let sensor = Sensor {
        torque_noise_nm: Some(200.0),
        ..Sensor::default()
    };
    let controller = PiController::new(vec![1500.0], vec![12_000.0]);
    let testbed = SimulatedRobot {
        sensors: vec![sensor],
        seed: 3,
        ..SimulatedRobot::closed_loop(Arc::new(joint.clone()), Arc::new(controller), T)
    };
    let (kind, seed) = (GridKind::Odd, 0);
    let design = GridDesign {
        low_hz: 2.0,
        high_hz: 60.0,
        sample_time_s: T,
        resolution_hz: 0.5,
        n_lines: Some(40),
        kind,
        seed,
    };
    let multisine = Multisine::flat(design.design()?, vec![0.05]);

    let draw = Draw {
        seed: 1,
        realization: 0,
        phasing: Phasing::Orthogonal,
    };
    let period = multisine.realize(&draw)?.signal.index_axis_move(Axis(0), 0);
    let reference = concatenate(Axis(1), &vec![period.view(); N_PERIODS + 2])?;
    let id = RunId {
        kind: RunKind::Excitation,
        realization: 0,
        experiment: 0,
        repetition: 0,
    };
    let record = testbed.run(&Run {
        id,
        sample_time_s: T,
        reference: reference.clone(),
        velocity_rad_s: vec![0.0],
        start_rad: vec![0.0],
    })?;
    let strength = rms(record.u.as_slice().unwrap_or_default());
    println!(
        "torque {strength:.0} N m rms, most of it noise on its reading: nearly as strong as the signal on each line"
    );

    // (realization, experiment, period, channel, sample), without the first two periods
    let n = period.ncols();
    let periods = |signal: &Array2<f64>| {
        Array5::from_shape_fn((1, 1, N_PERIODS, 1, n), |(_, _, period, _, k)| {
            signal[[0, (period + 2) * n + k]]
        })
    };
    let (u, y, r) = (periods(&record.u), periods(&record.y), periods(&reference));
    let lines = &multisine.grid.excited;
    let estimate = |method: Method| {
        let r = method.needs_reference().then(|| r.view());
        estimate_bla(u.view(), y.view(), r, T, lines, &method.into())
    };
    let estimates = [
        ("mean of FRFs", estimate(Method::MeanOfFrfs)?),
        ("mean of spectra", estimate(Method::MeanOfSpectra)?),
        ("indirect", estimate(Method::JointInputOutput)?),
    ];
    for (name, frf) in &estimates {
        let truth = joint.frf(&frf.frequency_hz, Hold::Zoh, T)?;
        let errors = frf
            .response
            .iter()
            .zip(&truth.response)
            .map(|(g, p)| 100.0 * (g / p - 1.0).norm());
        let mut errors: Vec<f64> = errors.collect();
        errors.sort_by(f64::total_cmp);
        let (median, worst) = (errors[errors.len() / 2], errors[errors.len() - 1]);
        println!("{name}: median error {median:.1} %, worst {worst:.0} %");
    }
    println!(
        "noise on the measured torque biases a mean of FRFs however many periods there are; averaged before the division, over"
    );
    println!("periods or against the known reference, it disappears");

    let [(name, biased), _, (other, indirect)] = &estimates;
    let truth = joint.frf(&biased.frequency_hz, Hold::Zoh, T)?;
    let curves = [
        Curve::new("truth", &truth, Style::Reference),
        Curve::new(*name, biased, Style::Markers),
        Curve::new(*other, indirect, Style::Markers),
    ];
    let figure = bode(&curves, 0, 0, &Labels::torque_to_velocity(1, 1))?;
    fs::write("06_closed_loop.svg", figure.svg())?;
    println!(
        "06_closed_loop.svg: the mean of FRFs lies far below the truth, the indirect estimate around it"
    );
    Ok(())
}
