//! Match of two draws of phases: whether one is the other but for a shift in time and a constant
//! phase, experiment by experiment.
//!
//! What distorts is the waveform. A shift leaves it as it is, a constant phase (a sign, a column of
//! an orthogonal matrix) all of its odd distortion but for the rare products without a difference
//! frequency. So the constant is one for all channels of an experiment: a channel turned against the
//! others makes another waveform in a coupled machine.

use std::collections::BTreeMap;
use std::f64::consts::{E, PI};
use std::iter::zip;

use ndarray::{Array2, ArrayView1, Zip};
use num_complex::Complex64;

use crate::spectra::delay::{DelaySearch, PhaseDifference, Shift};
use crate::spectra::draw_glance::{OnLine, Sums, directions};
use crate::spectra::run_spectra::RunSpectra;
use crate::spectra::spread::{add_squares, mean};

/// Phases that agree this well are the same draw: their distortion agrees as well, and a device that
/// plays a signal back is better than that. In rad, and of amplitudes in nepers.
const SAME_RAD: f64 = 0.2;
/// Phase noise that is granted where it is not known, with one period, in rad.
const UNKNOWN_NOISE_RAD: f64 = 0.25;
/// Noise explains a residual up to this many times its own.
const NOISE_FACTOR: f64 = 3.0;
/// Chance that draws of random phases are taken for one.
const CHANCE: f64 = 1e-4;
/// The same where the noise is too strong to be as sure: few lines that agree within their noise are
/// a repetition rather than a hit of one in twenty.
const CHANCE_IN_NOISE: f64 = 0.05;
/// Repetitions lie below this many times the noise, be lines few or many, but for one in a thousand.
const LIKELY_FACTOR: f64 = 2.0;
/// Amplitudes below this share of a channel's largest over the campaign are not compared (30 dB):
/// there is little of the input but noise and the response to other channels.
const EXCITED: f64 = 0.03;
/// Beyond so many lines their phases tell draws apart.
const MANY_LINES: f64 = 3.0;

/// What an experiment of a realization excites: the mean over its periods.
pub(super) struct Drawn {
    /// Mean spectrum, `(channel, line)`.
    mean: Array2<Complex64>,
    /// Its amplitudes, and its directions in the complex plane.
    sizes: Array2<f64>,
    directions: Array2<Complex64>,
    /// Variance of its phases in rad^2.
    variances: Array2<f64>,
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
    /// Chance that random phases agree so well, over the one that is granted to all comparisons of a
    /// campaign together: 1 or less.
    pub(super) chance: f64,
}

/// Phases that two experiments are compared by.
#[derive(Default)]
struct Phases {
    differences: Vec<PhaseDifference>,
    /// Logarithm of the amplitude ratios.
    levels: Vec<f64>,
    /// What noise does to each difference, in rad^2.
    variances: Vec<f64>,
}

impl Drawn {
    /// Of the periods of one experiment, at least one: the reference where there is one, else U.
    pub(super) fn of(periods: &[&RunSpectra]) -> Self {
        let spectra = periods.iter().map(|run| run.r.as_ref().unwrap_or(&run.u));
        let spectra: Vec<&Array2<Complex64>> = spectra.collect();
        let mean = mean(&spectra);
        let sizes = mean.mapv(Complex64::norm);
        Self {
            directions: directions(&mean, &sizes),
            variances: phase_variances(&spectra, &mean),
            sizes,
            mean,
        }
    }

    /// Largest amplitude of every channel.
    pub(super) fn peaks(&self) -> Vec<f64> {
        self.sizes.rows().into_iter().map(largest).collect()
    }

    /// How this experiment repeats the other; `None` if it does not. `peaks` are the largest
    /// amplitudes of the channels over the campaign.
    pub(super) fn repeats(
        &self,
        other: &Self,
        peaks: &[f64],
        search: &DelaySearch,
    ) -> Option<Repeat> {
        if self.is_another(other, peaks, search) {
            return None;
        }
        let phases = Phases::of(other, self, peaks);
        let n_lines = phases.line_weights().len();
        if n_lines == 0 {
            return None;
        }
        let (shift, square) = search.best(&phases.differences);
        let residual_rad = square.sqrt();
        let chance = phases.chance(residual_rad, search.spread(&phases.differences));
        (chance <= 1.0).then_some(Repeat {
            shift,
            residual_rad,
            n_lines,
            chance,
        })
    }

    /// Whether a glance shows that this experiment does not repeat the other. On one or two lines a delay makes any
    /// phases equal.
    fn is_another(&self, other: &Self, peaks: &[f64], search: &DelaySearch) -> bool {
        search.glance.as_ref().is_some_and(|glance| {
            let mut sums = Sums::zeros(glance.n_leading());
            (0..self.mean.ncols()).for_each(|line| sums.add(self.on_line(other, peaks, line)));
            let eps_rad = largest_residual_rad(sums.noise_rad());
            sums.number_of_lines() > MANY_LINES && glance.tells_apart(&sums, eps_rad)
        })
    }

    /// What the channels of a line that both excite bring.
    fn on_line(&self, other: &Self, peaks: &[f64], line: usize) -> OnLine {
        let mut sums = OnLine::default();
        for (channel, peak) in peaks.iter().enumerate() {
            let entry = (channel, line);
            if is_excited(other, self, entry, *peak) {
                let variance = variance_of(other, self, entry);
                let direction = self.directions[entry] * other.directions[entry].conj();
                sums.add(weight_of(variance), variance, direction);
            }
        }
        sums
    }
}

/// Variances of the phases of the mean of spectra in rad^2; of one spectrum they are not known.
fn phase_variances(spectra: &[&Array2<Complex64>], mean: &Array2<Complex64>) -> Array2<f64> {
    let n = spectra.len() as f64;
    if spectra.len() == 1 {
        return Array2::from_elem(mean.dim(), 0.5 * UNKNOWN_NOISE_RAD * UNKNOWN_NOISE_RAD);
    }
    let mut squares = Array2::zeros(mean.dim());
    add_squares(&mut squares, spectra, mean);
    let of_mean = squares / (n * (n - 1.0));
    Zip::from(&of_mean)
        .and(mean)
        .map_collect(|variance, mean| 0.5 * variance / mean.norm_sqr())
}

/// Whether two experiments both excite a channel on a line, whose largest amplitude is `peak`.
fn is_excited(a: &Drawn, b: &Drawn, entry: (usize, usize), peak: f64) -> bool {
    a.sizes[entry].min(b.sizes[entry]) > EXCITED * peak
}

/// Variance of a difference of phases in rad^2: beyond a full turn a phase says nothing, whatever the noise.
fn variance_of(a: &Drawn, b: &Drawn, entry: (usize, usize)) -> f64 {
    (a.variances[entry] + b.variances[entry]).min(PI * PI / 3.0)
}

/// What a difference of phases of this variance counts.
fn weight_of(variance: f64) -> f64 {
    1.0 / (SAME_RAD * SAME_RAD + variance)
}

/// The largest residual of a repetition, with so much noise in the differences.
fn largest_residual_rad(noise_rad: f64) -> f64 {
    SAME_RAD.max(NOISE_FACTOR * noise_rad)
}

/// Largest amplitude of a channel.
fn largest(channel: ArrayView1<f64>) -> f64 {
    channel.iter().copied().fold(0.0, f64::max)
}

/// A ratio of spectra with this variance of its phase, as a difference of phases.
fn difference(line: usize, ratio: Complex64, variance: f64) -> PhaseDifference {
    PhaseDifference {
        line,
        angle: ratio.arg(),
        weight: weight_of(variance),
    }
}

impl Phases {
    /// Of `b` against `a`, on the channels and lines that both excite.
    fn of(a: &Drawn, b: &Drawn, peaks: &[f64]) -> Self {
        let mut phases = Self::default();
        for ((entry, x), y) in a.mean.indexed_iter().zip(&b.mean) {
            if is_excited(a, b, entry, peaks[entry.0]) {
                phases.push(entry.1, y / x, variance_of(a, b, entry));
            }
        }
        phases
    }

    /// Adds a ratio of spectra.
    fn push(&mut self, line: usize, ratio: Complex64, variance: f64) {
        self.differences.push(difference(line, ratio, variance));
        self.levels.push(ratio.norm().ln());
        self.variances.push(variance);
    }

    fn weights(&self) -> impl Iterator<Item = f64> {
        self.differences.iter().map(|difference| difference.weight)
    }

    /// Rms of what noise does to the differences, in rad.
    fn noise_rad(&self) -> f64 {
        let weighted = zip(self.weights(), &self.variances).map(|(w, v)| w * v);
        let mean = weighted.sum::<f64>() / self.weights().sum::<f64>();
        mean.sqrt()
    }

    /// Chance of a residual, where lines lie `spread` of their spacings around their middle, over the one
    /// that is granted; infinite for a residual that is no repetition's.
    fn chance(&self, residual_rad: f64, spread: f64) -> f64 {
        let n_lines = self.number_of_lines();
        if n_lines <= 2.0 {
            // whatever the phases, a delay makes them equal
            return if self.level_spread() < SAME_RAD {
                0.0
            } else {
                f64::INFINITY
            };
        }
        let noise_rad = self.noise_rad();
        let granted = if residual_rad <= LIKELY_FACTOR * noise_rad {
            CHANCE_IN_NOISE
        } else if residual_rad <= largest_residual_rad(noise_rad) {
            CHANCE
        } else {
            0.0
        };
        chance_of(residual_rad, n_lines, spread) / granted
    }

    /// Number of lines, those that count less as parts of one. Channels do not add to it: they
    /// share their phases where experiments are orthogonal.
    fn number_of_lines(&self) -> f64 {
        let weights = self.line_weights();
        let squares = weights.values().map(|weight| weight * weight);
        weights.values().sum::<f64>().powi(2) / squares.sum::<f64>()
    }

    /// What the channels of every line that is compared count together.
    fn line_weights(&self) -> BTreeMap<usize, f64> {
        let mut weights = BTreeMap::new();
        for difference in &self.differences {
            *weights.entry(difference.line).or_insert(0.0) += difference.weight;
        }
        weights
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

/// Chance with which n random phases stay below this rms after the best delay and constant. They
/// reach a share `V (eps sqrt(n))^(n - 2) n spread / (2 pi)^(n - 2)` of all phases, V the volume of
/// the unit ball (by Stirling), `spread` that of the lines: the area of all delays and constants in
/// the cube of phases times the ball across it.
fn chance_of(residual_rad: f64, n_lines: f64, spread: f64) -> f64 {
    let free = n_lines - 2.0;
    let over = residual_rad / (2.0 * PI / E * free / n_lines).sqrt();
    n_lines * spread * over.powf(free)
}
