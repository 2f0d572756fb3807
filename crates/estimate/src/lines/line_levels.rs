//! Lines that stand out among the others, in one channel: level by level, in windows of neighbouring
//! lines.
//!
//! What lies below excited lines has many levels: noise, rounding (which an odd signal has on odd lines
//! only), distortion. None of them is smooth from line to line, as an excitation mostly is.

use std::iter::zip;
use std::mem::replace;
use std::ops::Range;

use crate::lines::level_gap::{FEW, GAP_DB, RANGE_DB, least_excited, middle};

/// An excited line stands as far above the middle of the lines that are not, of its own parity: of
/// random ones, one in ten million does.
const ABOVE_DB: f64 = 14.0;
/// A line counts above so many times the power of the noise in it: one of 10^8 that hold nothing
/// else does.
const ABOVE_NOISE: f64 = 20.0;
/// Lines in a window at least, and as a share of its first line.
const WINDOW: usize = 48;
const SHARE: usize = 8;
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
        let mut levels = Self::above(power, &floor(power, noise, inexact));
        levels.split_windows();
        levels.spread_floor();
        levels.drop_strays();
        levels
    }

    /// Levels above a floor for each line, none judged.
    fn above(power: &[f64], floor: &[f64]) -> Self {
        let level = |(power, floor): (&f64, &f64)| 10.0 * power.max(*floor).log10();
        Self {
            level_db: zip(power, floor).map(level).collect(),
            is_above_noise: zip(power, floor)
                .map(|(power, floor)| power > floor)
                .collect(),
            is_excited: vec![None; power.len()],
        }
    }

    /// Indices of the excited lines: those above the noise that no comparison speaks against.
    pub(super) fn excited(&self) -> Vec<usize> {
        self.strongest(RANGE_DB)
    }

    /// Indices of the excited lines that are not weaker than the strongest by more.
    pub(super) fn strongest(&self, range_db: f64) -> Vec<usize> {
        let highest = self
            .level_db
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        let least = highest - range_db.min(RANGE_DB);
        let mut lines = self.above_noise();
        lines.retain(|&line| self.is_excited[line] != Some(false) && self.level_db[line] >= least);
        lines
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
        self.above_noise_in(0..self.level_db.len())
    }

    fn above_noise_in(&self, window: Range<usize>) -> Vec<usize> {
        window.filter(|&line| self.is_above_noise[line]).collect()
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
        for (window, judged) in zip(windows.clone(), judged(&windows)) {
            self.split(window, judged);
        }
    }

    fn split(&mut self, window: Range<usize>, judged: Range<usize>) {
        let mut lines = self.above_noise_in(window);
        if let Some(least) = least_excited(&self.level_db, &lines) {
            lines.retain(|line| judged.contains(line));
            self.judge(&lines, least);
        }
    }

    fn judge(&mut self, lines: &[usize], least: f64) {
        for &line in lines {
            self.is_excited[line] = Some(self.level_db[line] >= least);
        }
    }

    /// Carries the level of lines that are not excited on to windows in which nothing else is seen.
    fn spread_floor(&mut self) {
        let forward = windows(self.level_db.len());
        let backward: Vec<Range<usize>> = forward.iter().rev().cloned().collect();
        for parity in [0, 1] {
            self.carry_floor(&forward, parity);
            self.carry_floor(&backward, parity);
        }
    }

    /// From window to window, for the lines of one parity.
    fn carry_floor(&mut self, windows: &[Range<usize>], parity: usize) {
        let mut floor = f64::NEG_INFINITY;
        for window in windows {
            let mut lines = self.above_noise_in(window.clone());
            lines.retain(|line| line % 2 == parity);
            self.below(&lines, floor);
            floor = self.middle(&lines).unwrap_or(floor);
        }
    }

    /// Lines that do not stand above the floor, in the middle of those that are judged alike, are not
    /// excited.
    fn below(&mut self, lines: &[usize], floor: f64) {
        for judgement in [None, Some(true)] {
            let alike = self.judged_so(lines, judgement);
            let middle = middle(&self.level_db, &alike);
            if middle.is_some_and(|middle| middle < floor + ABOVE_DB) {
                self.reject(&alike);
            }
        }
    }

    /// Those of the lines with this judgement.
    fn judged_so(&self, lines: &[usize], judgement: Option<bool>) -> Vec<usize> {
        let lines = lines.iter().copied();
        let alike = lines.filter(|&line| self.is_excited[line] == judgement);
        alike.collect()
    }

    fn reject(&mut self, lines: &[usize]) {
        lines
            .iter()
            .for_each(|&line| self.is_excited[line] = Some(false));
    }

    /// A line alone that is far below the nearest ones, as a hum or an overtone is, is not excited.
    fn drop_strays(&mut self) {
        loop {
            let strays = self.strays();
            if strays.is_empty() {
                return;
            }
            self.reject(&strays);
        }
    }

    fn strays(&self) -> Vec<usize> {
        let lines = self.excited();
        let is_stray = |&at: &usize| is_alone(&lines, lines[at]) && self.falls_off(&lines, at);
        let strays = (0..lines.len()).filter(is_stray);
        strays.map(|at| lines[at]).collect()
    }

    /// Whether one of the lines is below a neighbour by more than any excitation falls.
    fn falls_off(&self, lines: &[usize], at: usize) -> bool {
        let is_below = |other| self.is_far_below(lines[at], other);
        lines[..at].last().is_some_and(is_below) || lines.get(at + 1).is_some_and(is_below)
    }

    fn is_far_below(&self, line: usize, other: &usize) -> bool {
        let octaves = ((other + 1) as f64 / (line + 1) as f64).log2().abs();
        self.level_db[*other] - self.level_db[line] > GAP_DB + STEEP_DB * octaves
    }

    /// Median level of the lines that are not excited, of three at least.
    fn middle(&self, lines: &[usize]) -> Option<f64> {
        let not_excited = self.judged_so(lines, Some(false));
        middle(&self.level_db, &not_excited).filter(|_| not_excited.len() >= 3)
    }
}

/// Whether few of the rising lines lie around one of them.
fn is_alone(lines: &[usize], line: usize) -> bool {
    let reach = length(line) / 2;
    let first = lines.partition_point(|other| other + reach < line);
    let end = lines.partition_point(|&other| other <= line + reach);
    end - first <= FEW
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

/// The lines that each window judges: up to the middle of what it and the next have in common.
fn judged(windows: &[Range<usize>]) -> Vec<Range<usize>> {
    let common = windows.windows(2).map(|pair| pair[1].start..pair[0].end);
    let ends = common.map(|common| common.start.midpoint(common.end));
    let ends = ends.chain(windows.last().map(|window| window.end));
    ends.scan(0, |first, end| Some(replace(first, end)..end))
        .collect()
}

/// Power up to which each line may be noise, or an error.
fn floor(power: &[f64], noise: &[f64], inexact: f64) -> Vec<f64> {
    let strongest = power.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let rounding = inexact * strongest;
    let floor = noise
        .iter()
        .map(|noise| (ABOVE_NOISE * noise).max(rounding));
    floor.collect()
}

/// Length of the window that begins with a line.
fn length(first: usize) -> usize {
    WINDOW.max(first / SHARE)
}
