//! Settled part of a run: transient periods dropped, trends that every period shares taken off.

use frfid_estimate::{
    EstimateError, RunPeriods, RunSpectra, Settling, Trend, find_trend, judge_settling,
};
use frfid_signals::format::significant;
use ndarray::{Array2, ArrayView2, s};
use num_complex::Complex64;

use crate::estimate::others::recording::Role;
use crate::estimate::others::run::Run;
use crate::estimate::others::run::measured::Signals;
use crate::estimate::others::run::sample_clock::SampleClock;

/// A trend in one channel.
pub(in crate::estimate::others) struct TrendOf {
    pub(in crate::estimate::others) role: Role,
    pub(in crate::estimate::others) channel: usize,
    trend: Trend,
}

/// A run whose trends are known, and which of its periods are used.
pub(in crate::estimate::others) struct Settled {
    pub(in crate::estimate::others) n_transient: usize,
    pub(in crate::estimate::others) settling: Option<Settling>,
    pub(in crate::estimate::others) trends: Vec<TrendOf>,
    /// Inputs and outputs without their trends, from the first used period on; `None` where there is
    /// none.
    straight: Option<[Array2<f64>; 2]>,
}

impl Settled {
    /// Drops what is transient and takes trends off the rest. Where periods never settle, or only
    /// with further periods dropped, a trend of the whole run is tried first.
    ///
    /// # Errors
    /// [`EstimateError::NotSettled`].
    pub(in crate::estimate::others) fn of(
        signals: &Signals,
        periods: &RunPeriods,
        clock: &SampleClock,
        run: &Run,
    ) -> Result<Self, EstimateError> {
        let judged = judge(periods, signals.y, &run.lines);
        let is_plain = |settling: &Option<Settling>| {
            settling
                .as_ref()
                .is_none_or(|s| s.unsettled.is_empty() && s.decay_periods.is_none())
        };
        if let Ok(settling) = &judged
            && is_plain(settling)
        {
            let n_transient = settling.as_ref().map_or(0, |settling| settling.n_transient);
            return Self::without_trends(signals, periods, clock, run, n_transient);
        }
        let straightened = Self::without_trends(signals, periods, clock, run, 0);
        match (straightened, judged) {
            (Ok(settled), judged) if is_better(&settled, &judged) => Ok(settled),
            (_, Ok(settling)) => {
                let n_transient = settling.as_ref().map_or(0, |settling| settling.n_transient);
                Self::without_trends(signals, periods, clock, run, n_transient)
            }
            (_, Err(error)) => Err(error),
        }
    }

    /// The run from a period on, without its trends.
    fn without_trends(
        signals: &Signals,
        periods: &RunPeriods,
        clock: &SampleClock,
        run: &Run,
        n_transient: usize,
    ) -> Result<Self, EstimateError> {
        let from = periods.first_sample(n_transient);
        let mut straight = [signals.u, signals.y].map(|signal| signal.to_owned());
        let mut trends = Vec::new();
        for (role, signal) in [Role::Input, Role::Output].into_iter().zip(&mut straight) {
            let mut used = signal.slice_mut(s![.., from..]);
            for (channel, mut samples) in used.rows_mut().into_iter().enumerate() {
                if let Some(trend) = find_trend(samples.view(), clock.period, &run.lines)? {
                    trend.subtract_from(samples.view_mut());
                    trends.push(TrendOf {
                        role,
                        channel,
                        trend,
                    });
                }
            }
        }
        let settling = judge(periods, straight[1].view(), &run.lines)?;
        let dropped = settling.as_ref().map_or(0, |settling| settling.n_transient);
        Ok(Self {
            n_transient: n_transient.max(dropped),
            settling,
            straight: (!trends.is_empty()).then_some(straight),
            trends,
        })
    }

    /// Spectra of a period; `None` where too little of it is there.
    ///
    /// # Errors
    /// Those of [`RunPeriods::spectra`].
    pub(in crate::estimate::others) fn spectra(
        &self,
        signals: &Signals,
        periods: &RunPeriods,
        period: usize,
    ) -> Result<Option<RunSpectra>, EstimateError> {
        let [u, y] = match &self.straight {
            Some([u, y]) => [u.view(), y.view()],
            None => [signals.u, signals.y],
        };
        let r = signals.r.map(|r| periods.spectra("r", r, period));
        let r = match r.transpose()? {
            Some(None) => return Ok(None),
            r => r.flatten(),
        };
        let spectra = (
            periods.spectra("u", u, period)?,
            periods.spectra("y", y, period)?,
        );
        Ok(match spectra {
            (Some(u), Some(y)) => Some(RunSpectra { u, y, r }),
            _ => None,
        })
    }
}

/// Whether a run without its trends has settled, with no more periods dropped than otherwise.
fn is_better(settled: &Settled, judged: &Result<Option<Settling>, EstimateError>) -> bool {
    let is_settled = |settling: &Settling| settling.unsettled.is_empty();
    let n_otherwise = match judged {
        Ok(Some(settling)) => settling.n_transient,
        _ => usize::MAX,
    };
    !settled.trends.is_empty()
        && settled.settling.as_ref().is_some_and(is_settled)
        && settled.n_transient <= n_otherwise
}

/// Whether the periods of the outputs have settled; `None` where too few tell.
fn judge(
    periods: &RunPeriods,
    y: ArrayView2<f64>,
    lines: &[usize],
) -> Result<Option<Settling>, EstimateError> {
    let spectra = (0..periods.n_periods()).map(|period| periods.spectra("y", y, period));
    let spectra: Vec<Option<Array2<Complex64>>> = spectra.collect::<Result<_, _>>()?;
    judge_settling(&spectra, lines)
}

impl TrendOf {
    /// The trend in words, behind the name of its signal.
    pub(in crate::estimate::others) fn words(&self, sample_time_s: f64) -> String {
        let mut parts = Vec::new();
        if self.trend.slope_per_sample != 0.0 {
            let slope = significant(self.trend.slope_per_sample / sample_time_s, 3);
            parts.push(format!("a drift of {slope} per s"));
        }
        if let Some(decay) = &self.trend.decay {
            let (size, time_s) = (decay.amplitude, decay.time_constant_samples * sample_time_s);
            let (size, time_s) = (significant(size, 3), significant(time_s, 3));
            parts.push(format!("a transient of {size} that dies out in {time_s} s"));
        }
        let effect = significant(self.trend.effect_over_noise, 2);
        format!(
            "has {}, the same in every period and {effect} times the noise on a line: taken off",
            parts.join(" and ")
        )
    }
}
