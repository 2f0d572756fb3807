//! Measurement of an iteration by its records: responses, errors, whether every run was complete.

pub(crate) mod octave_error;

use frfid_signals::checks::{require, require_shape};
use frfid_signals::power::rms;
use frfid_signals::{Event, EventKind, Frf, Record, SignalError};
use ndarray::{Array2, Array3, Axis, s};

use crate::error::EstimateError;
use crate::frf::matrices::{Matrix, stacked};
use crate::frf::singular::scaled_condition_number;
use crate::glide::in_time::same_clock;
use crate::shape::error::ShapeError;
use crate::shape::iteration::Estimate;
use crate::shape::measure::octave_error::OctaveError;
use crate::shape::note::Note;
use crate::shape::options::{ShapeOptions, Target};
use crate::shape::spectra::Band;
use crate::shape::step::{coherence, response};

/// Share of the target's power in the band that the references must explain; what has nothing to do
/// with them gets 0.1 by chance on three axes and 0.2 on six.
const NEEDED_COHERENCE: f64 = 0.3;

/// Checks shapes and finiteness; every run that was stopped before its end is a note.
pub(in crate::shape) fn stopped(
    records: &[Record],
    (n_experiments, n_axes, n_samples): (usize, usize, usize),
    sample_time_s: f64,
) -> Result<Vec<Note>, EstimateError> {
    let (found, fits) = ([records.len()], records.len() == n_experiments);
    let needed = format_args!("({n_experiments}), one per experiment");
    require_shape("records", &found, fits, needed)?;
    let mut notes = Vec::new();
    for (experiment, record) in records.iter().enumerate() {
        check_record(record, (n_axes, n_samples), sample_time_s)?;
        if record.n_samples() < n_samples {
            notes.push(Note::Stopped {
                experiment,
                time_s: record.n_samples() as f64 * sample_time_s,
                reason: reason_to_stop(record),
            });
        }
    }
    Ok(notes)
}

/// Refuses a record of another clock, of other axes or longer than the reference.
fn check_record(
    record: &Record,
    (n_axes, n_samples): (usize, usize),
    sample_time_s: f64,
) -> Result<(), EstimateError> {
    record.check()?;
    let (key, needed) = ("sample_time_s of a record", "that of the reference");
    let fits = same_clock(record.sample_time_s, sample_time_s, n_samples);
    require(key, record.sample_time_s, fits, needed)?;
    for (name, signal) in [("u", &record.u), ("y", &record.y)] {
        let fits = signal.nrows() == n_axes && signal.ncols() <= n_samples;
        let needed = format_args!("({n_axes}, {n_samples}), as the reference");
        require_shape(name, signal.shape(), fits, needed)?;
    }
    Ok(())
}

/// Why a run was stopped, as the last such event says.
fn reason_to_stop(record: &Record) -> String {
    let reason = |event: &Event| match &event.kind {
        EventKind::Stopped { reason, .. } => Some(reason.clone()),
        _ => None,
    };
    let said = record.events.iter().rev().find_map(reason);
    said.unwrap_or_else(|| "no reason given".into())
}

/// Responses and errors of complete records of a reference.
pub(in crate::shape) fn estimate(
    records: &[Record],
    reference: &Array3<f64>,
    band: &Band,
    desired: &[Matrix],
    options: &ShapeOptions,
) -> Result<Estimate, ShapeError> {
    let hz = &band.frequency_hz;
    let r = band.spectra("reference", reference.axis_iter(Axis(0)))?;
    let u = band.spectra("u", records.iter().map(|record| record.u.view()))?;
    let y = band.spectra("y", records.iter().map(|record| record.y.view()))?;
    let (target, name) = match options.target {
        Target::Torque => (&u, "torque"),
        Target::Velocity => (&y, "velocity"),
    };
    check_coherence(name, &coherence(target, &r, hz)?)?;
    let bins = options.step.smoothing_bins();
    let error_per_frequency = relative_error(target, &desired[band.inside()]);
    Ok(Estimate {
        r_to_u: frf(hz, &response(&u, &r, bins, hz)?)?,
        r_to_y: frf(hz, &response(&y, &r, bins, hz)?)?,
        channel_error: rms_per_channel(&error_per_frequency),
        error: rms(&error_per_frequency.iter().copied().collect::<Vec<_>>()),
        octave_error: OctaveError::of_band(
            hz,
            &error_per_frequency,
            [options.low_hz, options.high_hz],
        ),
        condition: conditions(&u)?,
        error_per_frequency,
    })
}

/// Refuses a target that does not follow the references.
fn check_coherence(target: &'static str, coherence: &[f64]) -> Result<(), ShapeError> {
    for (axis, &coherence) in coherence.iter().enumerate() {
        if coherence.is_nan() || coherence < NEEDED_COHERENCE {
            return Err(ShapeError::NoResponse {
                target,
                axis,
                coherence,
                needed: NEEDED_COHERENCE,
            });
        }
    }
    Ok(())
}

fn frf(frequency_hz: &[f64], responses: &[Matrix]) -> Result<Frf, SignalError> {
    Frf::new(frequency_hz.to_vec(), stacked(responses))
}

/// Rms over the band of errors `(frequency, channel)`.
fn rms_per_channel(error: &Array2<f64>) -> Vec<f64> {
    let columns = error.columns().into_iter();
    columns.map(|channel| rms(&channel.to_vec())).collect()
}

fn conditions(u: &[Matrix]) -> Result<Vec<f64>, EstimateError> {
    u.iter().map(scaled_condition_number).collect()
}

/// One signal of all records, `(experiment, channel, sample)`; what is missing of a run that was
/// stopped is 0.
pub(in crate::shape) fn stack(
    records: &[Record],
    signal: impl Fn(&Record) -> &Array2<f64>,
) -> Array3<f64> {
    let n_samples = records.iter().map(Record::n_samples).max().unwrap_or(0);
    let n_channels = records.first().map_or(0, |record| signal(record).nrows());
    let mut stacked = Array3::zeros((records.len(), n_channels, n_samples));
    for (mut to, record) in stacked.axis_iter_mut(Axis(0)).zip(records) {
        to.slice_mut(s![.., ..record.n_samples()])
            .assign(signal(record));
    }
    stacked
}

/// `|X - X_des| / |X_des|` over the experiments, `(frequency, channel)`.
fn relative_error(found: &[Matrix], desired: &[Matrix]) -> Array2<f64> {
    let n_channels = found[0].nrows();
    Array2::from_shape_fn((found.len(), n_channels), |(k, channel)| {
        let missing = &desired[k] - &found[k];
        missing.row(channel).norm() / desired[k].row(channel).norm()
    })
}
