//! Spectra of the glides whose mean is taken off every run: their spread is noise that all runs share.

use std::f64::consts::TAU;

use frfid_estimate::RunSpectra;
use frfid_signals::{Frf, median};
use ndarray::Array2;
use num_complex::Complex64;

use crate::estimate::ripple_residual::OnFreeLines;

/// Spectra of the glides, each the mean over the periods of a run, which a run without excitation has
/// in common with the others.
#[derive(Debug, Clone, Default)]
pub(crate) struct GlideSpectra {
    /// On the lines of the estimate.
    pub(crate) on_lines: Vec<RunSpectra>,
    /// On the lines around them that are not excited.
    pub(crate) free: Vec<OnFreeLines>,
    /// Whether their mean has narrow lines of torque.
    pub(crate) show_ripple: bool,
}

impl GlideSpectra {
    /// Adds the periods of a glide; nothing if it holds none.
    pub(crate) fn add(&mut self, periods: Vec<(RunSpectra, Option<OnFreeLines>)>) {
        let (on_lines, free): (Vec<_>, Vec<_>) = periods.into_iter().unzip();
        let mean_of = |signal: fn(&RunSpectra) -> Option<&Array2<Complex64>>| {
            mean(on_lines.iter().filter_map(signal))
        };
        if let (Some(u), Some(y)) = (mean_of(|run| Some(&run.u)), mean_of(|run| Some(&run.y))) {
            let r = mean_of(|run| run.r.as_ref());
            self.on_lines.push(RunSpectra { u, y, r });
        }
        let free = || free.iter().flatten();
        let (u, y) = (
            mean(free().map(|free| &free.u)),
            mean(free().map(|free| &free.y)),
        );
        self.free
            .extend(u.zip(y).map(|(u, y)| OnFreeLines { u, y }));
    }

    /// Lines at which what repeats exceeds the noise, as those of torque ripple: none, but a remark, where
    /// the glides show no ripple.
    pub(crate) fn attributed(&self, exceeds: Vec<bool>, remarks: &mut Vec<String>) -> Vec<bool> {
        let n_lines = exceeds.iter().filter(|&&exceeds| exceeds).count();
        if self.show_ripple || n_lines == 0 {
            return exceeds;
        }
        remarks.push(format!(
            "what repeats from run to run beside the response exceeds the noise at {n_lines} of {} lines; the \
             glides show no torque ripple, so it is the machine's change along the way, or distortion: there \
             the noise variance says too little, trust the total variance",
            exceeds.len()
        ));
        vec![false; exceeds.len()]
    }

    /// What a noise variance rests on with one glide.
    pub(crate) fn remark(&self, frf: &Frf) -> Option<String> {
        let is_assumed = self.on_lines.len() == 1 && frf.noise.is_some();
        is_assumed.then(|| {
            "one glide: its noise is in every run, and the noise variance takes it to be as large as that \
             of a run; record two or more glides to measure it"
                .into()
        })
    }
}

/// Coherence of the glides' noise from one reference to another, `exp(-(2 pi f)^2 s^2)`: the expectation
/// of `exp(2 pi i f (t - t'))` of two shifts in time that are normally distributed, as multisines make
/// them, each of variance s^2; the median of the runs, since lost samples spoil that of a few.
pub(crate) fn coherence(wander_s2: &[f64], frequency_hz: &[f64]) -> Vec<f64> {
    let known = wander_s2
        .iter()
        .copied()
        .filter(|wander| wander.is_finite());
    let wander_s2 = median(known.collect()).unwrap_or(0.0);
    let at = |hz: &f64| (-(TAU * hz).powi(2) * wander_s2).exp();
    frequency_hz.iter().map(at).collect()
}

/// Mean of spectra of one shape; `None` of none.
fn mean<'a>(spectra: impl Iterator<Item = &'a Array2<Complex64>>) -> Option<Array2<Complex64>> {
    let mut count = 0.0;
    let sum = spectra.fold(None, |sum: Option<Array2<Complex64>>, spectra| {
        count += 1.0;
        Some(sum.map_or_else(|| spectra.clone(), |sum| sum + spectra))
    });
    sum.map(|sum| sum / Complex64::from(count))
}
