//! Sticking of each axis, band by band: whether the excitation was strong enough (SK15 footnote
//! 2).

use std::fmt;
use std::iter::zip;
use std::ops::{Range, RangeInclusive};

use frfid_signals::Record;
use frfid_signals::format::significant;
use ndarray::{Array2, Array3, ArrayView1, ArrayViewMut1, Axis};
use num_complex::Complex64;

use crate::frf::matrices::Matrix;
use crate::shape::iteration::Iteration;
use crate::shape::options::ShapeOptions;
use crate::shape::spectra::Band;

/// Bands per octave in which stuck time is reported.
const PER_OCTAVE: f64 = 3.0;
/// Stuck share from which an axis is said to stick in a band.
const MOSTLY: f64 = 0.75;

/// How an axis moved while the excitation was in a band.
#[derive(Debug, Clone, PartialEq)]
pub struct BandMotion {
    /// Axis, from 0.
    pub axis: usize,
    /// Lower edge of the band in Hz.
    pub low_hz: f64,
    /// Upper edge of the band in Hz.
    pub high_hz: f64,
    /// Share of the time that the motor was stuck.
    pub stuck_share: f64,
    /// Rms of the torque about its mean, in N m.
    pub rms_nm: f64,
}

impl BandMotion {
    fn mostly_sticks(&self) -> bool {
        self.stuck_share > MOSTLY
    }
}

/// An axis that sticks, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Sticking {
    /// Axis, from 0.
    pub axis: usize,
    /// Lower end of where it sticks, in Hz.
    pub low_hz: f64,
    /// Upper end of where it sticks, in Hz.
    pub high_hz: f64,
    /// Share of the time that the motor was stuck there.
    pub stuck_share: f64,
    /// Rms of the torque there, in N m.
    pub rms_nm: f64,
    /// Coulomb friction in N m, where it is known.
    pub coulomb_nm: Option<f64>,
}

/// In words, axes from 1.
impl fmt::Display for Sticking {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            axis,
            low_hz,
            high_hz,
            stuck_share,
            rms_nm,
            coulomb_nm,
        } = self;
        let (axis, percent) = (axis + 1, 100.0 * stuck_share);
        write!(
            f,
            "axis {axis} sticks {percent:.0} % of the time from {} to {} Hz: the torque there is {} N m rms",
            significant(*low_hz, 3),
            significant(*high_hz, 3),
            significant(*rms_nm, 3),
        )?;
        match coulomb_nm {
            Some(coulomb_nm) => write!(
                f,
                " against {} N m of friction",
                significant(*coulomb_nm, 3)
            ),
            None => Ok(()),
        }
    }
}

/// The excitation over time: its span, and its power in each band.
#[derive(Debug, Clone)]
pub(super) struct Sweep {
    /// Samples between which the desired signal is not zero.
    samples: Range<usize>,
    /// Edges of the bands in Hz.
    edges_hz: Vec<f64>,
    /// Power of the desired signal in each band over time, `(band, sample)`.
    weight: Array2<f64>,
}

impl Sweep {
    /// Reads the sweep off the desired signal `(experiment, channel, sample)`; the experiments
    /// differ in phase only, so the first one stands for all.
    pub(super) fn of(
        band: &Band,
        desired: &Array3<f64>,
        spectra: &[Matrix],
        [low_hz, high_hz]: [f64; 2],
    ) -> Self {
        let edges_hz = band_edges(low_hz, high_hz);
        let bands = edges_hz.windows(2).map(|edges| edges[0]..=edges[1]);
        let mut weight = Array2::zeros((edges_hz.len() - 1, desired.len_of(Axis(2))));
        for (band_hz, weight) in zip(bands, weight.rows_mut()) {
            add_power(band, spectra, &band_hz, weight);
        }
        Self {
            samples: active_samples(desired),
            edges_hz,
            weight,
        }
    }

    /// Share of the sweep that each axis was stuck, over all records.
    pub(super) fn stuck_share(&self, stuck: &[Array2<bool>]) -> Vec<f64> {
        let n_axes = stuck.first().map_or(0, Array2::nrows);
        (0..n_axes)
            .map(|axis| self.stuck_share_of(axis, stuck))
            .collect()
    }

    fn stuck_share_of(&self, axis: usize, stuck: &[Array2<bool>]) -> f64 {
        let samples = || {
            stuck.iter().flat_map(|stuck| {
                let samples = self.samples.clone();
                samples.filter_map(move |k| stuck.get([axis, k]))
            })
        };
        samples().filter(|&&stuck| stuck).count() as f64 / samples().count().max(1) as f64
    }

    /// Stuck share and torque of every axis in every band, axis by axis.
    pub(super) fn bands(&self, records: &[Record], stuck: &[Array2<bool>]) -> Vec<BandMotion> {
        let n_axes = stuck.first().map_or(0, Array2::nrows);
        let mut bands = Vec::new();
        for axis in 0..n_axes {
            for (edges, weight) in zip(self.edges_hz.windows(2), self.weight.rows()) {
                let (stuck_share, rms_nm) = motion_of(axis, weight, records, stuck);
                bands.push(BandMotion {
                    axis,
                    low_hz: edges[0],
                    high_hz: edges[1],
                    stuck_share,
                    rms_nm,
                });
            }
        }
        bands
    }
}

/// Edges in Hz of bands of about equal width on a logarithmic scale.
fn band_edges(low_hz: f64, high_hz: f64) -> Vec<f64> {
    let n_bands = (PER_OCTAVE * (high_hz / low_hz).log2()).ceil().max(1.0);
    let edge = |b: usize| low_hz * (high_hz / low_hz).powf(b as f64 / n_bands);
    (0..=n_bands as usize).map(edge).collect()
}

/// Samples from the first to the last in which a signal is not zero.
fn active_samples(desired: &Array3<f64>) -> Range<usize> {
    let active = |&k: &usize| desired.index_axis(Axis(2), k).iter().any(|&x| x != 0.0);
    let mut samples = 0..desired.len_of(Axis(2));
    let first = samples.clone().find(active).unwrap_or(0);
    let last = samples.rfind(active).unwrap_or(0);
    first..last + 1
}

/// Adds the power over time that the first experiment has in a band: that of the analytic signal,
/// the signal and its quadrature, each squared.
fn add_power(
    band: &Band,
    spectra: &[Matrix],
    band_hz: &RangeInclusive<f64>,
    mut weight: ArrayViewMut1<f64>,
) {
    for turn in [Complex64::ONE, -Complex64::I] {
        let part = |line: usize| {
            let is_inside = band_hz.contains(&band.frequency_hz[band.nearest(line)]);
            let factor = if is_inside { turn } else { Complex64::ZERO };
            spectra[line].columns(0, 1) * factor
        };
        let parts: Vec<Matrix> = (0..band.n_lines()).map(part).collect();
        for channel in band.signals(&parts).index_axis(Axis(0), 0).rows() {
            zip(&mut weight, channel).for_each(|(weight, x)| *weight += x * x);
        }
    }
}

/// Stuck share and rms torque in N m of an axis, samples weighted by the power of a band.
fn motion_of(
    axis: usize,
    weight: ArrayView1<f64>,
    records: &[Record],
    stuck: &[Array2<bool>],
) -> (f64, f64) {
    let (mut total, mut held, mut square) = (f64::MIN_POSITIVE, 0.0, 0.0);
    for (record, stuck) in zip(records, stuck) {
        let torque = record.u.row(axis);
        let mean = torque.sum() / record.n_samples() as f64;
        for ((weight, &u), &stuck) in zip(zip(weight, torque), stuck.row(axis)) {
            total += weight;
            held += weight * f64::from(u8::from(stuck));
            square += weight * (u - mean).powi(2);
        }
    }
    (held / total, (square / total).sqrt())
}

/// Where axes stick: neighbouring bands in which an axis sticks most of the time, merged, and an
/// axis that sticks for a larger share of the sweep than `max_stuck_share` without doing so in any
/// one band.
pub(super) fn sticking(iteration: &Iteration, options: &ShapeOptions) -> Vec<Sticking> {
    let coulomb_nm = options.coulomb_nm.as_deref();
    let mut found = Vec::new();
    for (axis, &share) in iteration.stuck_share.iter().enumerate() {
        let bands = iteration.bands.iter();
        let of_axis: Vec<&BandMotion> = bands.filter(|band| band.axis == axis).collect();
        let runs = of_axis.chunk_by(|a, b| a.mostly_sticks() == b.mostly_sticks());
        let sticky = runs.filter(|run| run[0].mostly_sticks());
        let before = found.len();
        found.extend(sticky.map(|run| merged(run, coulomb_nm)));
        if found.len() == before && share > options.max_stuck_share && !of_axis.is_empty() {
            found.push(Sticking {
                stuck_share: share,
                ..merged(&of_axis, coulomb_nm)
            });
        }
    }
    found
}

/// Neighbouring bands as one, equal parts of the logarithm of the frequency.
fn merged(bands: &[&BandMotion], coulomb_nm: Option<&[f64]>) -> Sticking {
    let mean = |of: fn(&BandMotion) -> f64| {
        bands.iter().map(|band| of(band)).sum::<f64>() / bands.len() as f64
    };
    let axis = bands[0].axis;
    Sticking {
        axis,
        low_hz: bands[0].low_hz,
        high_hz: bands[bands.len() - 1].high_hz,
        stuck_share: mean(|band| band.stuck_share),
        rms_nm: mean(|band| band.rms_nm.powi(2)).sqrt(),
        coulomb_nm: coulomb_nm.map(|coulomb_nm| coulomb_nm[axis]),
    }
}
