//! Answer of a linear plant to what its input has on lines that are not excited, taken off the output.

use std::iter::zip;

use frfid_signals::Frf;
use frfid_signals::checks::require_shape;
use ndarray::{Array2, Array3, ArrayView2, Axis, Zip};
use num_complex::Complex64;

use crate::distortion::detection_lines::DetectionLines;
use crate::error::EstimateError;
use crate::frf::between::between;
use crate::spectra::campaign::Campaign;
use crate::spectra::run_spectra::RunSpectra;

/// The runs with `Y - G U` in the place of Y.
///
/// # Errors
/// [`frfid_signals::SignalError::Shape`] for a plant of other lines or channels, [`EstimateError::EmptyList`] for one
/// of which no line is known.
pub(super) fn unexplained(
    lines: &DetectionLines,
    free: &Campaign,
    plant: &Frf,
) -> Result<Campaign, EstimateError> {
    let between_lines = Interpolated::of(lines, plant)?;
    let mut rest = Campaign::new(free.frequency_hz().to_vec())?;
    for (place, mut run) in free.clone().into_runs() {
        check_channels(plant, &run)?;
        between_lines.take_answer_off(&mut run.y, &run.u);
        rest.insert(place, run)?;
    }
    Ok(rest)
}

/// A plant on the detection lines, between its known lines.
struct Interpolated {
    /// `(output, input, detection line)`.
    response: Array3<Complex64>,
}

impl Interpolated {
    fn of(lines: &DetectionLines, plant: &Frf) -> Result<Self, EstimateError> {
        let n_lines = lines.excited.len();
        let fits = plant.n_frequencies() == n_lines;
        let needed = format_args!("({n_lines}, output, input), the excited lines");
        require_shape("plant", plant.response.shape(), fits, needed)?;
        let known = known_lines(plant);
        if known.is_empty() {
            return Err(EstimateError::EmptyList("lines of the plant"));
        }
        let places = places_between(lines, &known);
        let shape = (plant.n_outputs(), plant.n_inputs(), places.len());
        let response = Array3::from_shape_fn(shape, |(output, input, line)| {
            let (below, above, share) = places[line];
            let [below, above] = [below, above].map(|at| plant.response[[at, output, input]]);
            below + (above - below) * share
        });
        Ok(Self { response })
    }

    /// Takes what the plant answers to u off y, both `(channel, detection line)`.
    fn take_answer_off(&self, y: &mut Array2<Complex64>, u: &Array2<Complex64>) {
        for (mut y, to_output) in zip(y.rows_mut(), self.response.outer_iter()) {
            for (response, u) in zip(to_output.rows(), u.rows()) {
                let each = Zip::from(&mut y).and(response).and(u);
                each.for_each(|y, response, u| *y -= response * u);
            }
        }
    }
}

/// Refuses a run of other channels than the plant's.
fn check_channels(plant: &Frf, run: &RunSpectra) -> Result<(), EstimateError> {
    let (found, needed) = (plant.response.shape(), [run.y.nrows(), run.u.nrows()]);
    let fits = found[1..] == needed;
    let needed = format_args!(
        "(line, {}, {}), the channels of the runs",
        needed[0], needed[1]
    );
    Ok(require_shape("plant", found, fits, needed)?)
}

/// For each detection line the known lines below and above, and where it stands between them.
fn places_between(lines: &DetectionLines, known: &[usize]) -> Vec<(usize, usize, f64)> {
    let at = known.iter().map(|&place| lines.excited[place] as f64);
    let at: Vec<f64> = at.collect();
    let place = |&line: &usize| {
        let (below, above, share) = between(&at, line as f64);
        (known[below], known[above], share)
    };
    lines.free.iter().map(place).collect()
}

/// Places of the lines that are not left out.
fn known_lines(plant: &Frf) -> Vec<usize> {
    let known = |&place: &usize| is_known(plant.response.index_axis(Axis(0), place));
    (0..plant.n_frequencies()).filter(known).collect()
}

fn is_known(response: ArrayView2<Complex64>) -> bool {
    response.iter().all(|value| value.is_finite())
}
