//! FRFs from chirps by excerpts, SK15 section 5.1: each frequency from the piece of the recording
//! in which the chirp passes it, then (7). Harmonics of that moment lie at other frequencies and
//! drop out.
//!
//! Known to be biased near sharp resonances: on the paper's linear example 0.03 dB in the median
//! and 1.8 dB, 14 deg at worst, 33 dB at a damping of 0.1 %. With repeats the bias is part of the
//! covariance ([`crate::frf::excerpts::whole_record`]).

#[cfg(test)]
mod tests;
pub(crate) mod whole_record;

use frfid_signals::{Chirp, Frf};
use ndarray::{ArrayView4, ArrayView5, Axis};

use crate::error::EstimateError;
use crate::frf::FrfOptions;
use crate::frf::estimate::FrfEstimate;
use crate::frf::excerpts::whole_record::WholeRecord;
use crate::spectra::campaign::Campaign;
use crate::spectra::excerpt::{ExcerptOptions, Excerpts};
use crate::spectra::time_series::{TimeSeries, check_same_shape};

/// FRF at `frequencies_hz` (rising) from recordings `(repeat, experiment, channel, sample)` of the
/// same chirp, which starts `start_s` after the first sample.
///
/// Repeats give the noise covariance, to which the bias of the excerpts is added, as far as the
/// whole record shows it; with one it is `None`, where the record is too short NaN. The reference `r` is for methods that
/// estimate through it.
///
/// # Errors
/// [`EstimateError::OutsideChirp`] for a frequency that the chirp does not pass within the
/// recording, and those of [`crate::frf::time_series::estimate_bla`].
#[allow(clippy::too_many_arguments)] // the recording, what is known about it, and what is asked: all by name in Python
pub fn estimate_chirp(
    u: ArrayView4<f64>,
    y: ArrayView4<f64>,
    r: Option<ArrayView4<f64>>,
    chirp: &Chirp,
    sample_time_s: f64,
    frequencies_hz: &[f64],
    start_s: f64,
    options: &FrfOptions,
) -> Result<Frf, EstimateError> {
    let estimate = estimate_repeats(
        u,
        y,
        r,
        chirp,
        sample_time_s,
        frequencies_hz,
        start_s,
        options,
    );
    Ok(estimate?.frf)
}

/// As [`estimate_chirp`], with the frequencies that were left out.
///
/// # Errors
/// As [`estimate_chirp`].
#[allow(clippy::too_many_arguments)] // the recording, what is known about it, and what is asked: all by name in Python
pub fn estimate_repeats(
    u: ArrayView4<f64>,
    y: ArrayView4<f64>,
    r: Option<ArrayView4<f64>>,
    chirp: &Chirp,
    sample_time_s: f64,
    frequencies_hz: &[f64],
    start_s: f64,
    options: &FrfOptions,
) -> Result<FrfEstimate, EstimateError> {
    options.method.check_reference(r.is_some())?;
    check_same_shape(&u, &y, r.as_ref())?;
    let cut = ExcerptOptions::default();
    let mut campaign = Campaign::new(frequencies_hz.to_vec())?;
    let n_samples = u.len_of(Axis(3));
    let excerpts = Excerpts::new(
        chirp,
        frequencies_hz,
        sample_time_s,
        start_s,
        n_samples,
        &cut,
    )?;
    let series = TimeSeries {
        u: as_one_realization(u),
        y: as_one_realization(y),
        r: r.map(as_one_realization),
    };
    series.transform_into(&mut campaign, &excerpts)?;
    let mut estimate = campaign.estimate_lines(options)?;
    estimate.frf.relative_resolution = Some(cut.relative_resolution(chirp));
    if estimate.frf.noise.is_some() {
        let whole = WholeRecord::new(chirp, frequencies_hz, sample_time_s, n_samples)?;
        let mut spectra = whole.campaign()?;
        series.transform_into(&mut spectra, &whole)?;
        whole.add_bias(&mut estimate.frf, &spectra)?;
    }
    Ok(estimate)
}

/// `(repeat, experiment, ..)` as `(realization, experiment, period, ..)`.
fn as_one_realization(signal: ArrayView4<f64>) -> ArrayView5<f64> {
    let mut signal = signal.insert_axis(Axis(0));
    signal.swap_axes(1, 2);
    signal
}
