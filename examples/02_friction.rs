//! Lesson 2: Coulomb friction hides a resonance when the excitation is weak (SK15 section 6.2,
//! figure 4).
//!
//! The joint sticks while the torque is too small; the chirp is stronger than the multisine and
//! sees more of the resonance.
//!
//! Run: cargo run --release --example 02_friction

use std::error::Error;
use std::fs;

use frfid::estimate::{FrfOptions, estimate_bla, estimate_chirp};
use frfid::paper::Measured;
use frfid::plant::{Hold, Robot as _, SingleJoint, Torque, Trajectory, simulate};
use frfid::report::{Band, Curve, Labels, Style, bode};
use frfid::signals::{
    Chirp, Draw, Frf, GridDesign, GridKind, Multisine, Phasing, Profile, log_spaced, power::rms,
};
use ndarray::{Array5, Axis, concatenate, s};

const T: f64 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
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
    let amplitude = vec![Profile::constant(150.0)];
    let chirp = Chirp {
        low_hz: 1.0,
        high_hz: 60.0,
        duration_s: 20.0,
        amplitude,
        fade_s: 0.0,
        tail_s: 0.0,
    };

    // Ten realizations; the first period is the transient, the second one is used.
    let n = multisine.grid.n_samples;
    let mut u = Array5::zeros((10, 1, 1, 1, n)); // (realization, experiment, period, channel, sample)
    let (mut y, mut stuck) = (u.clone(), 0.0);
    for realization in 0..10 {
        let draw = Draw {
            seed: 1,
            realization,
            phasing: Phasing::Orthogonal,
        };
        let period = multisine.realize(&draw)?.signal.index_axis_move(Axis(0), 0);
        let twice = concatenate![Axis(1), period, period];
        let motion = simulate(&joint, Torque::Zoh(twice.view()), T, 0.0, None)?;
        stuck += at_rest(&motion) / 10.0;
        u.slice_mut(s![realization, 0, 0, .., ..]).assign(&period);
        y.slice_mut(s![realization, 0, 0, .., ..])
            .assign(&motion.motor_velocity_rad_s.slice(s![.., n..]));
    }
    let strength = rms(u.as_slice().unwrap_or_default());
    println!(
        "multisine: rms torque {strength:.0} N m against 50 N m of friction, stuck {:.0}% of the time",
        100.0 * stuck
    );
    let lines = &multisine.grid.excited;
    let multisine = estimate_bla(u.view(), y.view(), None, T, lines, &FrfOptions::default())?;

    let u = chirp.sample(T, 1, Phasing::SignFlip)?;
    let motion = simulate(&joint, Torque::Zoh(u.index_axis(Axis(0), 0)), T, 0.0, None)?;
    let strength = rms(u.as_slice().unwrap_or_default());
    println!(
        "chirp: rms torque {strength:.0} N m, stuck {:.0}% of the time",
        100.0 * at_rest(&motion)
    );
    let hz = log_spaced(1.3, 55.0, 200)?;
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

    let known = multisine.total.is_some();
    for (name, frf) in [("multisine", &multisine), ("chirp", &excerpts)] {
        println!(
            "{name}: the peak at the resonance lies {:.1} dB below the truth",
            lost_db(&joint, frf.clone())?
        );
    }
    println!("the multisine's total variance says that something nonlinear is at work: {known}");

    let truth = joint.frf(&hz, Hold::Zoh, T)?;
    let curves = [
        Curve::new("without friction", &truth, Style::Reference),
        Curve {
            band: Band::Total,
            ..Curve::new("multisine", &multisine, Style::Markers)
        },
        Curve::new("chirp", &excerpts, Style::Line),
    ];
    let figure = bode(&curves, 0, 0, &Labels::torque_to_velocity(1, 1))?;
    fs::write("02_friction.svg", figure.svg())?;
    println!("02_friction.svg: of the resonance the chirp shows most, the multisine nothing");
    Ok(())
}

/// Share of the samples at which the motor stands still.
fn at_rest(motion: &Trajectory) -> f64 {
    let velocity = &motion.motor_velocity_rad_s;
    velocity.iter().filter(|&&velocity| velocity == 0.0).count() as f64 / velocity.len() as f64
}

/// By how many dB the highest value between 8 and 16 Hz lies below that of the joint without
/// friction.
fn lost_db(joint: &SingleJoint, frf: Frf) -> Result<f64, Box<dyn Error>> {
    let truth = joint.frf(&frf.frequency_hz, Hold::Zoh, T)?;
    Ok(Measured { frf, truth }.peak_deficit_db(8.0..=16.0))
}
