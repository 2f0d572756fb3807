//! Lesson 1: the two excitations of the paper, and why one of them is stronger (SK15 sections 4.2,
//! 5.1 and 6.1).
//!
//! Run: cargo run --release --example 01_excitations

use std::error::Error;

use frfid::estimate::{EstimateError, LineDft, Transform, condition_number};
use frfid::signals::{
    Chirp, Draw, GridDesign, GridKind, Multisine, Phasing, Profile, power::mean_power,
};
use nalgebra::DMatrix;
use ndarray::{Array3, Axis};

fn main() -> Result<(), Box<dyn Error>> {
    // An odd random-phase multisine: about 80 frequencies between 1 Hz and 60 Hz, each moved to an
    // odd multiple of f0.
    let (sample_time_s, kind, seed) = (1e-3, GridKind::Odd, 0);
    let design = GridDesign {
        low_hz: 1.0,
        high_hz: 60.0,
        sample_time_s,
        resolution_hz: 0.1,
        n_lines: Some(80),
        kind,
        seed,
    };
    let grid = design.design()?;
    let hz = grid.lines_hz();
    println!(
        "period {} s, f0 = {:.5} Hz, {} lines",
        grid.period_s(),
        grid.fundamental_hz(),
        hz.len()
    );
    println!(
        "first line {} f0 = {:.3} Hz, last line {:.3} Hz",
        grid.excited[0],
        hz[0],
        hz[hz.len() - 1]
    );

    // One realization is one draw of the phases, scaled so that the torque never exceeds 150 N m,
    // not even between samples.
    let amplitude = vec![Profile::constant(150.0)];
    let chirp = Chirp {
        low_hz: 1.0,
        high_hz: 60.0,
        duration_s: 20.0,
        amplitude,
        fade_s: 0.0,
        tail_s: 0.0,
    };
    let power = |signal: Array3<f64>| mean_power(&signal.into_raw_vec_and_offset().0);
    let realize = |realization, n_inputs| {
        let draw = Draw {
            seed: 1,
            realization,
            phasing: Phasing::Orthogonal,
        };
        let multisine = Multisine::flat(grid.clone(), vec![150.0; n_inputs]);
        multisine.realize(&draw).map(|drawn| drawn.signal)
    };
    let chirp_power = power(chirp.sample(sample_time_s, 1, Phasing::SignFlip)?);
    let share = |realization| Ok(100.0 * power(realize(realization, 1)?) / chirp_power);
    let mut shares = (0..200)
        .map(share)
        .collect::<Result<Vec<f64>, Box<dyn Error>>>()?;
    shares.sort_by(f64::total_cmp);
    let percentile = |q: f64| {
        let (below, rest) = ((q * 199.0) as usize, (q * 199.0).fract());
        shares[below] + rest * (shares[below + 1] - shares[below])
    };
    let (low, median, high) = (percentile(0.05), percentile(0.5), percentile(0.95));
    println!(
        "mean power over that of the chirp: {median:.1} % in the median, {low:.0} % to {high:.0} % (the paper saw 11 % to 20 %)"
    );

    // Three inputs need three experiments. Their phases decide how well the inputs can be told
    // apart.
    let (orthogonal, flipped) = (
        realize(0, 3)?,
        chirp.sample(sample_time_s, 3, Phasing::SignFlip)?,
    );
    let excited = &grid.excited;
    println!(
        "condition number of U, multisine, orthogonal: {:.3}",
        largest_condition(&orthogonal, excited)?
    );
    println!(
        "condition number of U, chirp, sign flip: {:.3}",
        largest_condition(&flipped, &[200])?
    );
    Ok(())
}

/// Largest condition number, over the lines, of the matrix of all inputs in all experiments,
/// `(experiment, input, sample)`.
fn largest_condition(signal: &Array3<f64>, lines: &[usize]) -> Result<f64, EstimateError> {
    let dft = LineDft::new(signal.len_of(Axis(2)), lines)?;
    let columns = signal
        .outer_iter()
        .map(|experiment| dft.transform("r", experiment));
    let columns = columns.collect::<Result<Vec<_>, _>>()?;
    (0..lines.len()).try_fold(0.0, |largest: f64, line| {
        let matrix = DMatrix::from_fn(signal.len_of(Axis(1)), columns.len(), |input, m| {
            columns[m][[input, line]]
        });
        Ok(largest.max(condition_number(&matrix)?))
    })
}
