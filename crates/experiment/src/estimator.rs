//! From the records of a plan to its FRF: record by record, in any order, so that no campaign is too long for the memory.

use ndarray::s;

use frfid_estimate::{
    BlaOptions, Campaign, ExcerptOptions, Excerpts, LineDft, Place, RunSpectra, Transform,
};
use frfid_signals::{Excitation, Frf, Plan, Record, RunId, RunKind, SignalError};

use crate::ExperimentError;
use crate::baseline::Baseline;
use crate::config::{EstimateTable, GlideSubtraction};

/// Turns the records of one plan into spectra, and the spectra into an FRF.
pub struct Estimator {
    plan: Plan,
    period_samples: usize,
    options: EstimateTable,
    frequency_hz: Vec<f64>,
    transform: Box<dyn Transform>,
    baseline: Baseline,
    /// That of excerpts; none for lines.
    relative_resolution: Option<f64>,
}

/// The spectra of the periods of one record.
pub type PeriodSpectra = Vec<(Place, RunSpectra)>;

impl Estimator {
    /// An estimator for the records of `plan`: DFT of the periods of a multisine on its excited lines, excerpts of a chirp.
    ///
    /// # Errors
    /// [`ExperimentError`] if the plan or the options do not hold together.
    pub fn new(plan: &Plan, options: &EstimateTable) -> Result<Self, ExperimentError> {
        plan.check()?;
        let period_samples = plan.period_samples()?;
        let (frequency_hz, transform, relative_resolution): (Vec<f64>, Box<dyn Transform>, Option<f64>) =
            match &plan.excitation {
                Excitation::Multisine { signal, .. } => {
                    let dft = LineDft::new(period_samples, &signal.grid.excited)?;
                    (dft.frequency_hz(plan.sample_time_s)?, Box::new(dft), None)
                }
                Excitation::Chirp(chirp) => {
                    let hz = log_spaced(chirp.low_hz, chirp.high_hz, options.n_frequencies)?;
                    let cut = ExcerptOptions::default();
                    let excerpts = Excerpts::new(chirp, &hz, plan.sample_time_s, 0.0, period_samples, &cut)?;
                    (hz, Box::new(excerpts), Some(cut.relative_resolution()))
                }
            };
        Ok(Self {
            plan: plan.clone(),
            period_samples,
            options: options.clone(),
            frequency_hz,
            transform,
            baseline: Baseline::None,
            relative_resolution,
        })
    }

    /// Takes the records of the glides: what follows from them is taken off every record from then on (SK15 section 4.4 E).
    ///
    /// # Errors
    /// [`ExperimentError::Signal`] if they differ in shape.
    pub fn set_glides(&mut self, glides: &[Record]) -> Result<(), ExperimentError> {
        if self.options.glide_subtraction != GlideSubtraction::None {
            self.baseline = Baseline::of_glides(glides)?;
        }
        Ok(())
    }

    /// Whether [`Estimator::learn_ripple`] is to be called after the glides are set.
    #[must_use]
    pub fn learns_ripple(&self) -> bool {
        self.options.glide_subtraction == GlideSubtraction::Position && self.baseline != Baseline::None
    }

    /// Learns the ripple over the motor position from the glides and one run of every experiment of a realization: a first
    /// estimate of the plant tells what of the glide is ripple, and with that off the second estimate tells it better.
    ///
    /// # Errors
    /// [`ExperimentError`] for records that do not make an estimate.
    pub fn learn_ripple(&mut self, runs: &[(RunId, Record)]) -> Result<(), ExperimentError> {
        const PASSES: usize = 2;
        for _ in 0..PASSES {
            let spectra = runs.iter().map(|(id, record)| self.spectra(*id, record, &|_| false));
            let spectra = spectra.collect::<Result<Vec<_>, _>>()?.concat();
            let (plant, _) = self.estimate(spectra)?;
            self.baseline = self.baseline.with_ripple(&plant)?;
        }
        Ok(())
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
    ) -> Result<PeriodSpectra, ExperimentError> {
        if id.kind == RunKind::Glide {
            return Ok(Vec::new());
        }
        let rest = self.baseline.subtract_from(record)?;
        let record = rest.as_ref().unwrap_or(record);
        let complete = record.n_steady_samples().saturating_sub(self.plan.lead_in_samples) / self.period_samples;
        let periods = (0..complete.min(self.plan.n_periods)).filter(|&period| !lost(period));
        periods.map(|period| Ok((self.place(id, period), self.period_spectra(record, period)?))).collect()
    }

    /// Place of a period in the campaign: repetitions and periods back to back together are the estimator's periods.
    fn place(&self, id: RunId, period: usize) -> Place {
        let period = id.repetition * self.plan.n_periods + period;
        Place { realization: id.realization, period, experiment: id.experiment }
    }

    fn period_spectra(&self, record: &Record, period: usize) -> Result<RunSpectra, ExperimentError> {
        let start = self.plan.lead_in_samples + period * self.period_samples;
        let window = s![.., start..start + self.period_samples];
        let r = record.r.as_ref().filter(|_| self.options.indirect).map(|r| r.slice(window));
        Ok(RunSpectra::of(&*self.transform, record.u.slice(window), record.y.slice(window), r)?)
    }

    /// The FRF of one record for each experiment.
    ///
    /// # Errors
    /// [`ExperimentError`] for records that do not make an estimate.
    pub fn frf_of_experiments(&self, records: &[Record]) -> Result<Frf, ExperimentError> {
        let spectra = records.iter().enumerate().map(|(experiment, record)| {
            let id = RunId { kind: RunKind::Excitation, realization: 0, experiment, repetition: 0 };
            self.spectra(id, record, &|_| false)
        });
        Ok(self.estimate(spectra.collect::<Result<Vec<_>, _>>()?.concat())?.0)
    }

    /// The FRF of all spectra; periods of which an experiment is missing are left out and named.
    ///
    /// # Errors
    /// [`ExperimentError`] if nothing remains, or U cannot be inverted.
    pub fn estimate(&self, spectra: PeriodSpectra) -> Result<(Frf, Vec<Place>), ExperimentError> {
        let mut campaign = Campaign::new(self.frequency_hz.clone())?;
        for (place, run) in spectra {
            campaign.insert(place, run)?;
        }
        let missing = campaign.drop_incomplete();
        let options = BlaOptions { averaging: self.options.average.into(), ..BlaOptions::default() };
        let frf = campaign.estimate(&options)?;
        Ok((Frf { relative_resolution: self.relative_resolution, ..frf }, missing))
    }
}

/// `count` frequencies from `low_hz` to `high_hz`, logarithmically spaced, both ends included.
///
/// # Errors
/// [`ExperimentError::Signal`] for fewer than two.
pub fn log_spaced(low_hz: f64, high_hz: f64, count: usize) -> Result<Vec<f64>, ExperimentError> {
    if count < 2 {
        let needed = "at least 2";
        return Err(SignalError::Parameter { name: "n_frequencies", found: count as f64, needed }.into());
    }
    let last = (count - 1) as f64;
    let between = (1..count - 1).map(|index| low_hz * (high_hz / low_hz).powf(index as f64 / last));
    Ok(std::iter::once(low_hz).chain(between).chain(std::iter::once(high_hz)).collect())
}
