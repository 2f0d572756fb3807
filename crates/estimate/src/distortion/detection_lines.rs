//! Detection lines of a multisine: those of its band that are not excited, odd and even, in groups.

use std::ops::RangeInclusive;

use frfid_signals::greatest_common_divisor;
use ndarray::{Array2, ArrayView2};
use num_complex::Complex64;

use crate::distortion::bursts::Pairs;
use crate::error::EstimateError;
use crate::spectra::campaign::Campaign;
use crate::spectra::line_dft::{LineDft, check_lines};
use crate::spectra::run_spectra::RunSpectra;

/// Lines of a group: 12 exponentially distributed powers are known to 2.6 dB in 95 of 100 cases.
const FEWEST: usize = 12;
/// Relative width that a group has at least.
const WIDTH: f64 = 0.03;
/// Lines of a group that are looked at: the others say the same.
const MOST: usize = 48;
/// Lines that are looked at or left out together: what neighbours have in common is seen.
const TOGETHER: usize = 8;

/// Realizations that are looked at on the detection lines: more tell little more of the levels, and memory shall not
/// grow with the length of a campaign.
const REALIZATIONS: usize = 16;

/// Lines of one parity, by their places among the detection lines.
pub(super) type Group = Vec<usize>;

/// The lines of a period between the first and the last that is excited, planned once, used for every run.
#[derive(Clone)]
pub struct DetectionLines {
    /// All of them, excited ones included.
    dft: LineDft,
    /// Places of the excited lines, and of the others, among all.
    places: [Vec<usize>; 2],
    pub(super) excited: Vec<usize>,
    pub(super) free: Vec<usize>,
    pub(super) odd: Vec<Group>,
    pub(super) even: Vec<Group>,
    /// Greatest common divisor of the excited lines.
    divisor: usize,
}

impl DetectionLines {
    /// Those of a period of `n_samples` on which the lines `excited`, which rise, are excited.
    ///
    /// Odd and even are meant over the greatest common divisor of the excited lines; `None` where one of these is
    /// even, so that every nonlinearity reaches every line, and where no line is left between them.
    ///
    /// # Errors
    /// Those of [`LineDft::new`].
    pub fn new(n_samples: usize, excited: &[usize]) -> Result<Option<Self>, EstimateError> {
        check_lines(n_samples, excited)?;
        let excited_64 = excited.iter().map(|&line| line as u64);
        let divisor = excited_64.fold(0, greatest_common_divisor) as usize;
        let is_odd = |line: usize| line / divisor % 2 == 1;
        let free = free_lines(excited, divisor);
        if free.is_empty() || !excited.iter().all(|&line| is_odd(line)) {
            return Ok(None);
        }
        let (odd, even): (Vec<usize>, Vec<usize>) =
            free.into_iter().partition(|&line| is_odd(line));
        let groups = [odd, even].map(|lines| grouped(&lines));
        Self::of_groups(n_samples, (excited, divisor), groups).map(Some)
    }

    /// Whether a realization is looked at on them.
    #[must_use]
    pub fn look_at(realization: usize) -> bool {
        realization < REALIZATIONS
    }

    fn of_groups(
        n_samples: usize,
        (excited, divisor): (&[usize], usize),
        groups: [Vec<Vec<usize>>; 2],
    ) -> Result<Self, EstimateError> {
        let free = rising(groups.iter().flatten().flatten());
        let all = rising(excited.iter().chain(&free));
        let placed = |groups: Vec<Group>| groups.iter().map(|group| places(&free, group)).collect();
        let [odd, even] = groups.map(placed);
        Ok(Self {
            dft: LineDft::new(n_samples, &all)?,
            places: [places(&all, excited), places(&all, &free)],
            excited: excited.to_vec(),
            free,
            odd,
            even,
            divisor,
        })
    }

    /// Spectra of one period on the excited lines, as [`LineDft`] makes them, and on the detection lines.
    ///
    /// # Errors
    /// As [`RunSpectra::of`].
    pub fn spectra(
        &self,
        u: ArrayView2<f64>,
        y: ArrayView2<f64>,
        r: Option<ArrayView2<f64>>,
    ) -> Result<[RunSpectra; 2], EstimateError> {
        Ok(self.split(&RunSpectra::of(&self.dft, u, y, r)?))
    }

    /// The transform on the excited lines alone, which takes half the time where they are odd.
    pub(super) fn excited_dft(&self) -> Result<LineDft, EstimateError> {
        LineDft::new(self.dft.n_samples(), &self.excited)
    }

    /// Pairs of lines of the groups of one parity.
    pub(super) fn pairs(&self, groups: &[Group]) -> Pairs {
        Pairs::of(&self.free, groups, 2 * self.divisor)
    }

    /// Spectra on all lines apart: on the excited lines and on the detection lines.
    fn split(&self, all: &RunSpectra) -> [RunSpectra; 2] {
        let at = |places: &Vec<usize>| {
            let of = |spectra: &Array2<Complex64>| {
                let shape = (spectra.nrows(), places.len());
                Array2::from_shape_fn(shape, |(channel, line)| spectra[[channel, places[line]]])
            };
            RunSpectra {
                u: of(&all.u),
                y: of(&all.y),
                r: all.r.as_ref().map(of),
            }
        };
        [at(&self.places[0]), at(&self.places[1])]
    }

    /// An empty campaign for spectra on the detection lines.
    ///
    /// # Errors
    /// Those of [`LineDft::frequency_hz`].
    pub fn campaign(&self, sample_time_s: f64) -> Result<Campaign, EstimateError> {
        let [_, free] = self.campaigns(sample_time_s)?;
        Ok(free)
    }

    /// Empty campaigns on the excited lines and on the detection lines.
    pub(super) fn campaigns(&self, sample_time_s: f64) -> Result<[Campaign; 2], EstimateError> {
        let frequency_hz = self.dft.frequency_hz(sample_time_s)?;
        let at = |places: &Vec<usize>| {
            Campaign::new(places.iter().map(|&place| frequency_hz[place]).collect())
        };
        Ok([at(&self.places[0])?, at(&self.places[1])?])
    }

    /// Factor from the power of a line to its mean square.
    pub(super) fn mean_square(&self) -> f64 {
        2.0 / (self.dft.n_samples() as f64).powi(2)
    }

    /// Places of the excited lines that stand within a group; those beside it where none does.
    pub(super) fn excited_within(&self, group: &Group) -> RangeInclusive<usize> {
        let below = |place: usize| {
            let line = self.free[place];
            self.excited.partition_point(|&excited| excited < line)
        };
        match (below(group[0]), below(group[group.len() - 1])) {
            (from, to) if from < to => from..=to - 1,
            (from, _) => from - 1..=from,
        }
    }
}

/// Multiples of `divisor` between the first and the last excited line that are not excited.
fn free_lines(excited: &[usize], divisor: usize) -> Vec<usize> {
    let band = excited[0]..excited[excited.len() - 1];
    let is_free = |line: &usize| excited.binary_search(line).is_err();
    band.step_by(divisor).filter(is_free).collect()
}

fn rising<'a>(lines: impl Iterator<Item = &'a usize>) -> Vec<usize> {
    let mut lines: Vec<usize> = lines.copied().collect();
    lines.sort_unstable();
    lines
}

fn places(among: &[usize], lines: &[usize]) -> Vec<usize> {
    let place = |&line: &usize| among.partition_point(|&other| other < line);
    lines.iter().map(place).collect()
}

/// Lines in groups that are numerous and wide enough; what is left over belongs to the last.
fn grouped(lines: &[usize]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut rest = lines;
    while !rest.is_empty() {
        let n = group_length(rest);
        let (group, others) = rest.split_at(n);
        match groups.last_mut() {
            Some(last) if !is_enough(group) => last.extend(group),
            _ => groups.push(group.to_vec()),
        }
        rest = others;
    }
    groups.iter().map(|group| thinned(group)).collect()
}

/// Number of leading lines that make a group.
fn group_length(lines: &[usize]) -> usize {
    let full = (FEWEST..=lines.len()).find(|&n| is_enough(&lines[..n]));
    full.unwrap_or(lines.len())
}

fn is_enough(lines: &[usize]) -> bool {
    let ratio = lines[lines.len() - 1] as f64 / lines[0] as f64;
    lines.len() >= FEWEST && ratio >= 1.0 + WIDTH
}

fn thinned(lines: &[usize]) -> Vec<usize> {
    let step = lines.len().div_ceil(MOST);
    let kept = lines.chunks(TOGETHER).step_by(step);
    kept.flatten().copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(excited: &[usize]) -> Option<DetectionLines> {
        DetectionLines::new(4096, excited).expect("on the grid")
    }

    #[test]
    fn parity_is_over_the_divisor_and_full_grids_have_none() {
        let found = lines(&[3, 5, 9, 13]).expect("odd");
        assert_eq!(found.free, [4, 6, 7, 8, 10, 11, 12]);
        assert_eq!((found.odd.len(), found.even.len()), (1, 1));
        assert_eq!(found.odd[0], [2, 5]);
        assert_eq!(lines(&[9, 15, 27]).expect("odd").free, [12, 18, 21, 24]);
        assert!(lines(&[3, 4, 9]).is_none() && lines(&[7]).is_none());
        assert!(DetectionLines::new(64, &[40]).is_err());
    }

    #[test]
    fn groups_hold_every_line_once_and_are_wide_enough() {
        let odd: Vec<usize> = (1..1999).step_by(2).filter(|line| line % 8 != 5).collect();
        let found = lines(&odd).expect("odd");
        assert!(
            found
                .odd
                .iter()
                .chain(&found.even)
                .all(|group| (12..=48).contains(&group.len()))
        );
        let all: usize = found.odd.iter().map(Vec::len).sum();
        assert_eq!(all, (1..1999).step_by(8).count() - 1);
        let within = found.excited_within(&found.even[3]);
        assert!(found.excited[*within.start()] > found.free[found.even[3][0]]);
    }
}
