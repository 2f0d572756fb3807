//! Lines that stand out among the others, in one channel: level by level, in windows of neighbouring
//! lines.
//!
//! What lies below excited lines has many levels: noise, rounding (which an odd signal has on odd lines
//! only), distortion. None of them is smooth from line to line, as an excitation mostly is.

use std::ops::Range;

use crate::lines::level_gap::{FEW, GAP_DB, least_excited, middle};

/// An excited line stands as far above the middle of the lines that are not, of its own parity: of
/// random ones, one in ten million does.
const ABOVE_DB: f64 = 14.0;
/// A line counts above so many times the power of the noise in it: one of 10^8 that hold nothing
/// else does.
const ABOVE_NOISE: f64 = 20.0;
/// Lines in a window at least, and as a share of its first line.
const WINDOW: usize = 48;
const SHARE: usize = 8;
/// Excited lines are no weaker than the strongest by more (60 dB): a converter's steps leave such
/// lines anywhere.
const RANGE_DB: f64 = 60.0;
/// Excitations fall by this much per octave at most: with the fourth power of the frequency.
const STEEP_DB: f64 = 24.0;
/// Levels of the lines from 1 on, and what is known of each.
pub(super) struct LineLevels {
    /// In dB; that of the noise where it is higher.
    pub(super) level_db: Vec<f64>,
    is_above_noise: Vec<bool>,
    is_excited: Vec<Option<bool>>,
}

impl LineLevels {
    /// From the power of each line and that of the noise in it; `inexact` is the share of the power
    /// of the strongest line that may be an error.
    pub(super) fn new(power: &[f64], noise: &[f64], inexact: f64) -> Self {
        let strongest = power.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let floor = |noise: f64| (ABOVE_NOISE * noise).max(inexact * strongest);
        let level = |(power, noise): (&f64, &f64)| 10.0 * power.max(floor(*noise)).log10();
        let is_above = |(power, noise): (&f64, &f64)| *power > floor(*noise);
        let mut levels = Self {
            level_db: power.iter().zip(noise).map(level).collect(),
            is_above_noise: power.iter().zip(noise).map(is_above).collect(),
            is_excited: vec![None; power.len()],
        };
        levels.split_windows();
        levels.spread_floor(false);
        levels.spread_floor(true);
        levels.drop_strays();
        levels
    }

    /// Indices of the excited lines: those above the noise that no comparison speaks against.
    pub(super) fn excited(&self) -> Vec<usize> {
        self.strongest(RANGE_DB)
    }

    /// Indices of the excited lines that are not weaker than the strongest by more.
    pub(super) fn strongest(&self, range_db: f64) -> Vec<usize> {
        let levels = self.level_db.iter().copied();
        let least = levels.fold(f64::NEG_INFINITY, f64::max) - range_db.min(RANGE_DB);
        let is_excited = |&line: &usize| {
            self.is_above_noise[line]
                && self.is_excited[line] != Some(false)
                && self.level_db[line] >= least
        };
        (0..self.level_db.len()).filter(is_excited).collect()
    }

    /// The levels of some lines.
    pub(super) fn of<'a>(
        &self,
        lines: impl IntoIterator<Item = &'a usize>,
    ) -> impl Iterator<Item = f64> {
        lines.into_iter().map(|&line| self.level_db[line])
    }

    /// Indices of all lines above the noise.
    pub(super) fn above_noise(&self) -> Vec<usize> {
        (0..self.level_db.len())
            .filter(|&line| self.is_above_noise[line])
            .collect()
    }

    /// Whether nothing sets any line apart from the others.
    pub(super) fn is_uniform(&self) -> bool {
        let lines = 0..self.level_db.len();
        lines
            .clone()
            .all(|line| self.is_above_noise[line] && self.is_excited[line].is_none())
    }

    /// In each window, the lines above and below a gap; a line is judged by the window in which it is
    /// closest to the middle.
    fn split_windows(&mut self) {
        let windows = windows(self.level_db.len());
        let mut first = 0;
        for (index, window) in windows.iter().enumerate() {
            // the middle of what this window and the next have in common
            let next = windows
                .get(index + 1)
                .map(|next| next.start.midpoint(window.end));
            let judged = first..next.unwrap_or(window.end);
            first = judged.end;
            let lines: Vec<usize> = window
                .clone()
                .filter(|&line| self.is_above_noise[line])
                .collect();
            let Some(least) = least_excited(&self.level_db, &lines) else {
                continue;
            };
            for line in lines.into_iter().filter(|line| judged.contains(line)) {
                self.is_excited[line] = Some(self.level_db[line] >= least);
            }
        }
    }

    /// Carries the level of lines that are not excited on to windows in which nothing else is seen.
    fn spread_floor(&mut self, is_backward: bool) {
        let mut windows = windows(self.level_db.len());
        if is_backward {
            windows.reverse();
        }
        let mut floor = [None, None];
        for window in windows {
            for parity in [0, 1] {
                let lines: Vec<usize> = window
                    .clone()
                    .filter(|&line| line % 2 == parity && self.is_above_noise[line])
                    .collect();
                self.below(&lines, floor[parity]);
                floor[parity] = self.middle(&lines).or(floor[parity]);
            }
        }
    }

    /// Lines that do not stand above the floor, in the middle of those that are judged alike, are not
    /// excited.
    fn below(&mut self, lines: &[usize], floor: Option<f64>) {
        let Some(floor) = floor else { return };
        for judged in [None, Some(true)] {
            let alike = lines.iter().copied();
            let alike: Vec<usize> = alike
                .filter(|&line| self.is_excited[line] == judged)
                .collect();
            let middle = middle(&self.level_db, &alike);
            if middle.is_some_and(|middle| middle < floor + ABOVE_DB) {
                self.reject(&alike);
            }
        }
    }

    fn reject(&mut self, lines: &[usize]) {
        lines
            .iter()
            .for_each(|&line| self.is_excited[line] = Some(false));
    }

    /// A line alone that is far below the nearest ones, as a hum or an overtone is, is not excited.
    fn drop_strays(&mut self) {
        loop {
            let lines = self.excited();
            let is_stray = |&at: &usize| is_alone(&lines, at) && self.falls_off(&lines, at);
            let strays = (0..lines.len()).filter(is_stray).map(|at| lines[at]);
            let strays: Vec<usize> = strays.collect();
            if strays.is_empty() {
                return;
            }
            self.reject(&strays);
        }
    }

    /// Whether one of the lines is below a neighbour by more than any excitation falls.
    fn falls_off(&self, lines: &[usize], at: usize) -> bool {
        let steep = |other: &usize| {
            let octaves = ((other + 1) as f64 / (lines[at] + 1) as f64).log2().abs();
            self.level_db[*other] - self.level_db[lines[at]] > GAP_DB + STEEP_DB * octaves
        };
        let before = at.checked_sub(1).and_then(|before| lines.get(before));
        before.is_some_and(steep) || lines.get(at + 1).is_some_and(steep)
    }

    /// Median level of the lines that are not excited, of three at least.
    fn middle(&self, lines: &[usize]) -> Option<f64> {
        let not_excited = lines
            .iter()
            .filter(|&&line| self.is_excited[line] == Some(false));
        let not_excited: Vec<usize> = not_excited.copied().collect();
        middle(&self.level_db, &not_excited).filter(|_| not_excited.len() >= 3)
    }
}

/// Whether few of the lines lie around one of them.
fn is_alone(lines: &[usize], at: usize) -> bool {
    let reach = length(lines[at]) / 2;
    let is_near = |other: &&usize| other.abs_diff(lines[at]) <= reach;
    let before = lines[..at].iter().rev().take_while(is_near).count();
    before + lines[at + 1..].iter().take_while(is_near).count() < FEW
}

/// Windows of neighbouring lines, each half over the next.
fn windows(n_lines: usize) -> Vec<Range<usize>> {
    let mut windows = Vec::new();
    let mut start = 0;
    while start + length(start) < n_lines {
        windows.push(start..start + length(start));
        start += length(start) / 2;
    }
    windows.push(n_lines.saturating_sub(length(start))..n_lines);
    windows
}

/// Length of the window that begins with a line.
fn length(first: usize) -> usize {
    WINDOW.max(first / SHARE)
}
