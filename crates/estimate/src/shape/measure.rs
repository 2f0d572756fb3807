//! What the records of an iteration say: responses, errors, whether every run was complete.

use frfid_signals::power::rms;
use frfid_signals::{EventKind, Frf, Record, SignalError};
use nalgebra::DMatrix;
use ndarray::{Array2, Array3, Axis, s};
use num_complex::Complex64;

use crate::frf::singular::scaled_condition_number;
use crate::glide::in_time::same_clock;
use crate::shape::error::ShapeError;
use crate::shape::iteration::{Estimate, Note};
use crate::shape::options::{ShapeOptions, Step, Target};
use crate::shape::spectra::Band;
use crate::shape::step::{coherence, response};

/// Share of the target's power in the band that the references must explain; what has nothing to do
/// with them gets 0.1 by chance on three axes and 0.2 on six.
const NEEDED_COHERENCE: f64 = 0.3;

/// Checks shapes and finiteness; every run that was stopped before its end is a note.
pub(super) fn stopped(
    records: &[Record],
    (n_experiments, n_axes, n_samples): (usize, usize, usize),
    sample_time_s: f64,
) -> Result<Vec<Note>, ShapeError> {
    let mut notes = Vec::new();
    let shape = |name, found: Vec<usize>, needed| {
        Err(SignalError::Shape {
            name,
            found,
            needed,
        }
        .into())
    };
    if records.len() != n_experiments {
        return shape(
            "records",
            vec![records.len()],
            format!("({n_experiments}), one per experiment"),
        );
    }
    for (experiment, record) in records.iter().enumerate() {
        record.check()?;
        if !same_clock(record.sample_time_s, sample_time_s, n_samples) {
            let (key, found) = ("sample_time_s of a record", record.sample_time_s);
            return Err(SignalError::Parameter {
                key,
                found,
                needed: "that of the reference",
            }
            .into());
        }
        for (name, signal) in [("u", &record.u), ("y", &record.y)] {
            if signal.nrows() != n_axes || signal.ncols() > n_samples {
                return shape(
                    name,
                    signal.shape().to_vec(),
                    format!("({n_axes}, {n_samples}), as the reference"),
                );
            }
        }
        if record.n_samples() < n_samples {
            let said = record
                .events
                .iter()
                .rev()
                .find_map(|event| match &event.kind {
                    EventKind::Stopped { reason, .. } => Some(reason.clone()),
                    _ => None,
                });
            let reason = said.unwrap_or_else(|| "no reason given".into());
            let time_s = record.n_samples() as f64 * sample_time_s;
            notes.push(Note::Stopped {
                experiment,
                time_s,
                reason,
            });
        }
    }
    Ok(notes)
}

/// Responses and errors of complete records of a reference.
pub(super) fn estimate(
    records: &[Record],
    reference: &Array3<f64>,
    band: &Band,
    desired: &[DMatrix<Complex64>],
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
    for (axis, &coherence) in coherence(target, &r, hz)?.iter().enumerate() {
        if coherence.is_nan() || coherence < NEEDED_COHERENCE {
            return Err(ShapeError::NoResponse {
                target: name,
                axis,
                coherence,
                needed: NEEDED_COHERENCE,
            });
        }
    }
    let bins = match options.step {
        Step::Paper => 1,
        Step::Damped { smoothing_bins, .. } => smoothing_bins,
    };
    let frf = |x| Ok::<_, ShapeError>(Frf::new(hz.clone(), stacked(&response(x, &r, bins, hz)?))?);
    let desired = &desired[band.inside()];
    let error_per_frequency = relative_error(target, desired);
    let n_axes = error_per_frequency.ncols();
    Ok(Estimate {
        r_to_u: frf(&u)?,
        r_to_y: frf(&y)?,
        channel_error: (0..n_axes)
            .map(|c| rms(&error_per_frequency.column(c).to_vec()))
            .collect(),
        error: rms(&error_per_frequency.iter().copied().collect::<Vec<_>>()),
        condition: u
            .iter()
            .map(scaled_condition_number)
            .collect::<Result<_, _>>()?,
        error_per_frequency,
    })
}

/// One signal of all records, `(experiment, channel, sample)`; what is missing of a run that was
/// stopped is 0.
pub(super) fn stack(records: &[Record], signal: impl Fn(&Record) -> &Array2<f64>) -> Array3<f64> {
    let n_samples = records.iter().map(Record::n_samples).max().unwrap_or(0);
    let n_channels = records.first().map_or(0, |record| signal(record).nrows());
    let mut stacked = Array3::zeros((records.len(), n_channels, n_samples));
    for (mut to, record) in stacked.axis_iter_mut(Axis(0)).zip(records) {
        to.slice_mut(s![.., ..record.n_samples()])
            .assign(signal(record));
    }
    stacked
}

/// Matrices as one array `(frequency, output, input)`.
fn stacked(matrices: &[DMatrix<Complex64>]) -> Array3<Complex64> {
    let (rows, columns) = matrices[0].shape();
    Array3::from_shape_fn((matrices.len(), rows, columns), |(k, row, column)| {
        matrices[k][(row, column)]
    })
}

/// `|X - X_des| / |X_des|` over the experiments, `(frequency, channel)`.
fn relative_error(found: &[DMatrix<Complex64>], desired: &[DMatrix<Complex64>]) -> Array2<f64> {
    let n_channels = found[0].nrows();
    Array2::from_shape_fn((found.len(), n_channels), |(k, channel)| {
        let missing = &desired[k] - &found[k];
        missing.row(channel).norm() / desired[k].row(channel).norm()
    })
}
