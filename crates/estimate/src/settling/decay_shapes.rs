//! Shapes over the periods of what has not settled: `z^q`, q the number of the period.
//!
//! A mode `e^{s t}` adds `c z^q`, `z = e^{s T}`, to each line of the periods of length T. Slow real
//! modes have a real z in 0..1; a lightly damped resonance between two lines turns as it decays; in an
//! unstable loop |z| > 1.

use std::f64::consts::TAU;

use num_complex::Complex64;

/// Moduli that are tried; what lies between two of them is met to 95 % by the nearest.
const MODULI: [f64; 7] = [0.0, 0.2, 0.4, 0.6, 0.75, 0.87, 0.95];
/// Turns from period to period are tried in steps of a turn over so many times the number of periods.
const OVERSAMPLING: usize = 2;
/// With fewer periods than this a turn cannot be told from noise.
pub(super) const FEWEST_TURNING: usize = 5;

/// What becomes of a mode from period to period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Mode {
    /// It falls by a factor and turns by an angle in rad.
    Decay { factor: f64, turn: f64 },
    /// The limit of slow decays: a drift by equal steps.
    Drift,
    /// It grows by one over the factor and turns.
    Growth { inverse: f64, turn: f64 },
}

/// A shape at the periods that are there.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub(super) mode: Mode,
    /// Value in every period; largest modulus 1.
    pub(super) values: Vec<Complex64>,
    /// Root of the sum of squares of the values about their mean.
    pub(super) norm: f64,
    /// The values about their mean, over that.
    pub(super) direction: Vec<Complex64>,
}

impl Mode {
    pub(super) fn is_turning(self) -> bool {
        match self {
            Self::Decay { turn, .. } | Self::Growth { turn, .. } => turn != 0.0,
            Self::Drift => false,
        }
    }

    /// The same mode at another modulus.
    pub(super) fn with_modulus(self, modulus: f64) -> Self {
        match self {
            Self::Decay { turn, .. } => Self::Decay {
                factor: modulus,
                turn,
            },
            Self::Growth { turn, .. } => Self::Growth {
                inverse: modulus,
                turn,
            },
            Self::Drift => Self::Drift,
        }
    }

    /// Bias of the mean of values of its shape: how far they are from where they settle, or have
    /// come from, at most how far they go; half of the way of a drift, whose end is unknown.
    pub(super) fn bias(self, values: &[Complex64]) -> f64 {
        let mean = values.iter().sum::<Complex64>() / values.len() as f64;
        let last = values.last().copied().unwrap_or_default();
        let way = |value: &Complex64| (value - last).norm();
        let way = values.iter().map(way).fold(0.0, f64::max);
        match self {
            Self::Drift => 0.5 * way,
            Self::Decay { .. } | Self::Growth { .. } => mean.norm().min(way),
        }
    }

    /// Its shape over the periods of these numbers.
    pub(super) fn over(self, numbers: &[usize]) -> Shape {
        let first = numbers.first().copied().unwrap_or(0);
        let last = numbers.last().copied().unwrap_or(0);
        let power = |modulus: f64, exponent: usize, turn: f64, number: usize| {
            Complex64::from_polar(
                modulus.powi(exponent as i32),
                turn * (number - first) as f64,
            )
        };
        let value = |&number: &usize| match self {
            Self::Decay { factor, turn } => power(factor, number - first, turn, number),
            Self::Growth { inverse, turn } => power(inverse, last - number, turn, number),
            Self::Drift => ((number - first) as f64 / (last - first).max(1) as f64).into(),
        };
        let values: Vec<Complex64> = numbers.iter().map(value).collect();
        let mean = values.iter().sum::<Complex64>() / values.len() as f64;
        let centred = values.iter().map(|value| value - mean);
        let norm = centred
            .clone()
            .map(|value| value.norm_sqr())
            .sum::<f64>()
            .sqrt();
        Shape {
            mode: self,
            direction: centred.map(|value| value / norm).collect(),
            norm,
            values,
        }
    }
}

/// Every shape that is tried with the periods of these numbers: those that do not turn, then those
/// that do.
pub(super) fn shapes(numbers: &[usize]) -> [Vec<Shape>; 2] {
    let of_turn = |turn: f64| {
        let decays = MODULI.map(|factor| Mode::Decay { factor, turn });
        let growths = MODULI.map(|inverse| Mode::Growth { inverse, turn });
        // at the modulus 0 there is one period, and nothing turns
        let is_met = move |mode: &Mode| turn == 0.0 || mode.with_modulus(0.0) != *mode;
        decays.into_iter().chain(growths).filter(is_met)
    };
    let steady = of_turn(0.0).chain([Mode::Drift]);
    let n_turns = match numbers.len() {
        0..FEWEST_TURNING => 1,
        n_periods => OVERSAMPLING * n_periods,
    };
    let turning = fractions_of_a_turn(n_turns).flat_map(of_turn);
    let over = |mode: Mode| mode.over(numbers);
    [steady.map(over).collect(), turning.map(over).collect()]
}

/// Angles between none and a full turn in rad, in so many steps.
fn fractions_of_a_turn(n_steps: usize) -> impl Iterator<Item = f64> {
    (1..n_steps).map(move |i| TAU * i as f64 / n_steps as f64)
}

/// Steady turns by any angle, of a disturbance beside the lines: not a transient.
pub(super) fn steady_turns(numbers: &[usize]) -> Vec<Shape> {
    let turns = fractions_of_a_turn(4 * numbers.len());
    let steady = |turn| Mode::Decay { factor: 1.0, turn };
    turns.map(|turn| steady(turn).over(numbers)).collect()
}
