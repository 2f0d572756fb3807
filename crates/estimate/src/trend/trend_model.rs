//! Models of a trend, a slope, a decay or both, fitted to a run without its periodic part.

use std::iter::zip;

use ndarray::ArrayView1;

use crate::trend::phase_means::{PhaseMeans, numbers};

/// Time constants that are tried: from this share of a period on, faster ones being over before they
/// matter, ..
const SHORTEST_PERIODS: f64 = 0.2;
/// .. to this multiple of the run, over which an exponential is a slope but for a tenth.
const LONGEST_RUNS: f64 = 5.0;
/// Ratio between time constants that are tried; the sum of squares has no narrower valleys.
const STEP: f64 = 2.0;
/// Golden sections of the best interval: the time constant to 1e-4.
const SECTIONS: usize = 20;
/// Products before an exponential is computed anew: they cost a unit of rounding each.
const RESTART: usize = 256;

/// An exponential decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decay {
    /// Value at the first sample of the run.
    pub amplitude: f64,
    /// Samples in which it falls to 1/e.
    pub time_constant_samples: f64,
}

/// A run without its periodic part, and a slope treated alike.
pub(super) struct Trendless<'a> {
    phases: &'a PhaseMeans,
    pub(super) values: Vec<f64>,
    ramp: Vec<f64>,
}

/// A trend and what it leaves.
#[derive(Clone)]
pub(super) struct Model {
    pub(super) slope: f64,
    pub(super) decay: Option<Decay>,
    /// Of the samples that are numbers, in time order.
    pub(super) residual: Vec<f64>,
    pub(super) n_parameters: usize,
}

impl Model {
    /// Sum of squares that is left.
    pub(super) fn squares(&self) -> f64 {
        dot(&self.residual, &self.residual)
    }

    /// Variance of so many degrees of freedom that are left, less those of the model.
    pub(super) fn variance(&self, n_free: usize) -> f64 {
        self.squares() / (n_free - self.n_parameters) as f64
    }
}

impl<'a> Trendless<'a> {
    pub(super) fn of(signal: ArrayView1<f64>, phases: &'a PhaseMeans) -> Self {
        Self {
            values: phases.without(numbers(signal)),
            ramp: phases.without(phases.times.clone()),
            phases,
        }
    }

    /// Nothing.
    pub(super) fn nothing(&self) -> Model {
        Model {
            slope: 0.0,
            decay: None,
            residual: self.values.clone(),
            n_parameters: 0,
        }
    }

    /// A slope alone.
    pub(super) fn slope(&self) -> Model {
        let (factors, residual) = least_squares([&self.ramp], &self.values);
        Model {
            slope: factors[0],
            decay: None,
            residual,
            n_parameters: 1,
        }
    }

    /// Time constant of the decay that explains most, beside a slope or alone.
    pub(super) fn time_constant(&self, with_slope: bool) -> f64 {
        let beside = if with_slope {
            self.slope()
        } else {
            self.nothing()
        };
        let last = self.phases.times.last().copied().unwrap_or(0.0);
        let (shortest, longest) = (SHORTEST_PERIODS * self.phases.period, LONGEST_RUNS * last);
        let explained = |log: f64| self.explained(log.exp(), with_slope, &beside.residual);
        highest(explained, shortest.ln(), longest.ln()).exp()
    }

    /// Squares that a decay explains of what a slope has left, or of everything.
    fn explained(&self, time_constant: f64, with_slope: bool, left: &[f64]) -> f64 {
        let mut decay = self.decaying(time_constant);
        if with_slope {
            let share = dot(&decay, &self.ramp) / dot(&self.ramp, &self.ramp);
            add(&mut decay, -share, &self.ramp);
        }
        dot(&decay, left).powi(2) / dot(&decay, &decay)
    }

    /// A decay of that time constant, beside a slope or alone.
    pub(super) fn decay(&self, time_constant: f64, with_slope: bool) -> Model {
        let decaying = self.decaying(time_constant);
        let (slope, amplitude, residual) = if with_slope {
            let ([slope, amplitude], residual) =
                least_squares([&self.ramp, &decaying], &self.values);
            (slope, amplitude, residual)
        } else {
            let ([amplitude], residual) = least_squares([&decaying], &self.values);
            (0.0, amplitude, residual)
        };
        Model {
            slope,
            decay: Some(Decay {
                amplitude,
                time_constant_samples: time_constant,
            }),
            residual,
            n_parameters: 2 + usize::from(with_slope),
        }
    }

    /// Trends at `times` by which a model may be off: each by one standard deviation of the noise
    /// that a sample has, none correlated with another.
    pub(super) fn uncertainty(&self, model: &Model, times: &[f64]) -> Vec<Vec<f64>> {
        let mut found: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        for kind in directions(model) {
            let of = |times: &[f64]| times.iter().map(|&time| kind(time)).collect();
            let (mut seen, mut whole) = (self.phases.without(of(&self.phases.times)), of(times));
            for (other, trend) in &found {
                let share = dot(other, &seen);
                add(&mut seen, -share, other);
                add(&mut whole, -share, trend);
            }
            let scale = 1.0 / dot(&seen, &seen).sqrt();
            seen.iter_mut()
                .chain(&mut whole)
                .for_each(|value| *value *= scale);
            found.push((seen, whole));
        }
        found.into_iter().map(|(_, trend)| trend).collect()
    }

    /// `exp(-t/tau)` without its periodic part.
    fn decaying(&self, time_constant: f64) -> Vec<f64> {
        self.phases
            .without(exponential(&self.phases.times, time_constant))
    }
}

/// Derivatives of a model by its parameters, over time.
fn directions(model: &Model) -> Vec<Box<dyn Fn(f64) -> f64>> {
    let mut found: Vec<Box<dyn Fn(f64) -> f64>> = Vec::new();
    if model.slope != 0.0 {
        found.push(Box::new(|time| time));
    }
    if let Some(decay) = model.decay {
        let tau = decay.time_constant_samples;
        found.push(Box::new(move |time| (-time / tau).exp()));
        found.push(Box::new(move |time| time / tau * (-time / tau).exp()));
    }
    found
}

/// `exp(-t/tau)` at whole times; step by step, which is faster than an exponential each.
fn exponential(times: &[f64], time_constant: f64) -> Vec<f64> {
    let step = (-1.0 / time_constant).exp();
    let mut values = Vec::with_capacity(times.len());
    for block in times.chunks(RESTART) {
        let (mut before, mut value) = (block[0], (-block[0] / time_constant).exp());
        for &time in block {
            value *= match time - before {
                0.0 => 1.0,
                1.0 => step,
                gap => (-gap / time_constant).exp(),
            };
            values.push(value);
            before = time;
        }
    }
    values
}

/// Where a function is highest: the best of a grid, then golden sections around it.
fn highest(function: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let n_steps = ((high - low) / STEP.ln()).ceil().max(1.0);
    let step = (high - low) / n_steps;
    let grid = (0..=n_steps as usize).map(|i| low + i as f64 * step);
    let rated = grid.map(|at| (at, function(at)));
    let best = rated.max_by(|a, b| a.1.total_cmp(&b.1));
    let at = best.map_or(low, |(at, _)| at);
    golden_section(function, (at - step).max(low), (at + step).min(high))
}

/// Where a function with one peak is highest (Kiefer, Proc. AMS 4 (1953) 502).
fn golden_section(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let rated = |at: f64| (at, function(at));
    let (mut left, mut right) = (
        rated(high - golden * (high - low)),
        rated(low + golden * (high - low)),
    );
    for _ in 0..SECTIONS {
        if left.1 > right.1 {
            (high, right) = (right.0, left);
            left = rated(high - golden * (high - low));
        } else {
            (low, left) = (left.0, right);
            right = rated(low + golden * (high - low));
        }
    }
    0.5 * (low + high)
}

/// Factors of one or two columns, by Gram and Schmidt, and what they leave; twice, since a trend may
/// be 1e8 times the rest.
fn least_squares<const N: usize>(columns: [&[f64]; N], values: &[f64]) -> ([f64; N], Vec<f64>) {
    let (mut factors, mut left) = ([0.0; N], values.to_vec());
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(N);
    let mut shares = [[0.0; N]; N];
    for (column, share) in zip(columns, &mut shares) {
        let mut column = column.to_vec();
        for (before, share) in zip(&basis, share) {
            *share = dot(before, &column) / dot(before, before);
            add(&mut column, -*share, before);
        }
        basis.push(column);
    }
    for _ in 0..2 {
        let mut found = [0.0; N];
        for (factor, column) in zip(&mut found, &basis) {
            *factor = dot(column, &left) / dot(column, column);
            add(&mut left, -*factor, column);
        }
        for i in (0..N).rev() {
            for j in i + 1..N {
                found[i] -= shares[j][i] * found[j];
            }
            factors[i] += found[i];
        }
    }
    (factors, left)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    zip(a, b).map(|(a, b)| a * b).sum()
}

/// `a += factor b`.
fn add(a: &mut [f64], factor: f64, b: &[f64]) {
    zip(a, b).for_each(|(a, b)| *a += factor * b);
}
