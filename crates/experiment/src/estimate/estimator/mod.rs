//! Estimator of the FRF of a plan from its records: record by record, in any order, so that no
//! campaign is too long for the memory.

mod distortion;
pub(crate) mod estimated;
mod friction;
mod friction_of_axes;
mod harmonics;
mod periods;
mod spectra;

use std::iter::zip;

use frfid_estimate::{
    Campaign, ChirpHarmonics, Evaluation, PeriodIndex, SweepSpectra, has_ripple_lines,
};
use frfid_signals::{Frf, Harmonics, Plan, Record, RunId, RunKind};
use ndarray::s;

use crate::description::estimate::{EstimateTable, GlideSubtraction};
use crate::error::ExperimentError;
use crate::estimate::estimator::distortion::DistortionOfRuns;
use crate::estimate::estimator::estimated::Estimated;
use crate::estimate::estimator::friction::{FrictionOfRuns, without_friction};
use crate::estimate::estimator::harmonics::harmonics_of_plan;
use crate::estimate::estimator::periods::Signals;
pub use crate::estimate::estimator::spectra::Spectra;
use crate::estimate::excerpt_bias::ExcerptBias;
use crate::estimate::glides::glide_baseline::Baseline;
use crate::estimate::glides::glide_spectra::{GlideSpectra, coherence};
use crate::estimate::glides::ripple_residual::{FreeSpectra, RippleResidual, is_looked_at};
use crate::estimate::unsettled::Unsettled;

/// Turns the records of one plan into spectra, and the spectra into an FRF.
pub struct Estimator {
    plan: Plan,
    period_samples: usize,
    options: EstimateTable,
    evaluation: Evaluation,
    baseline: Baseline,
    glides: GlideSpectra,
    residual: Option<RippleResidual>,
    bias: Option<ExcerptBias>,
    friction: Option<FrictionOfRuns>,
    harmonics: Option<ChirpHarmonics>,
    distortion: Option<DistortionOfRuns>,
}

impl Estimator {
    /// An estimator for the records of `plan`: DFT of the periods of a multisine on its excited
    /// lines, excerpts of a chirp.
    ///
    /// # Errors
    /// [`ExperimentError`] if the plan or the options do not hold together.
    pub fn new(plan: &Plan, options: &EstimateTable) -> Result<Self, ExperimentError> {
        plan.check()?;
        let options = options.in_plan(plan);
        let period_samples = plan.period_samples()?;
        let n_frequencies = options.n_frequencies;
        let evaluation = match options.method().local_model() {
            Some(_) => Evaluation::of_whole_records(plan, n_frequencies)?,
            None => Evaluation::of(plan, n_frequencies)?,
        };
        Ok(Self {
            plan: plan.clone(),
            period_samples,
            bias: ExcerptBias::of_plan(plan, options.method())?,
            evaluation,
            baseline: Baseline::None,
            glides: GlideSpectra::default(),
            residual: RippleResidual::of_plan(plan, &options)?,
            friction: FrictionOfRuns::of_plan(plan, &options)?,
            harmonics: harmonics_of_plan(plan)?,
            distortion: DistortionOfRuns::of_plan(plan, &options)?,
            options,
        })
    }

    /// The same with the records of the glides: what follows from them is taken off every record
    /// (SK15 section 4.4 E).
    ///
    /// # Errors
    /// [`ExperimentError::Logs`] if the plan has glides and none is given,
    /// [`ExperimentError::Signal`] if they differ in shape.
    pub fn with_glides(mut self, glides: &[&Record]) -> Result<Self, ExperimentError> {
        if self.options.glide_subtraction == GlideSubtraction::None || self.plan.n_glides == 0 {
            return Ok(self);
        }
        self.baseline = Baseline::of_glides(glides)?;
        if self.baseline == Baseline::None {
            return Err(ExperimentError::logs(
                "glide runs",
                "none that is readable and whole",
                format!("at least one of the plan's {}", self.plan.n_glides),
                "without them nothing can be subtracted; add their records",
            ));
        }
        for glide in glides {
            let periods =
                (0..self.n_complete(glide)).map(|period| self.period_of_glide(glide, period));
            self.glides.add(periods.collect::<Result<Vec<_>, _>>()?);
        }
        self.glides.show_ripple = self.shows_ripple();
        Ok(self)
    }

    /// Whether the mean glide has lines of ripple, in the period that is estimated.
    fn shows_ripple(&self) -> bool {
        let Baseline::Glide(glide) = &self.baseline else {
            return false;
        };
        let start = glide.n_samples().min(self.plan.lead_in_samples);
        has_ripple_lines(glide.u.slice(s![.., start..]))
    }

    /// Whether [`Estimator::with_ripple_of`] is needed before spectra are taken.
    #[must_use]
    pub fn learns_ripple(&self) -> bool {
        self.options.glide_subtraction == GlideSubtraction::Position
            && self.baseline != Baseline::None
    }

    /// The same with the ripple over the motor position, learnt from the glides and one run of
    /// every experiment of a realization: a first estimate of the plant tells what of the glide is
    /// ripple.
    ///
    /// # Errors
    /// [`ExperimentError`] for records that do not make an estimate.
    pub fn with_ripple_of(mut self, runs: &[(RunId, &Record)]) -> Result<Self, ExperimentError> {
        if self.learns_ripple() {
            let plant = self.frf_of(runs)?;
            self.baseline = self.baseline.with_ripple(&plant)?;
        }
        Ok(self)
    }

    /// Spectra of the complete periods of the record of run `id`, but for those that `lost` names.
    ///
    /// # Errors
    /// [`ExperimentError`] for samples that are not finite or a record that does not fit the plan.
    pub fn spectra(
        &self,
        id: RunId,
        record: &Record,
        lost: &dyn Fn(usize) -> bool,
    ) -> Result<Spectra, ExperimentError> {
        let is_flawed = (0..self.plan.n_periods).any(lost);
        if id.kind == RunKind::Glide || self.friction.is_some() && is_flawed {
            return Ok(Spectra::default()); // what is lost of a run says what friction was before it
        }
        let rest = self.baseline.subtract_from(record)?;
        let wander_s2 = self.baseline.wander_s2(record)?;
        let measured = rest.as_ref().unwrap_or(record);
        let (record, subtracted) = without_friction(self.friction.as_ref(), measured)?;
        let record = &*record;
        let periods = self.kept(record, lost);
        let mut spectra = Spectra {
            friction: Vec::from_iter(subtracted),
            signs: self.signs(record, &periods)?,
            wander_s2: vec![wander_s2],
            ..Spectra::default()
        };
        for period in periods {
            let place = self.place(id, period);
            if let Some(harmonics) = &self.harmonics {
                let signals = self.window(measured, period);
                let sweep = harmonics.spectra(signals.u, signals.y)?;
                spectra.sweeps.push((place, sweep));
            }
            self.add_period(&mut spectra, place, &self.window(record, period))?;
        }
        Ok(spectra)
    }

    /// Adds the spectra of a period, friction and glides taken off.
    fn add_period(
        &self,
        spectra: &mut Spectra,
        place: PeriodIndex,
        signals: &Signals,
    ) -> Result<(), ExperimentError> {
        let (on_lines, detection) = self.on_lines(place, signals)?;
        spectra.periods.push((place, on_lines));
        let detection = detection.map(|detection| (place, detection));
        spectra.detection.extend(detection);
        if let Some(bias) = &self.bias {
            let whole = bias.spectra(signals.u, signals.y)?;
            spectra.whole.push((place, whole));
        }
        let free = self.free(signals)?.filter(|_| is_looked_at(place));
        let free = free.map(|signals| FreeSpectra { place, signals });
        spectra.free.extend(free);
        Ok(())
    }

    /// The harmonics of all runs of a chirp.
    fn harmonics_of(&self, sweeps: &[(PeriodIndex, SweepSpectra)]) -> Option<Harmonics> {
        self.harmonics.as_ref()?.harmonics(sweeps)
    }

    /// The FRF of one record for each experiment.
    ///
    /// # Errors
    /// [`ExperimentError`] for records that do not make an estimate.
    pub fn frf_of_experiments(&self, records: &[Record]) -> Result<Frf, ExperimentError> {
        let ids = (0..).map(|experiment| RunId::excitation(0, experiment, 0));
        self.frf_of(&zip(ids, records).collect::<Vec<_>>())
    }

    /// The FRF of runs of which nothing is lost.
    fn frf_of(&self, runs: &[(RunId, &Record)]) -> Result<Frf, ExperimentError> {
        let mut spectra = Spectra::default();
        for (id, record) in runs {
            spectra.extend(self.spectra(*id, record, &|_| false)?);
        }
        Ok(self.estimate(spectra)?.frf)
    }

    /// The periods with the glides that were taken off them.
    fn campaign_of(&self, spectra: &Spectra) -> Result<Campaign, ExperimentError> {
        let mut campaign = self.evaluation.campaign()?;
        for (place, run) in &spectra.periods {
            campaign.insert(*place, run.clone())?;
        }
        for glide in &self.glides.on_lines {
            campaign.insert_glide(glide.clone())?;
        }
        campaign.set_glide_coherence(coherence(&spectra.wander_s2, campaign.frequency_hz()))?;
        Ok(campaign)
    }

    /// The FRF of all spectra; periods of which an experiment is missing are left out and named.
    ///
    /// # Errors
    /// [`ExperimentError`] if nothing remains, or U cannot be inverted.
    pub fn estimate(&self, mut spectra: Spectra) -> Result<Estimated, ExperimentError> {
        let of_friction = self.take_off_friction(&mut spectra)?;
        let mut campaign = self.campaign_of(&spectra)?;
        let missing = campaign.drop_incomplete();
        let mut estimate = campaign.estimate_draws(&self.options.frf_options())?;
        estimate.frf.relative_resolution = self.evaluation.relative_resolution;
        if let Some(bias) = &self.bias {
            bias.add_to(&mut estimate.frf, spectra.whole)?;
        }
        let (mut remarks, n_left_out) = (estimate.warnings(), estimate.left_out.len());
        let (noise_bias, frf) = (estimate.noise_bias, estimate.frf);
        remarks.extend(self.glides.remark(&frf));
        remarks.extend(of_friction);
        let repeats = match &self.residual {
            Some(residual) => residual.exceeds_noise(spectra.free, &self.glides.free, &frf)?,
            None => None,
        };
        let ripple = repeats.map(|exceeds| self.glides.attributed(exceeds, &mut remarks));
        let known = (&frf, &estimate.equal_draws[..], self.glides.on_lines.len());
        let distortion = match &self.distortion {
            Some(distortion) => distortion.levels(spectra.detection, &campaign, known)?,
            None => None,
        };
        Ok(Estimated {
            distortion,
            unsettled: Unsettled::of(&spectra.periods, &self.plan, &frf)?,
            response: self.options.loop_response(&campaign)?,
            frf,
            remarks,
            n_left_out,
            noise_bias,
            missing,
            ripple,
            harmonics: self.harmonics_of(&spectra.sweeps),
        })
    }
}
