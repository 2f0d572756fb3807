//! Lesson 1: the two excitations of the paper, and why one of them is stronger (SK15 sections 4.2, 5.1 and 6.1).
//!
//! Run: cargo run --release --example 01_excitations

use frfid::signals::{
    Chirp, Draw, GridDesign, GridKind, Multisine, Phases, Phasing, Profile, SignalError, power::mean_power,
};

fn main() -> Result<(), SignalError> {
    // An odd random-phase multisine: about 80 frequencies between 1 Hz and 60 Hz, each moved to an odd multiple of f0.
    let (sample_time_s, kind, seed) = (1e-3, GridKind::Odd, 0);
    let design =
        GridDesign { low_hz: 1.0, high_hz: 60.0, sample_time_s, resolution_hz: 0.1, n_lines: Some(80), kind, seed };
    let grid = design.design()?;
    let hz = grid.lines_hz();
    println!("period {} s, f0 = {:.5} Hz, {} lines", grid.period_s(), grid.fundamental_hz(), hz.len());
    println!("first line {} f0 = {:.3} Hz, last line {:.3} Hz", grid.excited[0], hz[0], hz[hz.len() - 1]);

    // One realization is one draw of the phases, scaled so that the torque never exceeds 150 N m, not even between samples.
    let multisine = Multisine { grid, shape: Profile::constant(1.0), phases: Phases::Random };
    let chirp = Chirp {
        low_hz: 1.0,
        high_hz: 60.0,
        duration_s: 20.0,
        amplitude: vec![Profile::constant(150.0)],
        fade_s: 0.0,
        tail_s: 0.0,
    };
    let power = |signal: ndarray::Array3<f64>| mean_power(&signal.into_raw_vec_and_offset().0);
    let chirp_power = power(chirp.sample(sample_time_s, 1, Phasing::SignFlip)?);
    let share = |realization| {
        let draw = Draw { seed: 1, realization, phasing: Phasing::Orthogonal, peak: &[150.0] };
        Ok(100.0 * power(multisine.realize(&draw)?.signal) / chirp_power)
    };
    let mut shares = (0..200).map(share).collect::<Result<Vec<f64>, SignalError>>()?;
    shares.sort_by(f64::total_cmp);
    let (low, median, high) = (shares[10], shares[100], shares[190]);
    println!(
        "mean power over that of the chirp: {median:.1} % in the median, {low:.0} % to {high:.0} % (the paper saw 11 % to 20 %)"
    );
    Ok(())
}
