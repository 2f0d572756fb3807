//! Time series of a campaign, and their spectra run by run.

use std::iter::zip;

use frfid_signals::checks::require_shape;
use ndarray::{ArrayView, ArrayView2, ArrayView5, Dimension, s};
use rayon::prelude::*;

use crate::error::EstimateError;
use crate::period_index::PeriodIndex;
use crate::spectra::Transform;
use crate::spectra::campaign::Campaign;
use crate::spectra::run_spectra::RunSpectra;

/// Plant input, plant output and, for methods that estimate through it, reference:
/// `(realization, experiment, period, channel, sample)` of any strides.
pub(crate) struct TimeSeries<'a> {
    pub(crate) u: ArrayView5<'a, f64>,
    pub(crate) y: ArrayView5<'a, f64>,
    pub(crate) r: Option<ArrayView5<'a, f64>>,
}

impl TimeSeries<'_> {
    /// Adds the spectra of every run to a campaign.
    pub(crate) fn transform_into(
        &self,
        campaign: &mut Campaign,
        transform: &dyn Transform,
    ) -> Result<(), EstimateError> {
        let mut runs = self.of_each(|_, u, y, r| RunSpectra::of(transform, u, y, r))?;
        runs.try_for_each(|(place, run)| campaign.insert(place, run))
    }

    /// What is made of u, y and r of every run, with its place, in order.
    pub(crate) fn of_each<T: Send>(
        &self,
        made: impl Fn(PeriodIndex, Signal, Signal, Option<Signal>) -> Result<T, EstimateError> + Sync,
    ) -> Result<impl Iterator<Item = (PeriodIndex, T)>, EstimateError> {
        let places = self.places();
        let runs = places.par_iter().map(|&place| {
            let r = self.r.as_ref().map(|r| run_at(r, place));
            made(place, run_at(&self.u, place), run_at(&self.y, place), r)
        });
        let runs: Vec<T> = runs.collect::<Result<_, _>>()?;
        Ok(zip(places, runs))
    }

    /// Every run by realization, period and experiment.
    fn places(&self) -> Vec<PeriodIndex> {
        let (n_p, n_ex, n_q, ..) = self.u.dim();
        let place = |run: usize| PeriodIndex {
            realization: run / (n_q * n_ex),
            period: run / n_ex % n_q,
            experiment: run % n_ex,
        };
        (0..n_p * n_q * n_ex).map(place).collect()
    }
}

/// One run of a signal, `(channel, sample)`.
type Signal<'a> = ArrayView2<'a, f64>;

/// One run, `(channel, sample)`, out of a campaign's array.
fn run_at<'a>(signal: &'a ArrayView5<f64>, place: PeriodIndex) -> Signal<'a> {
    signal.slice(s![
        place.realization,
        place.experiment,
        place.period,
        ..,
        ..
    ])
}

/// Refuses signals `(.., channel, sample)` that differ from `u` in more than their channels.
pub(crate) fn check_same_shape<D: Dimension>(
    u: &ArrayView<f64, D>,
    y: &ArrayView<f64, D>,
    r: Option<&ArrayView<f64, D>>,
) -> Result<(), EstimateError> {
    let needed = shape_but_channels(u);
    for (name, signal) in [("y", Some(y)), ("r", r)] {
        let Some(signal) = signal else { continue };
        let fits = shape_but_channels(signal) == needed;
        require_shape(name, signal.shape(), fits, format_args!("{needed}, as u"))?;
    }
    Ok(())
}

/// A shape in words, with `channel` for the number of channels.
fn shape_but_channels<D: Dimension>(signal: &ArrayView<f64, D>) -> String {
    let mut lengths: Vec<String> = signal.shape().iter().map(usize::to_string).collect();
    lengths[signal.ndim() - 2] = "channel".into();
    format!("({})", lengths.join(", "))
}
