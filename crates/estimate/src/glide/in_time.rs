//! Glide subtraction, SK15 section 4.4 E: what the machine does on constant velocity alone (torque
//! ripple, slow gravity) is recorded once and taken off every run of the same start, velocity and
//! direction.

use frfid_signals::checks::{require, require_shape};
use frfid_signals::{Record, SignalError};
use ndarray::{Array2, ArrayView1, s};

use crate::error::EstimateError;

/// Subtracts the glide from the run, sample by sample: `u`, `y` and, where both have one, `r`. The
/// position stays that of the run: it says where the rest was measured.
///
/// The glide may be longer than the run (a run that was stopped early), not shorter.
///
/// # Errors
/// [`frfid_signals::SignalError`] for another sample time, other channels or
/// too short a glide, [`EstimateError::OtherDirection`] if a channel of the glide moved the other
/// way.
pub fn subtract_glide(run: &Record, glide: &Record) -> Result<Record, EstimateError> {
    run.check()?;
    glide.check()?;
    check_same_clock(run, glide)?;
    check_same_channels(run, glide)?;
    check_same_direction(&run.y, &glide.y)?;
    let without = |signal: &Array2<f64>, glide: &Array2<f64>| {
        signal - &glide.slice(s![.., ..run.n_samples()])
    };
    let mut rest = run.clone();
    rest.u = without(&run.u, &glide.u);
    rest.y = without(&run.y, &glide.y);
    if let (Some(r), Some(glide_r)) = (&run.r, &glide.r) {
        rest.r = Some(without(r, glide_r));
    }
    Ok(rest)
}

/// Refuses a glide of another sample time.
fn check_same_clock(run: &Record, glide: &Record) -> Result<(), SignalError> {
    let found_s = glide.sample_time_s;
    let fits = same_clock(found_s, run.sample_time_s, run.n_samples());
    let needed = "the sample time of the run";
    require("sample_time_s of the glide", found_s, fits, needed)
}

/// Refuses a glide of other channels, or shorter than the run.
fn check_same_channels(run: &Record, glide: &Record) -> Result<(), SignalError> {
    check_holds("u of the glide", &run.u, &glide.u)?;
    check_holds("y of the glide", &run.y, &glide.y)?;
    match (&run.r, &glide.r) {
        (Some(run), Some(glide)) => check_holds("r of the glide", run, glide),
        _ => Ok(()),
    }
}

/// Refuses a signal of a glide with other channels or fewer samples than that of the run.
fn check_holds(
    name: &'static str,
    run: &Array2<f64>,
    glide: &Array2<f64>,
) -> Result<(), SignalError> {
    let (n_channels, n_samples) = run.dim();
    let fits = glide.nrows() == n_channels && glide.ncols() >= n_samples;
    let needed = format_args!("({n_channels}, {n_samples} or more samples), as the run");
    require_shape(name, glide.shape(), fits, needed)
}

/// Whether two sample times in s are one: stamps of a robot's clock may differ in the last digits,
/// half a sample over the run may not build up.
pub(crate) fn same_clock(found_s: f64, needed_s: f64, n_samples: usize) -> bool {
    (found_s / needed_s - 1.0).abs() * n_samples as f64 <= 0.5
}

/// Refuses a glide that moved the other way: the difference of direction would be booked as noise
/// or dynamics.
fn check_same_direction(run: &Array2<f64>, glide: &Array2<f64>) -> Result<(), EstimateError> {
    for (channel, (run, glide)) in run.rows().into_iter().zip(glide.rows()).enumerate() {
        let Some(glide_mean) = glide_velocity(glide) else {
            continue;
        };
        let run_mean = run.sum() / run.len() as f64;
        if run_mean * glide_mean < 0.0 {
            return Err(EstimateError::OtherDirection {
                channel,
                run_mean,
                glide_mean,
            });
        }
    }
    Ok(())
}

/// Mean velocity of an axis that glides; `None` for one that stands still, whose mean has either
/// sign and no direction.
pub(crate) fn glide_velocity(glide: ArrayView1<f64>) -> Option<f64> {
    let mean = glide.mean()?;
    let rms = (glide.dot(&glide) / glide.len() as f64).sqrt();
    (mean.abs() > 0.5 * rms).then_some(mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::refusal;
    use frfid_signals::InputKind;
    use ndarray::Array;

    const SAMPLES: usize = 1000;

    /// Constant velocity with ripple, and on top of it `amplitude` times an excitation.
    fn record(velocity: f64, amplitude: f64, samples: usize) -> Record {
        let ripple = |k: usize| 0.3 * (0.11 * k as f64).sin();
        let excitation = |k: usize| amplitude * (0.37 * k as f64).sin();
        Record {
            sample_time_s: 1e-3,
            u: Array::from_shape_fn((1, samples), |(_, k)| {
                5.0 * velocity + ripple(k) + excitation(k)
            }),
            y: Array::from_shape_fn((2, samples), |(c, k)| {
                if c == 0 {
                    velocity + 0.1 * ripple(k) + excitation(k)
                } else {
                    0.0
                }
            }),
            r: None,
            position_rad: None,
            input_kind: InputKind::Commanded,
            events: Vec::new(),
        }
    }

    #[test]
    fn ripple_and_velocity_go_and_the_excitation_stays() {
        let rest = subtract_glide(&record(0.2, 0.05, SAMPLES), &record(0.2, 0.0, SAMPLES + 10))
            .expect("they fit");
        for (signal, channel) in [(&rest.u, 0), (&rest.y, 0)] {
            for (k, value) in signal.row(channel).indexed_iter() {
                assert!((value - 0.05 * (0.37 * k as f64).sin()).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn glides_that_do_not_fit_are_refused() {
        let run = record(0.2, 0.05, SAMPLES);
        let other_way = subtract_glide(&run, &record(-0.2, 0.0, SAMPLES));
        assert!(matches!(
            other_way,
            Err(EstimateError::OtherDirection { channel: 0, .. })
        ));
        let said = refusal(subtract_glide(&run, &record(0.2, 0.0, SAMPLES - 1)));
        assert!(
            said.starts_with("u of the glide has shape [1, 999]"),
            "{said}"
        );
        let slow = Record {
            sample_time_s: 2e-3,
            ..record(0.2, 0.0, SAMPLES)
        };
        let said = refusal(subtract_glide(&run, &slow));
        assert!(
            said.starts_with("sample_time_s of the glide is 0.002,"),
            "{said}"
        );
        let mut holed = record(0.2, 0.0, SAMPLES);
        holed.u[[0, 3]] = f64::NAN;
        let said = refusal(subtract_glide(&run, &holed));
        assert!(said.starts_with("u: 1 samples are NaN"), "{said}");
    }
}
