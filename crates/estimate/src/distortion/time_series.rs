//! FRF and distortion levels of a campaign given as arrays of whole periods, from one transform.

use std::sync::LazyLock;

use frfid_signals::{Distortion, DistortionLevel, SignalLevels, median_db};
use ndarray::{ArrayView5, Axis};

use crate::distortion::OnBoth;
use crate::distortion::detection_lines::DetectionLines;
use crate::error::EstimateError;
use crate::frf::FrfOptions;
use crate::frf::estimate::FrfEstimate;
use crate::frf::time_series::estimate_periods;
use crate::spectra::campaign::Campaign;
use crate::spectra::run_spectra::RunSpectra;
use crate::spectra::time_series::{TimeSeries, check_same_shape};

/// An input that has more than this on lines that are said not to be excited, over those that are, in dB, is excited
/// there.
const EXCITED_DB: f64 = -10.0;

/// As [`estimate_periods`], with the levels of distortion where `harmonics` leave lines out: `None` where these are not
/// odd multiples of their greatest common divisor, where they leave none out, and where the input is excited on others.
///
/// # Errors
/// As [`estimate_periods`].
pub fn estimate_with_distortion(
    u: ArrayView5<f64>,
    y: ArrayView5<f64>,
    r: Option<ArrayView5<f64>>,
    sample_time_s: f64,
    harmonics: &[usize],
    options: &FrfOptions,
) -> Result<(FrfEstimate, Option<Distortion>), EstimateError> {
    options.method.check_reference(r.is_some())?;
    let Some(lines) = DetectionLines::new(u.len_of(Axis(4)), harmonics)? else {
        let estimate = estimate_periods(u, y, r, sample_time_s, harmonics, options)?;
        return Ok((estimate, None));
    };
    let [mut excited, free] = lines.campaigns_of_periods(u, y, r, sample_time_s)?;
    let estimate = excited.estimate_draws(options)?;
    let levels = levels_beside(&estimate, [&excited, &free], &lines)?;
    Ok((estimate, Some(levels).filter(is_of_free_lines)))
}

/// Levels of runs on excited and on detection lines, with the estimate that the excited lines gave.
fn levels_beside(
    estimate: &FrfEstimate,
    [excited, free]: [&Campaign; 2],
    lines: &DetectionLines,
) -> Result<Distortion, EstimateError> {
    let spectra = OnBoth {
        excited,
        free,
        equal_draws: &estimate.equal_draws,
        n_glides: 0,
    };
    spectra.levels(lines, &estimate.frf)
}

/// Whether no input is excited on the lines that are said to be free.
fn is_of_free_lines(levels: &Distortion) -> bool {
    let is_quiet = |groups: &Vec<DistortionLevel>| {
        median_db(groups, |group| group.level).is_none_or(|db| db < EXCITED_DB)
    };
    let is_free = |signal: &SignalLevels| is_quiet(&signal.odd) && is_quiet(&signal.even);
    levels.inputs.iter().all(is_free)
}

impl DetectionLines {
    /// Campaigns on the excited lines, and on the detection lines of the first realizations.
    fn campaigns_of_periods(
        &self,
        u: ArrayView5<f64>,
        y: ArrayView5<f64>,
        r: Option<ArrayView5<f64>>,
        sample_time_s: f64,
    ) -> Result<[Campaign; 2], EstimateError> {
        check_same_shape(&u, &y, r.as_ref())?;
        let [mut excited, mut free] = self.campaigns(sample_time_s)?;
        let excited_dft = LazyLock::new(|| self.excited_dft());
        let series = TimeSeries { u, y, r };
        let runs = series.of_each(|place, u, y, r| {
            if !Self::look_at(place.realization) {
                let dft = excited_dft.as_ref().map_err(Clone::clone)?;
                return Ok((RunSpectra::of(dft, u, y, r)?, None));
            }
            let [on_excited, on_free] = self.spectra(u, y, r)?;
            Ok((on_excited, Some(on_free)))
        })?;
        for (place, (on_excited, on_free)) in runs {
            excited.insert(place, on_excited)?;
            if let Some(run) = on_free {
                free.insert(place, run)?;
            }
        }
        Ok([excited, free])
    }
}
