//! Recordings of random multisines as people make them: rests around the runs, several runs in one
//! file, noise, lost samples.

use std::f64::consts::TAU;
use std::ops::Range;

use frfid_signals::random::{normal, phase, stream, uniform};

/// Uniform choices, one after the other, by seed.
pub(crate) struct Chance {
    seed: u64,
    drawn: u64,
}

impl Chance {
    pub(crate) fn new(seed: u64) -> Self {
        Self { seed, drawn: 0 }
    }

    pub(crate) fn uniform(&mut self) -> f64 {
        self.drawn += 1;
        uniform(&mut stream(self.seed, "chance", &[self.drawn]))
    }

    /// A whole number of the range.
    pub(crate) fn whole(&mut self, range: Range<usize>) -> usize {
        range.start + (self.uniform() * range.len() as f64) as usize
    }

    pub(crate) fn one_of<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.whole(0..of.len())]
    }
}

/// Standard normal samples.
pub(crate) fn noise(n_samples: usize, seed: u64) -> Vec<f64> {
    let mut rng = stream(seed, "noise", &[]);
    (0..n_samples).map(|_| normal(&mut rng)).collect()
}

/// A random-phase multisine, whose period need not be whole.
pub(crate) struct Multisine {
    period: f64,
    lines: Vec<usize>,
    amplitudes: Vec<f64>,
    phases: Vec<f64>,
}

impl Multisine {
    pub(crate) fn new(
        period: f64,
        lines: &[usize],
        amplitude: impl Fn(usize) -> f64,
        seed: u64,
    ) -> Self {
        let mut rng = stream(seed, "phases", &[]);
        Self {
            period,
            lines: lines.to_vec(),
            amplitudes: lines.iter().map(|&line| amplitude(line)).collect(),
            phases: lines.iter().map(|_| phase(&mut rng)).collect(),
        }
    }

    pub(crate) fn rms(&self) -> f64 {
        (self
            .amplitudes
            .iter()
            .map(|amplitude| 0.5 * amplitude * amplitude)
            .sum::<f64>())
        .sqrt()
    }

    pub(crate) fn samples(&self, n_samples: usize) -> Vec<f64> {
        if self.period == self.period.round() {
            let one: Vec<f64> = (0..self.period as usize)
                .map(|k| self.at(k as f64))
                .collect();
            return (0..n_samples).map(|k| one[k % one.len()]).collect();
        }
        (0..n_samples).map(|k| self.at(k as f64)).collect()
    }

    fn at(&self, k: f64) -> f64 {
        let terms = self.lines.iter().zip(&self.amplitudes).zip(&self.phases);
        terms
            .map(|((&line, amplitude), phase)| {
                let turns = (line as f64 * k / self.period).fract();
                amplitude * (TAU * turns + phase).sin()
            })
            .sum()
    }
}

/// Odd lines, all lines of a band, every third, random-grid odd, log-spaced.
pub(crate) fn lines(kind: usize, highest: usize, chance: &mut Chance) -> Vec<usize> {
    let highest = highest.max(9);
    match kind {
        0 => (1..=highest).step_by(2).collect(),
        1 => (highest / 8 + 1..=highest).collect(),
        2 => (1..=highest).step_by(3).collect(),
        3 => {
            let odd: Vec<usize> = (1..=highest).step_by(2).collect();
            let dropped: Vec<usize> = odd.chunks(4).map(|_| chance.whole(0..4)).collect();
            let kept = |&index: &usize| index < 4 || index % 4 != dropped[index / 4];
            (0..odd.len())
                .filter(kept)
                .map(|index| odd[index])
                .collect()
        }
        _ => {
            let mut lines: Vec<usize> = (0..30)
                .map(|i| (2.0 * (highest as f64 / 2.0).powf(i as f64 / 29.0)).round() as usize)
                .collect();
            lines.push(1);
            lines.sort_unstable();
            lines.dedup();
            lines
        }
    }
}
