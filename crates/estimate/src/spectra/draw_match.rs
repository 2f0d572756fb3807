//! Match of two draws of phases: whether one is the other but for a shift in time and a constant
//! phase, experiment by experiment.
//!
//! What distorts is the waveform. A shift leaves it as it is, a constant phase (a sign, a column of
//! an orthogonal matrix) all of its odd distortion but for the rare products without a difference
//! frequency. So the constant is one for all channels of an experiment: a channel turned against the
//! others makes another waveform in a coupled machine.

use std::f64::consts::{E, PI};

use ndarray::{Array2, ArrayView1, Zip};
use num_complex::Complex64;

use crate::spectra::campaign::RunSpectra;
use crate::spectra::delay::{DelaySearch, PhaseDifference, Shift};

/// Phases that agree this well are the same draw: their distortion agrees as well, and a device that
/// plays a signal back is better than that. In rad, and of amplitudes in nepers.
const SAME_RAD: f64 = 0.2;
/// Phase noise that is granted where it is not known, with one period, in rad.
const UNKNOWN_NOISE_RAD: f64 = 0.25;
/// Noise explains a residual up to this many times its own.
const NOISE_FACTOR: f64 = 3.0;
/// Chance that two draws of random phases are taken for one.
const CHANCE: f64 = 1e-4;
/// Amplitudes below this share of a channel's largest over the campaign are not compared (30 dB):
/// there is little of the input but noise and the response to other channels.
const EXCITED: f64 = 0.03;

/// What an experiment of a realization excites: the mean over its periods.
pub(super) struct Drawn {
    /// Mean spectrum, `(channel, line)`.
    mean: Array2<Complex64>,
    /// Variance of the mean, known with two periods or more.
    variance: Option<Array2<f64>>,
}

/// How an experiment repeats another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Repeat {
    /// From the other to this one.
    pub(super) shift: Shift,
    /// Residual phase, rms in rad.
    pub(super) residual_rad: f64,
    /// Number of lines that were compared.
    pub(super) n_lines: usize,
}

/// Phases that two experiments are compared by.
struct Phases {
    differences: Vec<PhaseDifference>,
    /// Logarithm of the amplitude ratios.
    levels: Vec<f64>,
    /// Weighted mean square of what noise does to the differences.
    noise: f64,
}

impl Drawn {
    /// Of the periods of one experiment, at least one: the reference where there is one, else U.
    pub(super) fn of(periods: &[&RunSpectra]) -> Self {
        let excitation =
            |run: &'_ RunSpectra| -> Array2<Complex64> { run.r.as_ref().unwrap_or(&run.u).clone() };
        let n = periods.len() as f64;
        let spectra: Vec<_> = periods.iter().map(|run| excitation(run)).collect();
        let mut mean = Array2::zeros(spectra[0].dim());
        for spectrum in &spectra {
            mean += spectrum;
        }
        mean /= Complex64::from(n);
        let variance = (periods.len() > 1).then(|| variance_of_mean(&spectra, &mean));
        Self { mean, variance }
    }

    /// Largest amplitude of every channel.
    pub(super) fn peaks(&self) -> Vec<f64> {
        let largest = |channel: ArrayView1<Complex64>| {
            channel.iter().map(|value| value.norm()).fold(0.0, f64::max)
        };
        self.mean.rows().into_iter().map(largest).collect()
    }

    /// How this experiment repeats the other; `None` if it does not. `peaks` are the largest
    /// amplitudes of the channels over the campaign.
    pub(super) fn repeats(
        &self,
        other: &Self,
        peaks: &[f64],
        search: &DelaySearch,
    ) -> Option<Repeat> {
        let phases = Phases::of(other, self, peaks);
        let lines = phases.differences.iter().map(|difference| difference.line);
        let n_lines = lines.collect::<std::collections::BTreeSet<_>>().len();
        if n_lines == 0 {
            return None;
        }
        let (shift, square) = search.best(&phases.differences);
        let repeat = Repeat {
            shift,
            residual_rad: square.sqrt(),
            n_lines,
        };
        let cells = search.cells(&phases.differences);
        phases.is_same(repeat.residual_rad, cells).then_some(repeat)
    }

    /// Variance of the phase of an entry in rad^2, with the mean of the periods known so well.
    fn phase_variance(&self, entry: (usize, usize)) -> f64 {
        match &self.variance {
            Some(variance) => 0.5 * variance[entry] / self.mean[entry].norm_sqr(),
            None => 0.5 * UNKNOWN_NOISE_RAD * UNKNOWN_NOISE_RAD,
        }
    }
}

/// Variance of the mean of spectra, `E|d|^2`.
fn variance_of_mean(spectra: &[Array2<Complex64>], mean: &Array2<Complex64>) -> Array2<f64> {
    let n = spectra.len() as f64;
    let mut variance = Array2::zeros(mean.dim());
    for spectrum in spectra {
        Zip::from(&mut variance)
            .and(spectrum)
            .and(mean)
            .for_each(|sum, value, mean| *sum += (value - mean).norm_sqr() / (n * (n - 1.0)));
    }
    variance
}

impl Phases {
    /// Of `b` against `a`, on the channels and lines that both excite.
    fn of(a: &Drawn, b: &Drawn, peaks: &[f64]) -> Self {
        let (mut differences, mut levels) = (Vec::new(), Vec::new());
        let (mut noise, mut weights) = (0.0, 0.0);
        for ((entry, x), y) in a.mean.indexed_iter().zip(&b.mean) {
            if x.norm().min(y.norm()) <= EXCITED * peaks[entry.0] {
                continue;
            }
            let variance = a.phase_variance(entry) + b.phase_variance(entry);
            // beyond a full turn a phase says nothing, whatever the noise
            let variance = variance.min(PI * PI / 3.0);
            let weight = 1.0 / (SAME_RAD * SAME_RAD + variance);
            differences.push(PhaseDifference {
                line: entry.1,
                angle: (y * x.conj()).arg(),
                weight,
            });
            levels.push((y.norm() / x.norm()).ln());
            noise += weight * variance;
            weights += weight;
        }
        Self {
            differences,
            levels,
            noise: noise / weights,
        }
    }

    /// Whether a residual shows the same draw, with so many delays to choose from.
    ///
    /// Of n phases a delay and a constant are fitted, which leaves nu = n - 2. Random ones stay below
    /// eps with a chance below that of the ball of radius `eps sqrt(nu)` in the cube of edge 2 pi, by
    /// Stirling `(eps sqrt(e / 2 pi))^nu`, times the number of delays.
    fn is_same(&self, residual_rad: f64, cells: f64) -> bool {
        let free = self.effective_number() - 2.0;
        if free <= 0.0 {
            return self.level_spread() < SAME_RAD; // whatever the phases, a delay makes them equal
        }
        let by_chance_rad = (2.0 * PI / E).sqrt() * ((CHANCE / cells).ln() / free).exp();
        let by_noise_rad = NOISE_FACTOR * self.noise.sqrt();
        let limit_rad = SAME_RAD
            .min(by_chance_rad)
            .max(by_noise_rad.min(by_chance_rad.max(SAME_RAD)));
        residual_rad <= limit_rad
    }

    /// Number of phases, those that count less as parts of one.
    fn effective_number(&self) -> f64 {
        let weights = || self.differences.iter().map(|difference| difference.weight);
        weights().sum::<f64>().powi(2) / weights().map(|weight| weight * weight).sum::<f64>()
    }

    /// Standard deviation of the logarithmic amplitude ratios: a level that all lines share does
    /// not count.
    fn level_spread(&self) -> f64 {
        let n = self.levels.len() as f64;
        let mean = self.levels.iter().sum::<f64>() / n;
        let squares = self.levels.iter().map(|level| (level - mean).powi(2));
        (squares.sum::<f64>() / n).sqrt()
    }
}
