//! Delay between two spectra: by which shift in time and constant phase one becomes the other.
//!
//! `b(t) = a(t - tau)` turned by `c` has `arg(B A*) = c - 2 pi f tau` on every channel and line. The
//! delay is searched on a grid over the common period, by the FFT of `sum w e^{j arg(B A*)}`, and the
//! best places are refined by weighted least squares.

use std::f64::consts::{PI, TAU};
use std::iter::zip;
use std::sync::Arc;

use frfid_transforms::{ComplexToReal, TransformPlanner};
use num_complex::Complex64;

use crate::spectra::draw_glance::Glance;

/// Grid points in the time that the band of the lines resolves.
pub(super) const OVERSAMPLING: usize = 8;
/// Peaks of the search that are refined: with few lines the highest need not be the right one.
const CANDIDATES: usize = 8;
/// Newton steps: a sixteenth of a turn off at the ends of the band to begin with, the first is right but for wraps.
const STEPS: usize = 3;
/// Spacings that a set of lines may span: as many lines has a period of two million samples.
const MOST_BINS: f64 = 1e6;

/// Phase of one channel and line against the same of another spectrum.
#[derive(Debug, Clone, Copy)]
pub(super) struct PhaseDifference {
    /// Number of the line.
    pub(super) line: usize,
    /// `arg(B A*)` in rad.
    pub(super) angle: f64,
    /// What it counts.
    pub(super) weight: f64,
}

/// A shift in time and a constant phase.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Shift {
    /// How much later b is than a, in s.
    pub(super) delay_s: f64,
    /// What b is turned by besides, in rad.
    pub(super) constant_rad: f64,
}

impl Shift {
    /// What is left of a difference of phases at a frequency, in (-pi, pi].
    fn residual(&self, hz: f64, angle: f64) -> f64 {
        wrapped(angle + TAU * hz * self.delay_s - self.constant_rad)
    }

    /// The factor that turns b back at a frequency.
    pub(super) fn undone(&self, hz: f64) -> Complex64 {
        Complex64::cis(TAU * hz * self.delay_s - self.constant_rad)
    }
}

/// The search for delays between spectra on the same lines; planned once.
pub(super) struct DelaySearch<'a> {
    frequency_hz: &'a [f64],
    /// Largest spacing of which all lines are multiples, seen from the lowest.
    spacing_hz: f64,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// What tells most draws apart without a search.
    pub(super) glance: Option<Glance>,
}

impl<'a> DelaySearch<'a> {
    /// On rising frequencies, at least one.
    pub(super) fn new(frequency_hz: &'a [f64]) -> Self {
        let spacing_hz = common_spacing_hz(frequency_hz);
        let span = frequency_hz.last().copied().unwrap_or(0.0) - frequency_hz[0];
        let bins = (span / spacing_hz).round() as usize + 2;
        let size = (OVERSAMPLING * bins).next_power_of_two();
        Self {
            frequency_hz,
            spacing_hz,
            inverse: TransformPlanner::default().inverse(size),
            glance: Glance::of(frequency_hz, spacing_hz),
        }
    }

    /// The shift with the smallest residual, and its weighted mean square in rad^2.
    pub(super) fn best(&self, differences: &[PhaseDifference]) -> (Shift, f64) {
        let starts = self.starts(differences).into_iter();
        let refined = starts.map(|delay_s| self.refined(differences, delay_s));
        let best = refined.min_by(|a, b| a.1.total_cmp(&b.1));
        best.unwrap_or_default()
    }

    /// Standard deviation of the frequencies, in spacings.
    pub(super) fn spread(&self, differences: &[PhaseDifference]) -> f64 {
        let middle_hz = self.mean(differences, |hz, _| hz);
        let square = self.mean(differences, |hz, _| (hz - middle_hz).powi(2));
        square.sqrt() / self.spacing_hz
    }

    /// Delays at the highest peaks of the search, highest first.
    fn starts(&self, differences: &[PhaseDifference]) -> Vec<f64> {
        let sizes = self.correlation(differences);
        let grid_hz = sizes.len() as f64 * self.spacing_hz;
        let peaks = highest_peaks(&sizes).into_iter();
        peaks.map(|k| k as f64 / grid_hz).collect()
    }

    /// `|sum w e^{j (angle + 2 pi f tau)}|^2` on the grid of delays. The inverse FFT is real: once
    /// for the real part, once for the imaginary one.
    fn correlation(&self, differences: &[PhaseDifference]) -> Vec<f64> {
        let mut sizes = vec![0.0; self.inverse.len()];
        for part in [Complex64::ONE, -Complex64::I] {
            let samples = self.real_part(differences, part);
            zip(&mut sizes, samples).for_each(|(size, sample)| *size += sample * sample);
        }
        sizes
    }

    /// `Re sum factor w e^{j (angle + 2 pi f tau)}` on the grid of delays.
    fn real_part(&self, differences: &[PhaseDifference], factor: Complex64) -> Vec<f64> {
        let mut bins = self.bins(differences, factor);
        let mut samples = self.inverse.make_output_vec();
        let done = self.inverse.process(&mut bins, &mut samples);
        done.map_or(Vec::new(), |()| samples)
    }

    /// `factor w e^{j angle}` by line; lines start at bin 1, as bin 0 must be real.
    fn bins(&self, differences: &[PhaseDifference], factor: Complex64) -> Vec<Complex64> {
        let mut bins = self.inverse.make_input_vec();
        for difference in differences {
            let hz = self.frequency_hz[difference.line] - self.frequency_hz[0];
            let bin = (hz / self.spacing_hz).round() as usize + 1;
            bins[bin] += factor * Complex64::from_polar(difference.weight, difference.angle);
        }
        bins
    }

    /// The shift near a delay by least squares, and the weighted mean square that is left.
    fn refined(&self, differences: &[PhaseDifference], delay_s: f64) -> (Shift, f64) {
        let mut shift = Shift {
            delay_s,
            constant_rad: self.sum(differences, delay_s).arg(),
        };
        for _ in 0..STEPS {
            shift = self.improved(differences, shift);
        }
        let square = |hz: f64, angle: f64| shift.residual(hz, angle).powi(2);
        (shift, self.mean(differences, square))
    }

    /// `sum w e^{j (angle + 2 pi f tau)}` at a delay.
    fn sum(&self, differences: &[PhaseDifference], delay_s: f64) -> Complex64 {
        let term = |difference: &PhaseDifference| {
            let angle = difference.angle + TAU * self.frequency_hz[difference.line] * delay_s;
            Complex64::from_polar(difference.weight, angle)
        };
        differences.iter().map(term).sum()
    }

    /// One Newton step: a straight line through what is left over frequency.
    fn improved(&self, differences: &[PhaseDifference], shift: Shift) -> Shift {
        let middle_hz = self.mean(differences, |hz, _| hz);
        let left = |hz: f64, angle: f64| shift.residual(hz, angle);
        let slope = self.slope(differences, middle_hz, left);
        let constant = self.mean(differences, left) - TAU * middle_hz * slope;
        Shift {
            delay_s: shift.delay_s - slope,
            constant_rad: wrapped(shift.constant_rad + constant),
        }
    }

    /// Slope of something over angular frequency; 0 on a single line.
    fn slope(
        &self,
        differences: &[PhaseDifference],
        middle_hz: f64,
        of: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        let place = |hz: f64| TAU * (hz - middle_hz);
        let width = self.mean(differences, |hz, _| place(hz).powi(2));
        let tilt = self.mean(differences, |hz, angle| place(hz) * of(hz, angle));
        if width > 0.0 { tilt / width } else { 0.0 }
    }

    /// Weighted mean of something of the frequencies and angles.
    fn mean(&self, differences: &[PhaseDifference], of: impl Fn(f64, f64) -> f64) -> f64 {
        let (mut sum, mut weights) = (0.0, 0.0);
        for difference in differences {
            let hz = self.frequency_hz[difference.line];
            sum += difference.weight * of(hz, difference.angle);
            weights += difference.weight;
        }
        sum / weights
    }
}

/// Places of the highest peaks of values on a circle, highest first; the first place counts as one.
fn highest_peaks(sizes: &[f64]) -> Vec<usize> {
    let mut peaks: Vec<usize> = (0..sizes.len()).filter(|&k| is_peak(sizes, k)).collect();
    peaks.sort_by(|&a, &b| sizes[b].total_cmp(&sizes[a]));
    peaks.truncate(CANDIDATES);
    peaks
}

fn is_peak(sizes: &[f64], k: usize) -> bool {
    let after = sizes[(k + 1) % sizes.len()];
    k == 0 || (sizes[k] >= sizes[k - 1] && sizes[k] > after)
}

/// An angle in (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    let turned = angle - TAU * (angle / TAU).round();
    if turned <= -PI { turned + TAU } else { turned }
}

/// The largest spacing of which all distances from the lowest frequency are multiples; a fraction of
/// the smallest distance where there is none.
fn common_spacing_hz(frequency_hz: &[f64]) -> f64 {
    let distances = frequency_hz.iter().map(|hz| hz - frequency_hz[0]);
    let span = distances.clone().fold(0.0, f64::max);
    if span <= 0.0 {
        return 1.0; // a single line: any spacing will do
    }
    let nothing = 1e-3 * span / MOST_BINS;
    let common = distances.fold(span, |a, b| common_divisor(a, b, nothing));
    if common * MOST_BINS >= span {
        common
    } else {
        fine_spacing_hz(frequency_hz, span)
    }
}

/// A quarter of the smallest distance between neighbours, or what the longest period resolves.
fn fine_spacing_hz(frequency_hz: &[f64], span: f64) -> f64 {
    let steps = frequency_hz.windows(2).map(|pair| pair[1] - pair[0]);
    (0.25 * steps.fold(span, f64::min)).max(span / MOST_BINS)
}

/// Greatest common divisor of two lengths (Euclid), what is smaller than `nothing` being rounding.
fn common_divisor(a: f64, b: f64, nothing: f64) -> f64 {
    let (mut large, mut small) = (a.max(b), a.min(b));
    while small > nothing {
        (large, small) = (small, (large - small * (large / small).round()).abs());
    }
    large
}
