//! FRFs from chirps by excerpts, SK15 section 5.1: each frequency from the piece of the recording
//! in which the chirp passes it, then (7). Harmonics of that moment lie at other frequencies and
//! drop out.
//!
//! Known to be biased near sharp resonances: on the paper's linear example 0.03 dB in the median
//! and 1.8 dB, 14 deg at worst, 33 dB at a damping of 0.1 %. With repeats the bias is part of the
//! covariance ([`crate::frf::excerpts::bias`]).

pub(crate) mod bias;
#[cfg(test)]
mod tests;

use frfid_signals::{Chirp, Frf};
use ndarray::{ArrayView4, ArrayView5, Axis};

use crate::error::EstimateError;
use crate::frf::FrfOptions;
use crate::frf::estimate::FrfEstimate;
use crate::frf::excerpts::bias::add_excerpt_bias;
use crate::spectra::Evaluation;
use crate::spectra::campaign::Campaign;
use crate::spectra::excerpt::{ExcerptOptions, Excerpts};
use crate::spectra::time_series::{TimeSeries, check_same_shape};
use crate::spectra::whole_record::WholeRecord;

/// FRF at `frequencies_hz` (rising) by excerpts, or by local models of the whole records, from
/// recordings `(repeat, experiment, channel, sample)` of the same chirp, which starts `start_s` after the first sample.
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
    let n_samples = u.len_of(Axis(3));
    let hz = frequencies_hz;
    let excerpts = Excerpts::new(chirp, hz, sample_time_s, start_s, n_samples, &cut)?;
    let series = TimeSeries {
        u: as_one_realization(u),
        y: as_one_realization(y),
        r: r.map(as_one_realization),
    };
    if options.method.local_model().is_some() {
        let evaluation = Evaluation::by_whole_record(chirp, hz.to_vec(), sample_time_s, n_samples)?;
        return of_whole_records(&series, &evaluation, options);
    }
    let mut campaign = Campaign::new(hz.to_vec())?;
    series.transform_into(&mut campaign, &excerpts)?;
    let mut estimate = campaign.estimate_lines(options)?;
    estimate.frf.relative_resolution = Some(cut.relative_resolution(chirp));
    if estimate.frf.noise.is_some() {
        let whole = WholeRecord::of_band(chirp, sample_time_s, n_samples)?;
        with_bias(&mut estimate.frf, &series, &whole)?;
    }
    Ok(estimate)
}

/// The estimate by local models.
fn of_whole_records(
    series: &TimeSeries,
    evaluation: &Evaluation,
    options: &FrfOptions,
) -> Result<FrfEstimate, EstimateError> {
    let mut campaign = evaluation.campaign()?;
    series.transform_into(&mut campaign, &*evaluation.transform)?;
    campaign.estimate_lines(options)
}

/// Adds the bias of the excerpts.
fn with_bias(frf: &mut Frf, series: &TimeSeries, whole: &WholeRecord) -> Result<(), EstimateError> {
    let mut campaign = whole.campaign()?;
    series.transform_into(&mut campaign, whole)?;
    add_excerpt_bias(frf, &campaign)
}

/// `(repeat, experiment, ..)` as `(realization, experiment, period, ..)`.
fn as_one_realization(signal: ArrayView4<f64>) -> ArrayView5<f64> {
    let mut signal = signal.insert_axis(Axis(0));
    signal.swap_axes(1, 2);
    signal
}
