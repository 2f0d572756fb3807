//! FRF of a campaign given as arrays of whole periods.

use frfid_signals::{Frf, SignalError};
use ndarray::{ArrayView2, ArrayView5, s};
use rayon::prelude::*;

use crate::error::EstimateError;
use crate::frf::FrfOptions;
use crate::period_index::PeriodIndex;
use crate::spectra::campaign::{Campaign, RunSpectra};
use crate::spectra::line_dft::LineDft;

/// Best linear approximation from time series `(realization, experiment, period, channel, sample)`
/// of any strides.
///
/// `harmonics` are DFT bins of the period, rising. The reference `r` has as many channels as `u` and
/// is for methods that estimate through it. The noise covariance is `None` with one period, the
/// total covariance with one realization.
///
/// # Errors
/// A reference that is missing or not used, shapes that differ, samples that are not finite, lines
/// off the grid, fewer experiments than inputs, lines on which U cannot be inverted:
/// [`EstimateError`] with what was found and needed.
pub fn estimate_bla(
    u: ArrayView5<f64>,
    y: ArrayView5<f64>,
    r: Option<ArrayView5<f64>>,
    sample_time_s: f64,
    harmonics: &[usize],
    options: &FrfOptions,
) -> Result<Frf, EstimateError> {
    if r.is_some() && !options.method.needs_reference() {
        let what =
            "a reference r is given, but the method does without; leave it out, or estimate \
                    through it by the method joint-input-output"
                .to_owned();
        return Err(SignalError::Unfit { key: "r", what }.into());
    }
    let (n_p, n_ex, n_q, _, n_samples) = u.dim();
    for (name, signal) in [("y", Some(&y)), ("r", r.as_ref())] {
        let Some(signal) = signal else { continue };
        let (p, m, q, _, k) = signal.dim();
        if (p, m, q, k) != (n_p, n_ex, n_q, n_samples) {
            let needed = format!("({n_p}, {n_ex}, {n_q}, channel, {n_samples}), as u");
            return Err(SignalError::Shape {
                name,
                found: signal.shape().to_vec(),
                needed,
            }
            .into());
        }
    }
    let dft = LineDft::new(n_samples, harmonics)?;
    let mut campaign = Campaign::new(dft.frequency_hz(sample_time_s)?)?;
    let places: Vec<PeriodIndex> = (0..n_p * n_q * n_ex)
        .map(|run| PeriodIndex {
            realization: run / (n_q * n_ex),
            period: run / n_ex % n_q,
            experiment: run % n_ex,
        })
        .collect();
    let spectra: Result<Vec<RunSpectra>, EstimateError> = places
        .par_iter()
        .map(|&place| {
            RunSpectra::of(
                &dft,
                run_at(&u, place),
                run_at(&y, place),
                r.as_ref().map(|r| run_at(r, place)),
            )
        })
        .collect();
    for (place, run) in places.into_iter().zip(spectra?) {
        campaign.insert(place, run)?;
    }
    campaign.estimate(options)
}

/// One run, `(channel, sample)`, out of a campaign's array.
fn run_at<'a>(signal: &'a ArrayView5<f64>, place: PeriodIndex) -> ArrayView2<'a, f64> {
    signal.slice(s![
        place.realization,
        place.experiment,
        place.period,
        ..,
        ..
    ])
}
