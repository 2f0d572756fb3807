//! Lines that stand out among the others, in one channel: level by level, in windows of neighbouring
//! lines.
//!
//! What lies below excited lines has many levels: noise, rounding (which an odd signal has on odd lines
//! only), distortion. None of them is smooth from line to line, as an excitation mostly is.

use std::ops::Range;

/// Smallest gap between the weakest excited line of a window and the strongest other one (12 dB).
const GAP_DB: f64 = 12.0;
/// An excited line stands as far above the middle of the lines that are not, of its own parity: of
/// random ones, one in ten million does.
const ABOVE_DB: f64 = 14.0;
/// A line counts above so many times the power of the noise in it: one of 10^8 that hold nothing
/// else does.
const ABOVE_NOISE: f64 = 20.0;
/// Amplitudes below this share of the strongest are rounding.
const ROUNDING: f64 = 1e-10;
/// Lines in a window at least, and as a share of its first line.
const WINDOW: usize = 48;
const SHARE: usize = 8;
/// Levels are smooth if second differences, over those of independent numbers of the same spread,
/// are below this; random lines have 5.6 dB.
const SMOOTH_DB: f64 = 2.5;
/// Fewer lines are smooth by chance.
const FEW: usize = 6;
/// In a steep spectrum the lowest lines lie far apart.
const LOWEST: usize = 4;

/// Levels of the lines from 1 on, and what is known of each.
pub(super) struct LineLevels {
    /// In dB; that of the noise where it is higher.
    pub(super) level_db: Vec<f64>,
    is_above_noise: Vec<bool>,
    is_excited: Vec<Option<bool>>,
}

impl LineLevels {
    /// From the power of each line and that of the noise in it.
    pub(super) fn new(power: &[f64], noise: &[f64]) -> Self {
        let strongest = power.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let floor = |noise: f64| (ABOVE_NOISE * noise).max(ROUNDING * ROUNDING * strongest);
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
        levels
    }

    /// Indices of the excited lines: those above the noise that no comparison speaks against.
    pub(super) fn excited(&self) -> Vec<usize> {
        let lines = 0..self.level_db.len();
        lines.filter(|&line| self.is_above_noise[line] && self.is_excited[line] != Some(false)).collect()
    }

    /// Whether nothing sets any line apart from the others.
    pub(super) fn is_uniform(&self) -> bool {
        let lines = 0..self.level_db.len();
        lines.clone().all(|line| self.is_above_noise[line] && self.is_excited[line].is_none())
    }

    /// In each window, the lines above and below a gap.
    fn split_windows(&mut self) {
        for window in windows(self.level_db.len()) {
            let quarter = window.len() / 4;
            let inner = match (window.start, window.end) {
                (0, end) if end == self.level_db.len() => window.clone(),
                (0, end) => 0..end - quarter,
                (start, end) if end == self.level_db.len() => start + quarter..end,
                (start, end) => start + quarter..end - quarter,
            };
            let lines: Vec<usize> = window.filter(|&line| self.is_above_noise[line]).collect();
            let Some(least) = self.least_excited(&lines) else { continue };
            for line in lines.into_iter().filter(|line| inner.contains(line)) {
                self.is_excited[line] = Some(self.level_db[line] >= least);
            }
        }
    }

    /// The level from which on lines are excited, if there is a gap below it.
    fn least_excited(&self, lines: &[usize]) -> Option<f64> {
        let (lowest, others): (Vec<usize>, Vec<usize>) = lines.iter().partition(|&&line| line < LOWEST);
        let Some(least) = self.gap(&others) else { return self.gap(lines) };
        let nearest = others.iter().find(|&&line| self.level_db[line] >= least)?;
        let reach = self.level_db[*nearest] - GAP_DB;
        let low = lowest.iter().map(|&line| self.level_db[line]).filter(|&level| level >= reach);
        Some(low.fold(least, f64::min))
    }

    /// The lowest level above the first gap below which nothing is smooth.
    fn gap(&self, lines: &[usize]) -> Option<f64> {
        let mut falling = lines.to_vec();
        falling.sort_by(|&a, &b| self.level_db[b].total_cmp(&self.level_db[a]));
        let is_joined = |a: &usize, b: &usize| self.level_db[*a] - self.level_db[*b] < GAP_DB;
        let groups: Vec<&[usize]> = falling.chunk_by(is_joined).collect();
        let last = groups.iter().rposition(|group| self.is_smooth(group)).unwrap_or(0);
        let below: usize = groups.iter().skip(last + 1).map(|group| group.len()).sum();
        let is_gap = below >= FEW || below > 0 && (self.is_smooth(groups[last]) || groups[last].len() < FEW);
        is_gap.then(|| groups[last].last().map(|&line| self.level_db[line]))?
    }

    fn is_smooth(&self, lines: &[usize]) -> bool {
        let mut rising = lines.to_vec();
        rising.sort_unstable();
        let levels: Vec<f64> = rising.iter().map(|&line| self.level_db[line]).collect();
        let bends: Vec<f64> = levels.windows(3).map(|l| l[0] - 2.0 * l[1] + l[2]).collect();
        let mean = bends.iter().map(|bend| bend * bend).sum::<f64>() / bends.len() as f64;
        lines.len() >= FEW && (mean / 6.0).sqrt() <= SMOOTH_DB
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

    /// Lines that do not stand above the floor are not excited.
    fn below(&mut self, lines: &[usize], floor: Option<f64>) {
        let Some(floor) = floor else { return };
        for &line in lines {
            if self.level_db[line] < floor + ABOVE_DB {
                self.is_excited[line] = Some(false);
            }
        }
    }

    /// Median level of the lines that are not excited, of three at least.
    fn middle(&self, lines: &[usize]) -> Option<f64> {
        let not_excited = lines.iter().filter(|&&line| self.is_excited[line] == Some(false));
        let mut levels: Vec<f64> = not_excited.map(|&line| self.level_db[line]).collect();
        levels.sort_unstable_by(f64::total_cmp);
        (levels.len() >= 3).then(|| levels[levels.len() / 2])
    }
}

/// Windows of neighbouring lines, each half over the next.
fn windows(n_lines: usize) -> Vec<Range<usize>> {
    let mut windows = Vec::new();
    let mut start = 0;
    loop {
        let length = WINDOW.max(start / SHARE);
        if start + length >= n_lines {
            windows.push(n_lines.saturating_sub(length)..n_lines);
            return windows;
        }
        windows.push(start..start + length);
        start += length / 2;
    }
}
