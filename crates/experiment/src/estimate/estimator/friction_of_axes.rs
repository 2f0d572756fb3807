//! Friction of several axes: told from all runs of a plan together, taken off their spectra.

use std::iter::zip;

use frfid_estimate::{
    AxisFriction, EstimateError, FrictionOfAxes, FrictionSpectra, PeriodIndex, RunSpectra,
    Transform, find_friction_of_axes, mean_signs,
};
use frfid_signals::Record;
use frfid_signals::format::significant;
use ndarray::Array2;
use num_complex::Complex64;

use crate::error::ExperimentError;
use crate::estimate::estimator::friction::remark;
use crate::estimate::estimator::{Estimator, Spectra};

/// Share of the time in which a motor that sticks decides more than the band excites.
pub(super) const MOST_STUCK: f64 = 0.4;
/// What is said then.
pub(super) const STICKS: &str =
    "; it sticks too long for that to be trusted, excite it more strongly";
/// Friction that differs over the band by more than this share of it is not Coulomb's alone, or hidden by sticking.
const MOST_BETWEEN_BANDS: f64 = 0.12;

/// What no spread over runs or bands shows.
const UNSEEN: &str = "the torque of axes that stick is not known and counts as none: neither the standard errors of the \
                      friction nor the uncertainty of the FRF hold what that costs, which is more the weaker the excitation";

/// Spectra of signs, period by period.
type Signs = Vec<Array2<Complex64>>;

/// What runs say of the friction of several axes.
#[derive(Debug, Clone, Default)]
pub(super) struct FrictionSigns {
    runs: Vec<FrictionSpectra>,
    /// On the lines of the estimate.
    periods: Signs,
    /// On the lines of whole chirps.
    whole: Signs,
}

impl FrictionSigns {
    /// What a whole run says; the signs of its periods come later.
    pub(super) fn of(record: &Record, band_hz: [f64; 2]) -> Result<Self, EstimateError> {
        let (u, y) = (record.u.view(), record.y.view());
        Ok(Self {
            runs: vec![FrictionSpectra::of(u, y, record.sample_time_s, band_hz)?],
            ..Self::default()
        })
    }

    pub(super) fn extend(&mut self, other: Self) {
        self.runs.extend(other.runs);
        self.periods.extend(other.periods);
        self.whole.extend(other.whole);
    }

    /// Takes the friction off the periods on `hz` and the whole chirps on `whole_hz`; `None` without runs.
    ///
    /// # Errors
    /// [`EstimateError`] where it is not found.
    pub(super) fn take_off(
        &self,
        (periods, hz): (&mut [(PeriodIndex, RunSpectra)], &[f64]),
        (whole, whole_hz): (&mut [(PeriodIndex, RunSpectra)], &[f64]),
    ) -> Result<Option<FrictionOfAxes>, ExperimentError> {
        if self.runs.is_empty() {
            return Ok(None);
        }
        let friction = find_friction_of_axes(&self.runs)?;
        for ((_, run), signs) in zip(periods, &self.periods) {
            friction.take_off(&mut run.u, signs.view(), hz)?;
        }
        for ((_, run), signs) in zip(whole, &self.whole) {
            friction.take_off(&mut run.u, signs.view(), whole_hz)?;
        }
        Ok(Some(friction))
    }
}

impl Estimator {
    /// What periods of a run say of the friction of several axes; nothing where that is not asked for.
    pub(super) fn signs(
        &self,
        record: &Record,
        periods: &[usize],
    ) -> Result<FrictionSigns, ExperimentError> {
        let of_run = self.friction.map(|friction| friction.signs(record));
        let Some(mut of_run) = of_run.transpose()?.flatten() else {
            return Ok(FrictionSigns::default());
        };
        let signs = mean_signs(record.y.view());
        for &period in periods {
            let signs = self.of_period(&signs, period);
            let on_lines = self.evaluation.transform.transform("signs", signs)?;
            of_run.periods.push(on_lines);
            if let Some(bias) = &self.bias {
                of_run.whole.push(bias.whole.transform("signs", signs)?);
            }
        }
        Ok(of_run)
    }

    /// Takes the friction of several axes off; says in words what it was, and that of one axis.
    pub(super) fn take_off_friction(
        &self,
        spectra: &mut Spectra,
    ) -> Result<Vec<String>, ExperimentError> {
        let whole_hz = self.bias.as_ref();
        let whole_hz = whole_hz.map_or(&[][..], |bias| bias.whole.frequency_hz());
        let periods = (&mut spectra.periods[..], &self.evaluation.frequency_hz[..]);
        let whole = (&mut spectra.whole[..], whole_hz);
        let friction = spectra.signs.take_off(periods, whole)?;
        let of_one = remark(&spectra.friction).into_iter();
        Ok(of_one.chain(friction.iter().flat_map(remarks)).collect())
    }
}

/// How much friction was taken off each axis, how sure that is, and why not to trust it.
pub(super) fn remarks(friction: &FrictionOfAxes) -> impl Iterator<Item = String> {
    let axes = friction.axes.iter().enumerate();
    let remarks = axes.map(|(axis, friction)| remark_of(axis + 1, friction));
    remarks.chain([UNSEEN.into()])
}

fn remark_of(axis: usize, friction: &AxisFriction) -> String {
    let coulomb_nm = significant(friction.coulomb_nm, 4);
    let error_nm = significant(friction.standard_error_nm, 2);
    if !friction.is_significant() {
        return format!(
            "axis {axis}: Coulomb friction of {coulomb_nm} N m with a standard error of {error_nm} N m may be none, and \
             nothing was taken off the torque; excite it more strongly if it has some"
        );
    }
    format!(
        "axis {axis}: Coulomb friction of {coulomb_nm} N m was taken off the torque, its standard error {error_nm} N m; it \
         does not slip in {} % of the time{}",
        significant(100.0 * friction.stuck_share, 2),
        doubt(friction)
    )
}

fn doubt(friction: &AxisFriction) -> String {
    let between = friction.between_bands_nm / friction.coulomb_nm;
    if friction.stuck_share > MOST_STUCK {
        STICKS.into()
    } else if between > MOST_BETWEEN_BANDS {
        format!(
            "; it differs over the band by {} % of itself, too much for that to be trusted: excite it more strongly, or \
             in more experiments",
            significant(100.0 * between, 2)
        )
    } else {
        String::new()
    }
}
