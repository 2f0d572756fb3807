//! Answer of a linear plant to what its input has on lines that are not excited, taken off the output.

use frfid_signals::Frf;
use frfid_signals::checks::require_shape;
use ndarray::{Array2, ArrayView1, ArrayView2, Axis, s};
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
    let plant = Interpolated::of(lines, plant)?;
    let mut rest = Campaign::new(free.frequency_hz().to_vec())?;
    for (place, run) in free.clone().into_runs() {
        plant.check(&run)?;
        let y = &run.y - &plant.answer(&run.u);
        rest.insert(place, RunSpectra { y, ..run })?;
    }
    Ok(rest)
}

/// A plant between its known lines.
struct Interpolated<'a> {
    plant: &'a Frf,
    /// For each detection line the known lines below and above, and where it stands between them.
    places: Vec<(usize, usize, f64)>,
}

impl<'a> Interpolated<'a> {
    fn of(lines: &DetectionLines, plant: &'a Frf) -> Result<Self, EstimateError> {
        let n_lines = lines.excited.len();
        let fits = plant.n_frequencies() == n_lines;
        let needed = format_args!("({n_lines}, output, input), the excited lines");
        require_shape("plant", plant.response.shape(), fits, needed)?;
        let known = known_lines(plant);
        if known.is_empty() {
            return Err(EstimateError::EmptyList("lines of the plant"));
        }
        let places = places_between(lines, &known);
        Ok(Self { plant, places })
    }

    /// Refuses a run of other channels.
    fn check(&self, run: &RunSpectra) -> Result<(), EstimateError> {
        let (found, needed) = (self.plant.response.shape(), [run.y.nrows(), run.u.nrows()]);
        let fits = found[1..] == needed;
        let needed = format_args!(
            "(line, {}, {}), the channels of the runs",
            needed[0], needed[1]
        );
        Ok(require_shape("plant", found, fits, needed)?)
    }

    /// What the plant answers to u, `(channel, detection line)`.
    fn answer(&self, u: &Array2<Complex64>) -> Array2<Complex64> {
        Array2::from_shape_fn((self.plant.n_outputs(), u.ncols()), |(output, line)| {
            let (below, above, share) = self.places[line];
            let [below, above] = [below, above].map(|place| self.at(place, output, u.column(line)));
            below + (above - below) * share
        })
    }

    /// What an output of the plant at an excited line would answer.
    fn at(&self, place: usize, output: usize, u: ArrayView1<Complex64>) -> Complex64 {
        let plant = self.plant.response.slice(s![place, output, ..]);
        plant.dot(&u)
    }
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
