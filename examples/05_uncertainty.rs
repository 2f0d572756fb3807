//! Lesson 5: what is noise, what is nonlinear, and how sure one can be (SK15 section 4.3).
//!
//! Run: cargo run --release --example 05_uncertainty

use std::error::Error;
use std::fs;
use std::sync::Arc;

use frfid::estimate::{FrfOptions, estimate_bla};
use frfid::files::ResultFile;
use frfid::plant::{Sensor, SimulatedRobot, SingleJoint};
use frfid::report::result_figure;
use frfid::signals::{
    Draw, GridDesign, GridKind, Multisine, Phasing, Run, RunId, RunKind, Testbed as _,
};
use ndarray::{Array3, Array5, Axis, concatenate, s};

const T: f64 = 1e-3;
const N_REALIZATIONS: usize = 8;
const N_PERIODS: usize = 6;

fn main() -> Result<(), Box<dyn Error>> {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 20.0;
    let sensor = Sensor {
        velocity_noise_rad_s: Some(1e-4),
        ..Sensor::default()
    };
    let testbed = SimulatedRobot {
        sensors: vec![sensor],
        seed: 1,
        ..SimulatedRobot::open_loop(Arc::new(joint))
    };
    let (kind, seed) = (GridKind::Odd, 0);
    let design = GridDesign {
        low_hz: 1.0,
        high_hz: 60.0,
        sample_time_s: T,
        resolution_hz: 0.5,
        n_lines: Some(40),
        kind,
        seed,
    };
    let multisine = Multisine::flat(design.design()?, vec![300.0]);
    let n = multisine.grid.n_samples;

    // One period more than is used: the first one is the transient.
    let mut u = Array5::zeros((N_REALIZATIONS, 1, N_PERIODS, 1, n)); // (realization, experiment, period, channel, sample)
    let mut y = u.clone();
    for realization in 0..N_REALIZATIONS {
        let draw = Draw {
            seed: 1,
            realization,
            phasing: Phasing::Orthogonal,
        };
        let period = multisine.realize(&draw)?.signal.index_axis_move(Axis(0), 0);
        let id = RunId {
            kind: RunKind::Excitation,
            realization,
            experiment: 0,
            repetition: 0,
        };
        let reference = concatenate(Axis(1), &vec![period.view(); N_PERIODS + 1])?;
        let record = testbed.run(&Run {
            id,
            sample_time_s: T,
            reference,
            velocity_rad_s: vec![0.0],
            start_rad: vec![0.0],
        })?;
        for period in 0..N_PERIODS {
            let samples = s![.., (period + 1) * n..(period + 2) * n];
            u.slice_mut(s![realization, 0, period, .., ..])
                .assign(&record.u.slice(samples));
            y.slice_mut(s![realization, 0, period, .., ..])
                .assign(&record.y.slice(samples));
        }
    }
    let lines = &multisine.grid.excited;
    let frf = estimate_bla(u.view(), y.view(), None, T, lines, &FrfOptions::default())?;
    let level = |name: &str, variance: Option<Array3<f64>>| {
        let mut relative: Vec<f64> = variance
            .iter()
            .flatten()
            .zip(&frf.response)
            .map(|(v, g)| v / g.norm_sqr())
            .collect();
        relative.sort_by(f64::total_cmp);
        println!(
            "{name} variance: {:.0} dB of the response in the median",
            10.0 * relative[relative.len() / 2].log10()
        );
    };
    level("noise", frf.noise_variance());
    level("total", frf.total_variance());
    level("nonlinear", frf.nonlinear_variance());
    println!(
        "friction is not noise: it repeats from period to period, but not from realization to realization"
    );

    let first = s![.., .., ..1, .., ..];
    let single = estimate_bla(
        u.slice(first),
        y.slice(first),
        None,
        T,
        lines,
        &FrfOptions::default(),
    )?;
    println!(
        "with one period the noise variance is {:?}",
        single.noise_variance()
    );

    let result = ResultFile::torque_to_velocity(frf, &["joint 1".into()]);
    fs::write("05_uncertainty.svg", result_figure("G", &result)?.svg())?;
    println!("05_uncertainty.svg: the response, with its 95 % region");
    Ok(())
}
