//! Measurement of a run: the spectra of its periods, trends taken off, transient periods dropped.

use std::ops::Range;

use frfid_estimate::{EstimateError, RunSpectra, Settling, judge_settling, without_input_changes};
use frfid_signals::Frf;
use frfid_signals::format::{count, significant};
use frfid_signals::power::{about_mean, rms};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, s};
use num_complex::Complex64;

use crate::error::ExperimentError;
use crate::estimate::others::recording::{Recording, Role};
use crate::estimate::others::run::Run;
use crate::estimate::others::run::sample_clock::SampleClock;
use crate::estimate::others::run::settled::{Search, TrendOf};

/// What a run says.
pub(in crate::estimate::others) struct Measured {
    /// Place of the recording among those that are looked at.
    pub(in crate::estimate::others) recording: usize,
    /// Place of the recording among all that were given.
    pub(in crate::estimate::others) place: usize,
    /// Name of the recording.
    pub(in crate::estimate::others) name: String,
    /// Spectra of the periods that are used.
    pub(in crate::estimate::others) spectra: Vec<RunSpectra>,
    /// The clocks of player and recorder.
    pub(in crate::estimate::others) clock: SampleClock,
    /// Periods in the run.
    pub(in crate::estimate::others) n_periods: usize,
    /// Periods of which too little is there to tell the lines apart.
    pub(in crate::estimate::others) n_lost: usize,
    /// Whether the rest has settled; `None` where too few periods tell.
    pub(in crate::estimate::others) settling: Option<Settling>,
    /// Whether the first half of the periods differs from the rest.
    pub(in crate::estimate::others) never_settles: bool,
    /// Leading periods that were dropped as transient.
    pub(in crate::estimate::others) n_transient: usize,
    /// Trends that were taken off.
    pub(in crate::estimate::others) trends: Vec<TrendOf>,
    /// Rms of each input about its mean.
    pub(in crate::estimate::others) u_rms: Vec<f64>,
}

/// The signals of a run.
pub(in crate::estimate::others) struct Signals<'a> {
    pub(in crate::estimate::others) u: ArrayView2<'a, f64>,
    pub(in crate::estimate::others) y: ArrayView2<'a, f64>,
    pub(in crate::estimate::others) r: Option<ArrayView2<'a, f64>>,
}

impl<'a> Signals<'a> {
    /// Those of a stretch of a recording.
    fn of(recording: &'a Recording, samples: &Range<usize>) -> Self {
        let record = &recording.log.record;
        let run = s![.., samples.clone()];
        Self {
            u: record.u.slice(run),
            y: record.y.slice(run),
            r: record.r.as_ref().map(|r| r.slice(run)),
        }
    }

    /// The reference, or the input where none was recorded.
    pub(in crate::estimate::others) fn reference(&self) -> ArrayView2<'a, f64> {
        self.r.unwrap_or(self.u)
    }

    /// Whether no sample is lost.
    pub(in crate::estimate::others) fn is_whole(&self) -> bool {
        let signals = [Some(&self.u), Some(&self.y), self.r.as_ref()];
        let mut samples = signals.into_iter().flatten().flatten();
        samples.all(|sample| sample.is_finite())
    }
}

impl Measured {
    /// Measures a run.
    ///
    /// # Errors
    /// [`ExperimentError::Recording`] for a run that never settles, and lines off its grid.
    pub(in crate::estimate::others) fn of(
        recording: &Recording,
        run: &Run,
    ) -> Result<Self, ExperimentError> {
        let signals = Signals::of(recording, &run.samples);
        let measured = Self::of_signals(recording, run, &signals);
        measured.map_err(recording.complaint())
    }

    fn of_signals(
        recording: &Recording,
        run: &Run,
        signals: &Signals,
    ) -> Result<Self, EstimateError> {
        let clock = SampleClock::of(recording, run, signals)?;
        let periods = clock.periods(signals, &run.lines)?;
        let search = Search {
            signals,
            periods: &periods,
            period: clock.period,
            lines: &run.lines,
        };
        let settled = search.settled()?;
        let used = settled.n_transient..periods.n_periods();
        let spectra = used
            .clone()
            .map(|period| settled.spectra(signals, &periods, period));
        let spectra: Vec<RunSpectra> = spectra
            .flat_map(Result::transpose)
            .collect::<Result<_, _>>()?;
        Ok(Self {
            recording: run.recording,
            place: recording.place,
            name: run.name(recording),
            n_lost: used.len() - spectra.len(),
            spectra,
            clock,
            n_periods: periods.n_periods(),
            u_rms: signals.u.rows().into_iter().map(level).collect(),
            n_transient: settled.n_transient,
            settling: None,
            never_settles: false,
            trends: settled.trends,
        })
    }

    /// Judges whether the periods that are used have settled, but for what changes of the input
    /// explain.
    ///
    /// # Errors
    /// [`ExperimentError`] for spectra that are not finite.
    pub(in crate::estimate::others) fn judge(
        &mut self,
        frf: &Frf,
        lines: &[usize],
    ) -> Result<(), ExperimentError> {
        let rest = without_input_changes(&self.spectra, frf).into_iter();
        let rest: Vec<Option<Array2<Complex64>>> = rest.map(Some).collect();
        match judge_settling(&rest, lines) {
            Ok(settling) => self.settling = settling,
            Err(EstimateError::NotSettled { .. }) => self.never_settles = true,
            Err(error) => return Err(error.into()),
        }
        Ok(())
    }

    /// Number of periods that are used.
    pub(in crate::estimate::others) fn n_used(&self) -> usize {
        self.spectra.len()
    }

    /// The line that is settled least, in words.
    pub(in crate::estimate::others) fn unsettled_words(&self) -> String {
        let unsettled = self
            .settling
            .iter()
            .flat_map(|settling| &settling.unsettled);
        let n_lines = unsettled.clone().count();
        let worst = unsettled.max_by(|a, b| a.bias_over_noise.total_cmp(&b.bias_over_noise));
        let Some(worst) = worst else {
            return String::new();
        };
        format!(
            "{} of {}, worst {} Hz by {} times its noise ({} % of the line)",
            count(n_lines, "line"),
            self.name,
            significant(worst.line as f64 / self.clock.period_s(), 4),
            significant(worst.bias_over_noise, 2),
            significant(100.0 * worst.bias_over_line, 2)
        )
    }

    /// How the clocks of player and recorder differ, where it shows.
    pub(in crate::estimate::others) fn clock_words(&self) -> Option<String> {
        let ppm = self.clock.ppm?;
        Some(format!(
            "{}: the period is {} samples, not a whole number: the recorder's clock differs from the player's by {} ppm; the lines \
             are fitted at the true times",
            self.name,
            significant(self.clock.period, 9),
            significant(ppm, 3)
        ))
    }

    /// Names the signals of the trends.
    pub(in crate::estimate::others) fn trend_words(&self, recording: &Recording) -> Vec<String> {
        let words = |trend: &TrendOf| {
            let signal = recording.name_of(trend.role, trend.channel);
            format!(
                "{}: {signal} {}",
                self.name,
                trend.words(self.clock.sample_time_s)
            )
        };
        self.trends.iter().map(words).collect()
    }
}

/// Rms about the mean of the samples that are there.
fn level(signal: ArrayView1<f64>) -> f64 {
    let present = signal.iter().copied().filter(|sample| sample.is_finite());
    rms(&about_mean(Array1::from_iter(present).view()))
}

impl Recording {
    /// What a signal is called.
    pub(in crate::estimate::others) fn name_of(&self, role: Role, channel: usize) -> String {
        let names: &[String] = match role {
            Role::Input => &self.log.input_names,
            Role::Output => &self.log.output_names,
            Role::Reference | Role::Position => &[],
        };
        names
            .get(channel)
            .cloned()
            .unwrap_or_else(|| role.name_of(channel))
    }
}
