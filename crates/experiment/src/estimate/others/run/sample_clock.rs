//! Sample clock of a run: whether its samples are even, and how long the player's period is on the
//! recorder's clock.

use frfid_estimate::{ClockRatio, EstimateError, RunPeriods, find_clock_ratio, unexcited_lines};
use ndarray::{Array2, Axis, concatenate, stack};
use num_complex::Complex64;

use crate::estimate::others::recording::Recording;
use crate::estimate::others::run::Run;
use crate::estimate::others::run::measured::Signals;

/// Two clocks are told from each other at so many standard errors: 6e-7 by chance.
const SURE: f64 = 5.0;
/// .. and where they differ by more than one part per million: below three, no line of a usual period
/// is off by a thousandth.
const HARMLESS: f64 = 1e-6;

/// The sample clock of a run.
#[derive(Clone)]
pub(in crate::estimate::others) struct SampleClock {
    pub(in crate::estimate::others) sample_time_s: f64,
    /// Period in samples, not necessarily whole.
    pub(in crate::estimate::others) period: f64,
    /// By how much the player's clock is fast against the recorder's in parts per million, where
    /// the period shows it.
    pub(in crate::estimate::others) ppm: Option<f64>,
    /// Where the samples are, in samples of an even clock; `None` where they are even.
    positions: Option<Vec<f64>>,
    /// Lines that are in the signals without being excited, for periods that are not whole.
    also: Vec<usize>,
}

impl SampleClock {
    /// The clock by which the signals repeat best.
    ///
    /// # Errors
    /// [`EstimateError`] for lines off the grid of the period.
    pub(in crate::estimate::others) fn of(
        recording: &Recording,
        run: &Run,
        signals: &Signals,
    ) -> Result<Self, EstimateError> {
        let even = Self {
            sample_time_s: recording.log.record.sample_time_s,
            period: run.period.round(),
            ppm: None,
            positions: None,
            also: Vec::new(),
        };
        let positions = recording.positions(&run.samples);
        if positions.is_none() && signals.is_whole() && run.period == even.period {
            return even.with_ratio(signals, run);
        }
        let also = distortion(signals, run)?;
        let even = Self { also, ..even };
        match positions {
            Some(positions) => even.or_stamped(positions, signals, run),
            None => even.with_ratio(signals, run),
        }
    }

    /// This even clock or the stamps, whichever lets the signals repeat better.
    fn or_stamped(
        self,
        positions: Vec<f64>,
        signals: &Signals,
        run: &Run,
    ) -> Result<Self, EstimateError> {
        let stamped = Self {
            positions: Some(positions),
            ..self.clone()
        };
        let (even, stamped) = (
            self.with_ratio(signals, run)?,
            stamped.with_ratio(signals, run)?,
        );
        let is_better = stamped.spread(signals, run)? < even.spread(signals, run)?;
        Ok(if is_better { stamped } else { even })
    }

    /// The same with the period that the turn of the reference from period to period tells.
    fn with_ratio(self, signals: &Signals, run: &Run) -> Result<Self, EstimateError> {
        let periods = self.periods(signals, &run.lines)?;
        let spectra = periods.all_spectra("reference", signals.reference())?;
        let found = self.ratio(&spectra, &run.lines)?;
        Ok(match found.filter(|found| matters(found, self.period)) {
            None => self,
            Some(found) => Self {
                period: found.period_samples,
                ppm: Some(1e6 * (self.period / found.period_samples - 1.0)),
                ..self
            },
        })
    }

    /// What the longest stretch of periods without losses says of the clocks.
    fn ratio(
        &self,
        spectra: &[Option<Array2<Complex64>>],
        lines: &[usize],
    ) -> Result<Option<ClockRatio>, EstimateError> {
        let stretch: Vec<_> = longest_stretch(spectra)
            .map(|spectra| spectra.view())
            .collect();
        match stack(Axis(0), &stretch) {
            Ok(spectra) => find_clock_ratio(spectra.view(), lines, self.period as usize),
            Err(_) => Ok(None),
        }
    }

    /// Period in s.
    pub(in crate::estimate::others) fn period_s(&self) -> f64 {
        self.period * self.sample_time_s
    }

    /// The periods of the run by this clock.
    ///
    /// # Errors
    /// [`EstimateError`] for lines off the grid of the period.
    pub(in crate::estimate::others) fn periods(
        &self,
        signals: &Signals,
        lines: &[usize],
    ) -> Result<RunPeriods, EstimateError> {
        let samples = 0..signals.u.ncols();
        RunPeriods::new(
            samples,
            self.period,
            self.positions.as_deref(),
            lines,
            &self.also,
        )
    }

    /// How far the periods of reference and outputs are from their mean, in power, each signal over
    /// its own.
    fn spread(&self, signals: &Signals, run: &Run) -> Result<f64, EstimateError> {
        let periods = self.periods(signals, &run.lines)?;
        let mut spread = 0.0;
        for signal in [signals.reference(), signals.y] {
            spread += relative_spread(&periods.all_spectra("signal", signal)?);
        }
        Ok(spread)
    }
}

/// Whether a difference of two clocks is beyond doubt and does harm.
fn matters(found: &ClockRatio, n_samples: f64) -> bool {
    let difference = (found.period_samples - n_samples).abs();
    difference > (SURE * found.standard_error_samples).max(HARMLESS * n_samples)
}

/// The periods of the longest stretch of which none is lost.
fn longest_stretch(
    periods: &[Option<Array2<Complex64>>],
) -> impl Iterator<Item = &Array2<Complex64>> {
    let stretches = periods.chunk_by(|a, b| a.is_some() == b.is_some());
    let present = stretches.filter(|stretch| stretch.iter().all(Option::is_some));
    let longest = present.max_by_key(|stretch| stretch.len());
    longest.into_iter().flatten().flatten()
}

/// Lines that stand out in input and output without being excited.
fn distortion(signals: &Signals, run: &Run) -> Result<Vec<usize>, EstimateError> {
    let both = concatenate(Axis(0), &[signals.u, signals.y]);
    let both = both.expect("signals of one run are equally long");
    unexcited_lines(both.view(), run.period, &run.lines)
}

/// Mean square distance of spectra from their mean, over its square.
fn relative_spread(spectra: &[Option<Array2<Complex64>>]) -> f64 {
    let present: Vec<&Array2<Complex64>> = spectra.iter().flatten().collect();
    let Some(mean) = mean(&present) else {
        return 0.0;
    };
    let distances = present.iter().map(|spectrum| power(&(*spectrum - &mean)));
    distances.sum::<f64>() / power(&mean).max(f64::MIN_POSITIVE)
}

fn mean(spectra: &[&Array2<Complex64>]) -> Option<Array2<Complex64>> {
    let (first, rest) = spectra.split_first()?;
    let sum = rest
        .iter()
        .fold((*first).clone(), |sum, spectrum| sum + *spectrum);
    Some(sum / Complex64::from(spectra.len() as f64))
}

fn power(spectrum: &Array2<Complex64>) -> f64 {
    spectrum.iter().map(Complex64::norm_sqr).sum()
}

impl Recording {
    /// Where the samples of a run are, in samples of an even clock from the first on; `None` where
    /// they are even.
    fn positions(&self, samples: &std::ops::Range<usize>) -> Option<Vec<f64>> {
        let step_s = self.log.record.sample_time_s;
        let times_s = self.log.times_s.as_ref()?.get(samples.clone())?;
        let first_s = times_s.first()?;
        let from_first = times_s.iter().map(|time_s| (time_s - first_s) / step_s);
        Some(from_first.collect())
    }
}
