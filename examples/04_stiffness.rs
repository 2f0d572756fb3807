//! Lesson 4: a stiffness that grows with deflection moves the resonance, the more the stronger the
//! excitation (SK15 section 6.3, figure 5).
//!
//! Run: cargo run --release --example 04_stiffness

use std::error::Error;
use std::fs;

use frfid::estimate::{CompareOptions, FrfOptions, Side, compare, estimate_bla, estimate_chirp};
use frfid::paper::Measured;
use frfid::plant::{Hold, Robot as _, SingleJoint, Torque, simulate};
use frfid::report::{Curve, Labels, Style, bode};
use frfid::signals::{Chirp, Draw, GridDesign, GridKind, Multisine, Phasing, Profile, log_spaced};
use ndarray::{Array5, Axis, concatenate, s};

const T: f64 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let hz = log_spaced(1.3, 55.0, 400)?;
    let soft = SingleJoint::default();
    let mut stiffening = soft.clone();
    stiffening.joint.spring.stiffness_beyond_nm_per_rad = 1.7 * 1.5e5;
    stiffening.joint.spring.knee_rad = 1e-3;
    let mut stiff = soft.clone();
    stiff.joint.spring.stiffness_nm_per_rad = 1.7 * 1.5e5;
    let resonance_hz = |frf, truth| {
        Measured { frf, truth }
            .peak(8.0..=55.0)
            .map_or(f64::NAN, |(hz, _)| hz)
    };
    for (name, joint) in [("k1", &soft), ("1.7 k1", &stiff)] {
        let truth = joint.frf(&hz, Hold::Zoh, T)?;
        println!(
            "linear truth with {name}: resonance at {:.1} Hz",
            resonance_hz(truth.clone(), truth)
        );
    }

    let amplitude = vec![Profile::constant(150.0)];
    let chirp = Chirp {
        low_hz: 1.0,
        high_hz: 60.0,
        duration_s: 20.0,
        amplitude,
        fade_s: 0.0,
        tail_s: 0.0,
    };
    let u = chirp.sample(T, 1, Phasing::SignFlip)?;
    let motion = simulate(
        &stiffening,
        Torque::Zoh(u.index_axis(Axis(0), 0)),
        T,
        0.0,
        None,
    )?;
    let u = u.insert_axis(Axis(0)); // (repeat, experiment, channel, sample)
    let y = motion
        .motor_velocity_rad_s
        .insert_axis(Axis(0))
        .insert_axis(Axis(0));
    let excerpts = estimate_chirp(
        u.view(),
        y.view(),
        None,
        &chirp,
        T,
        &hz,
        0.0,
        &FrfOptions::default(),
    )?;
    let truth = soft.frf(&hz, Hold::Zoh, T)?;
    println!(
        "chirp of 150 N m: resonance at {:.1} Hz",
        resonance_hz(excerpts.clone(), truth)
    );

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
    let n = multisine.grid.n_samples;
    let mut u = Array5::zeros((10, 1, 1, 1, n)); // (realization, experiment, period, channel, sample)
    let mut y = u.clone();
    for realization in 0..10 {
        let draw = Draw {
            seed: 1,
            realization,
            phasing: Phasing::Orthogonal,
        };
        let period = multisine.realize(&draw)?.signal.index_axis_move(Axis(0), 0);
        let torque = concatenate![Axis(1), period, period, period, period];
        let motion = simulate(&stiffening, Torque::Zoh(torque.view()), T, 0.0, None)?;
        u.slice_mut(s![realization, 0, 0, .., ..]).assign(&period);
        y.slice_mut(s![realization, 0, 0, .., ..])
            .assign(&motion.motor_velocity_rad_s.slice(s![.., 3 * n..]));
    }
    let bla = estimate_bla(
        u.view(),
        y.view(),
        None,
        T,
        &multisine.grid.excited,
        &FrfOptions::default(),
    )?;
    let truth = soft.frf(&bla.frequency_hz, Hold::Zoh, T)?;
    let away = Measured {
        frf: bla.clone(),
        truth,
    }
    .errors_db(1.0..=60.0)
    .into_iter()
    .fold(0.0, f64::max);
    println!(
        "multisine of 150 N m peak: within {away:.2} dB of the truth with k1, it hardly reaches the knee"
    );

    let options = CompareOptions {
        stronger: Some(Side::B),
        ..CompareOptions::default()
    };
    if let Some(judgement) = compare(&bla, &excerpts, &options)?.judgement {
        println!("{}", judgement.verdict);
    }

    let k1 = soft.frf(&hz, Hold::Zoh, T)?;
    let curves = [
        Curve::new("linear, k1", &k1, Style::Reference),
        Curve::new("multisine", &bla, Style::Markers),
        Curve::new("chirp", &excerpts, Style::Line),
    ];
    let figure = bode(&curves, 0, 0, &Labels::torque_to_velocity(1, 1))?;
    fs::write("04_stiffness.svg", figure.svg())?;
    println!("04_stiffness.svg: the multisine lies on k1, the resonance of the chirp is moved up");
    Ok(())
}
