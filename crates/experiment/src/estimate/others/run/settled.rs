//! Settled part of a run: transient periods dropped, trends that every period shares taken off.

use frfid_estimate::{
    EstimateError, RunPeriods, RunSpectra, Settling, Trend, find_trend, judge_settling,
};
use frfid_signals::format::significant;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, s};

use crate::estimate::others::recording::Role;
use crate::estimate::others::run::measured::Signals;

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

/// A run in which the settled part is looked for.
pub(in crate::estimate::others) struct Search<'a, 's> {
    pub(in crate::estimate::others) signals: &'a Signals<'s>,
    pub(in crate::estimate::others) periods: &'a RunPeriods,
    /// Period in samples.
    pub(in crate::estimate::others) period: f64,
    pub(in crate::estimate::others) lines: &'a [usize],
}

impl Search<'_, '_> {
    /// Drops what is transient and takes trends off the rest. Where periods never settle, or only
    /// with further periods dropped, a trend of the whole run is tried first.
    ///
    /// # Errors
    /// [`EstimateError::NotSettled`].
    pub(in crate::estimate::others) fn settled(&self) -> Result<Settled, EstimateError> {
        let judged = self.judge(self.signals.y);
        if judged.as_ref().is_ok_and(is_plain) {
            return self.starting_at(n_transient(&judged?));
        }
        let whole = self.starting_at(0);
        match (whole, judged) {
            (Ok(whole), judged) if whole.is_better(&judged) => Ok(whole),
            (_, judged) => self.starting_at(n_transient(&judged?)),
        }
    }

    /// The run from a period on, without its trends.
    fn starting_at(&self, first: usize) -> Result<Settled, EstimateError> {
        let from = self.periods.first_sample(first);
        let (mut u, mut y) = (self.signals.u.to_owned(), self.signals.y.to_owned());
        let mut trends = Vec::new();
        for (role, signal) in [(Role::Input, &mut u), (Role::Output, &mut y)] {
            let used = signal.slice_mut(s![.., from..]);
            trends.extend(self.straighten(role, used)?);
        }
        let settling = self.judge(y.view())?;
        Ok(Settled {
            n_transient: first.max(n_transient(&settling)),
            straight: (!trends.is_empty()).then_some([u, y]),
            settling,
            trends,
        })
    }

    /// Takes the trends off every channel of a signal.
    fn straighten(
        &self,
        role: Role,
        mut signal: ArrayViewMut2<f64>,
    ) -> Result<Vec<TrendOf>, EstimateError> {
        let mut trends = Vec::new();
        for (channel, mut samples) in signal.rows_mut().into_iter().enumerate() {
            if let Some(trend) = find_trend(samples.view(), self.period, self.lines)? {
                trend.subtract_from(samples.view_mut());
                trends.push(TrendOf {
                    role,
                    channel,
                    trend,
                });
            }
        }
        Ok(trends)
    }

    /// Whether the periods of outputs have settled; `None` where too few tell.
    fn judge(&self, y: ArrayView2<f64>) -> Result<Option<Settling>, EstimateError> {
        let spectra = self.periods.all_spectra("y", y)?;
        judge_settling(&spectra, self.lines)
    }
}

impl Settled {
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
        let (u, y) = match &self.straight {
            Some([u, y]) => (u.view(), y.view()),
            None => (signals.u, signals.y),
        };
        let r = signals.r.map(|r| periods.spectra("r", r, period));
        let (u, y) = (
            periods.spectra("u", u, period)?,
            periods.spectra("y", y, period)?,
        );
        Ok(match (u, y, r.transpose()?) {
            (Some(u), Some(y), None) => Some(RunSpectra { u, y, r: None }),
            (Some(u), Some(y), Some(Some(r))) => Some(RunSpectra { u, y, r: Some(r) }),
            _ => None,
        })
    }

    /// Whether it has settled without its trends, with no more periods dropped than otherwise.
    fn is_better(&self, judged: &Result<Option<Settling>, EstimateError>) -> bool {
        let otherwise = judged.as_ref().map_or(usize::MAX, n_transient);
        let is_settled = |settling: &Settling| settling.unsettled.is_empty();
        !self.trends.is_empty()
            && self.settling.as_ref().is_some_and(is_settled)
            && self.n_transient <= otherwise
    }
}

/// Whether nothing but the leading periods stands out.
fn is_plain(settling: &Option<Settling>) -> bool {
    let is_plain = |s: &Settling| s.unsettled.is_empty() && s.decay_periods.is_none();
    settling.as_ref().is_none_or(is_plain)
}

fn n_transient(settling: &Option<Settling>) -> usize {
    settling.as_ref().map_or(0, |settling| settling.n_transient)
}

impl TrendOf {
    /// The trend in words, behind the name of its signal.
    pub(in crate::estimate::others) fn words(&self, sample_time_s: f64) -> String {
        let parts = [self.drift(sample_time_s), self.transient(sample_time_s)];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        let effect = significant(self.trend.effect_over_noise, 2);
        format!(
            "has {}, the same in every period and {effect} times the noise on a line: taken off",
            parts.join(" and ")
        )
    }

    fn drift(&self, sample_time_s: f64) -> Option<String> {
        let slope = self.trend.slope_per_sample / sample_time_s;
        (slope != 0.0).then(|| format!("a drift of {} per s", significant(slope, 3)))
    }

    fn transient(&self, sample_time_s: f64) -> Option<String> {
        let decay = self.trend.decay.as_ref()?;
        let size = significant(decay.amplitude, 3);
        let time_s = significant(decay.time_constant_samples * sample_time_s, 3);
        Some(format!("a transient of {size} that dies out in {time_s} s"))
    }
}
