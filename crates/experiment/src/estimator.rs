//! From the records of a plan to its FRF: record by record, in any order, so that no campaign is too long for the memory.

use ndarray::{Array2, s};

use frfid_estimate::{
    BlaOptions, Campaign, ExcerptOptions, Excerpts, LineDft, Place, RunSpectra, Transform, subtract_glide,
};
use frfid_signals::{Excitation, Frf, Plan, Record, RunId, RunKind, SignalError};

use crate::ExperimentError;
use crate::config::EstimateTable;

/// Turns the records of one plan into spectra, and the spectra into an FRF.
pub struct Estimator {
    plan: Plan,
    period_samples: usize,
    options: EstimateTable,
    frequency_hz: Vec<f64>,
    transform: Box<dyn Transform>,
    glide: Option<Record>,
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
            glide: None,
            relative_resolution,
        })
    }

    /// Takes the records of the glides; their mean is subtracted from every record that follows (SK15 section 4.4 E).
    ///
    /// # Errors
    /// [`ExperimentError::Signal`] if they differ in shape.
    pub fn set_glides(&mut self, glides: &[Record]) -> Result<(), ExperimentError> {
        let Some(first) = glides.first() else { return Ok(()) };
        let mean = |name, signal: &dyn Fn(&Record) -> &Array2<f64>| {
            let mut sum = Array2::zeros(signal(first).dim());
            for glide in glides {
                if signal(glide).dim() != sum.dim() {
                    let needed = format!("{:?}, as in the first glide", sum.shape());
                    return Err(SignalError::Shape { name, found: signal(glide).shape().to_vec(), needed });
                }
                sum += signal(glide);
            }
            Ok(sum / glides.len() as f64)
        };
        let (u, y) = (mean("u of a glide", &|glide| &glide.u)?, mean("y of a glide", &|glide| &glide.y)?);
        self.glide = Some(Record { u, y, ..first.clone() });
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
        let glided = self.glide.as_ref().map(|glide| subtract_glide(record, glide)).transpose()?;
        let record = glided.as_ref().unwrap_or(record);
        let complete = record.n_samples().saturating_sub(self.plan.lead_in_samples) / self.period_samples;
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
