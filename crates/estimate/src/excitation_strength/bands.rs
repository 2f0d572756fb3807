//! Strength of an excitation by bands of frequency: from the time in which it passes them, or from
//! its lines.

use std::iter::zip;
use std::ops::Range;

use frfid_signals::{Plan, Record};
use ndarray::{Array2, ArrayView1, ArrayView2, s};

use crate::error::EstimateError;
use crate::excitation_strength::stuck::Readings;
use crate::excitation_strength::{BandStrength, rms_about_mean};
use crate::spectra::Evaluation;

/// A band in Hz and the samples in which the excitation passes it.
pub(super) type Passage = ([f64; 2], Range<usize>);

/// When the excitation passes the bands; `None` where it is in all of them all the time.
pub(super) fn passages(
    plan: &Plan,
    window: &Range<usize>,
    bands_hz: &[[f64; 2]],
) -> Option<Vec<Passage>> {
    let passage = |&band_hz: &[f64; 2]| Some((band_hz, samples_in(plan, window.end, band_hz)?));
    bands_hz.iter().map(passage).collect()
}

/// The samples up to `end` in which the excitation passes a band.
fn samples_in(plan: &Plan, end: usize, band_hz: [f64; 2]) -> Option<Range<usize>> {
    let waveform = plan.excitation.waveform();
    let times_s = waveform.seconds_in(band_hz, plan.sample_time_s)?;
    let [from, to] = times_s.map(|time_s| sample_at(plan, time_s).min(end));
    Some(from..to)
}

/// The sample of a record in which the excitation has lasted so long.
fn sample_at(plan: &Plan, time_s: f64) -> usize {
    plan.lead_in_samples + (time_s / plan.sample_time_s).round() as usize
}

/// Bands of every axis from the time in which the excitation passes them.
pub(super) fn swept_bands(
    record: &Record,
    readings: &[Readings],
    passages: &[Passage],
) -> Vec<Vec<BandStrength>> {
    let of_axis = |(torque_nm, readings): (ArrayView1<f64>, &Readings)| {
        let passed = passages.iter().filter(|(_, time)| time.len() > 1);
        passed
            .map(|passage| swept_band(torque_nm, readings, passage))
            .collect()
    };
    zip(record.u.rows(), readings).map(of_axis).collect()
}

/// The band of an axis from the time in which the excitation passes it.
fn swept_band(
    torque_nm: ArrayView1<f64>,
    readings: &Readings,
    (band_hz, time): &Passage,
) -> BandStrength {
    let rms_nm = rms_about_mean(torque_nm.slice(s![time.clone()]));
    BandStrength::new(*band_hz, rms_nm, readings.stuck_share(time.clone()))
}

/// Bands of every axis from the excited lines, averaged over the periods.
pub(super) fn line_bands(
    record: &Record,
    window: &Range<usize>,
    plan: &Plan,
    bands_hz: &[[f64; 2]],
) -> Result<Vec<Vec<BandStrength>>, EstimateError> {
    let lines = Evaluation::of(plan, 2)?;
    let power = mean_line_power(record, window, plan.period_samples()?, &lines)?;
    let of_axis = |power: ArrayView1<f64>| {
        let band = |&band_hz: &[f64; 2]| band_of_lines(&lines.frequency_hz, power, band_hz);
        bands_hz.iter().filter_map(band).collect()
    };
    Ok(power.rows().into_iter().map(of_axis).collect())
}

/// Power of the torque on every line, averaged over the periods, `(axis, line)`.
fn mean_line_power(
    record: &Record,
    window: &Range<usize>,
    period: usize,
    lines: &Evaluation,
) -> Result<Array2<f64>, EstimateError> {
    let n_periods = (window.len() / period) as f64;
    let mut power = Array2::zeros((record.u.nrows(), lines.frequency_hz.len()));
    for start in window.clone().step_by(period) {
        let torque = record.u.slice(s![.., start..start + period]);
        power += &(line_power(torque, lines)? / n_periods);
    }
    Ok(power)
}

/// Power of a period of torque on every line, `2|U|^2/N^2`, `(axis, line)`.
fn line_power(torque: ArrayView2<f64>, lines: &Evaluation) -> Result<Array2<f64>, EstimateError> {
    let spectra = lines.transform.transform("u", torque)?;
    let square = (torque.ncols() as f64).powi(2);
    Ok(spectra.mapv(|value| 2.0 * value.norm_sqr() / square))
}

/// The band of an axis from the power of its lines; `None` without a line in it.
fn band_of_lines(
    hz: &[f64],
    power: ArrayView1<f64>,
    [low_hz, high_hz]: [f64; 2],
) -> Option<BandStrength> {
    let inside = zip(hz, power).filter(|&(hz, _)| (low_hz..high_hz).contains(hz));
    let powers: Vec<f64> = inside.map(|(_, power)| *power).collect();
    let rms_nm = powers.iter().sum::<f64>().sqrt();
    (!powers.is_empty()).then(|| BandStrength::new([low_hz, high_hz], rms_nm, None))
}
