//! Draws of random phases: realizations that repeat one are found by measurement and counted as
//! repetitions, since they know the noise but not the nonlinear distortion.

use std::collections::hash_map::DefaultHasher;
use std::collections::{BTreeMap, HashSet};
use std::fmt;
use std::hash::{Hash, Hasher};

use num_complex::Complex64;
use rayon::prelude::*;

use crate::period_index::PeriodIndex;
use crate::spectra::campaign::{Campaign, RunSpectra};
use crate::spectra::delay::{DelaySearch, Shift};
use crate::spectra::draw_match::{Drawn, Repeat};

/// Realizations with the same draw of phases.
#[derive(Debug, Clone, PartialEq)]
pub struct EqualDraws {
    /// Their numbers, rising; all count as repetitions of the first.
    pub realizations: Vec<usize>,
    /// What a shift in time and a constant phase leave of the differences of their phases, rms of
    /// the worst experiment in rad.
    pub residual_rad: f64,
    /// Number of lines that were compared: one or two are always equal but for a shift.
    pub n_lines: usize,
    /// Periods left out because u and y are those of another realization bit for bit: a copy is no
    /// measurement of its own.
    pub n_copies: usize,
}

impl fmt::Display for EqualDraws {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers: Vec<_> = self.realizations.iter().map(usize::to_string).collect();
        let numbers = numbers.join(", ");
        match self.n_lines {
            1 => write!(
                f,
                "realizations {numbers} excite one line, so that a shift in time makes them the same draw of phases"
            )?,
            _ => write!(
                f,
                "realizations {numbers} are the same draw of phases (residual {:.2} rad)",
                self.residual_rad
            )?,
        }
        f.write_str(": counted as repetitions")?;
        match self.n_copies {
            0 => Ok(()),
            n => write!(f, ", {n} periods left out as copies bit for bit of others"),
        }
    }
}

/// A realization that repeats another: for each of its experiments which one, and how.
struct Repetition {
    realization: usize,
    experiments: Vec<(usize, Repeat)>,
}

/// The realizations of one draw.
struct Group {
    first: usize,
    repetitions: Vec<Repetition>,
}

impl Campaign {
    /// Finds realizations with the same draw of phases, and makes their periods further periods of
    /// the first of them, spectra turned by the shift in time between them. Returns which those are.
    ///
    /// Two realizations are one draw if on the lines that both excite, over all channels of an
    /// experiment, the phases of the reference (of the input where there is none) differ by a delay
    /// and a constant, with a residual below 0.2 rad or three times what the noise explains, and
    /// below what random phases reach by chance. The experiments may be in another order. Periods
    /// whose u and y are bit for bit those of another realization are left out: measured twice they
    /// would differ by their noise.
    pub fn pool_equal_draws(&mut self) -> Vec<EqualDraws> {
        let drawn = self.drawn();
        if drawn.len() < 2 {
            return Vec::new();
        }
        let groups = groups(&drawn, &DelaySearch::new(&self.frequency_hz));
        let equal = groups.iter().filter(|group| !group.repetitions.is_empty());
        equal.map(|group| self.pool(group)).collect()
    }

    /// What the experiments of every realization excite; realizations that lack one are left out.
    fn drawn(&self) -> Vec<(usize, Vec<Drawn>)> {
        let mut periods: BTreeMap<usize, Vec<Vec<&RunSpectra>>> = BTreeMap::new();
        for (place, run) in &self.runs {
            let experiments = periods
                .entry(place.realization)
                .or_insert_with(|| vec![Vec::new(); self.n_experiments()]);
            experiments[place.experiment].push(run);
        }
        periods.retain(|_, experiments| experiments.iter().all(|runs| !runs.is_empty()));
        let drawn = periods.into_iter().map(|(realization, experiments)| {
            let drawn = experiments.iter().map(|runs| Drawn::of(runs));
            (realization, drawn.collect())
        });
        drawn.collect()
    }

    /// Makes the periods of all realizations of a group periods of the first.
    fn pool(&mut self, group: &Group) -> EqualDraws {
        let mut seen: HashSet<u64> = self.fingerprints(group.first).into_values().collect();
        let mut n_copies = 0;
        for repetition in &group.repetitions {
            let fingerprints = self.fingerprints(repetition.realization);
            for (&period, fingerprint) in &fingerprints {
                let runs = self.take(repetition.realization, period);
                if seen.contains(fingerprint) {
                    n_copies += 1;
                } else {
                    self.append(group.first, repetition, runs);
                }
            }
            seen.extend(fingerprints.into_values());
        }
        group.told(n_copies)
    }

    /// A number for each period of a realization that is the same only if u and y are, bit for bit.
    fn fingerprints(&self, realization: usize) -> BTreeMap<usize, u64> {
        let mut hashers: BTreeMap<usize, DefaultHasher> = BTreeMap::new();
        for (place, run) in &self.runs {
            if place.realization == realization {
                let hasher = hashers.entry(place.period).or_default();
                for value in run.u.iter().chain(&run.y) {
                    (value.re.to_bits(), value.im.to_bits()).hash(hasher);
                }
            }
        }
        let finished = hashers.into_iter();
        finished
            .map(|(period, hasher)| (period, hasher.finish()))
            .collect()
    }

    /// Takes the runs of a period out.
    fn take(&mut self, realization: usize, period: usize) -> Vec<(usize, RunSpectra)> {
        let places = (0..self.n_experiments()).map(|experiment| PeriodIndex {
            realization,
            period,
            experiment,
        });
        let places: Vec<_> = places.collect();
        let runs = places.into_iter();
        runs.filter_map(|place| Some((place.experiment, self.runs.remove(&place)?)))
            .collect()
    }

    /// Adds the runs of a repetition as the last period of a realization.
    fn append(
        &mut self,
        realization: usize,
        repetition: &Repetition,
        runs: Vec<(usize, RunSpectra)>,
    ) {
        let periods = self.runs.keys();
        let periods = periods.filter(|place| place.realization == realization);
        let period = periods.map(|place| place.period + 1).max().unwrap_or(0);
        for (own, mut run) in runs {
            let (experiment, repeat) = repetition.experiments[own];
            run.turn_back(repeat.shift, &self.frequency_hz);
            let place = PeriodIndex {
                realization,
                period,
                experiment,
            };
            self.runs.insert(place, run);
        }
    }
}

impl Group {
    /// What there is to say of it.
    fn told(&self, n_copies: usize) -> EqualDraws {
        let repeats = || {
            let all = self.repetitions.iter();
            all.flat_map(|repetition| repetition.experiments.iter().map(|(_, repeat)| repeat))
        };
        let others = self.repetitions.iter();
        let others = others.map(|repetition| repetition.realization);
        EqualDraws {
            realizations: std::iter::once(self.first).chain(others).collect(),
            residual_rad: repeats()
                .map(|repeat| repeat.residual_rad)
                .fold(0.0, f64::max),
            n_lines: repeats().map(|repeat| repeat.n_lines).min().unwrap_or(0),
            n_copies,
        }
    }
}

impl RunSpectra {
    /// Undoes a shift in time.
    fn turn_back(&mut self, shift: Shift, frequency_hz: &[f64]) {
        let factors: Vec<Complex64> = frequency_hz.iter().map(|&hz| shift.undone(hz)).collect();
        for signal in [Some(&mut self.u), Some(&mut self.y), self.r.as_mut()] {
            for mut channel in signal.into_iter().flat_map(|signal| signal.rows_mut()) {
                for (value, factor) in channel.iter_mut().zip(&factors) {
                    *value *= factor;
                }
            }
        }
    }
}

/// Groups of realizations of one draw, each by its first.
fn groups(drawn: &[(usize, Vec<Drawn>)], search: &DelaySearch) -> Vec<Group> {
    let peaks = peaks(drawn);
    let mut groups: Vec<(&[Drawn], Group)> = Vec::new();
    for (realization, experiments) in drawn {
        let repeated = groups
            .par_iter()
            .map(|(first, _)| repetition(*realization, experiments, first, &peaks, search))
            .enumerate()
            .find_map_first(|(number, repetition)| Some((number, repetition?)));
        match repeated {
            Some((number, repetition)) => groups[number].1.repetitions.push(repetition),
            None => groups.push((
                experiments,
                Group {
                    first: *realization,
                    repetitions: Vec::new(),
                },
            )),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

/// How the experiments of a realization repeat those of another, each another one, the one of the
/// same number tried first; `None` if one of them repeats none.
fn repetition(
    realization: usize,
    experiments: &[Drawn],
    others: &[Drawn],
    peaks: &[f64],
    search: &DelaySearch,
) -> Option<Repetition> {
    let mut free: Vec<usize> = (0..others.len()).collect();
    let mut found = Vec::new();
    for (own, experiment) in experiments.iter().enumerate() {
        free.sort_by_key(|&other| (other != own, other));
        let repeats = |&other: &usize| experiment.repeats(&others[other], peaks, search);
        let (place, repeat) =
            (0..free.len()).find_map(|place| Some((place, repeats(&free[place])?)))?;
        found.push((free.remove(place), repeat));
    }
    Some(Repetition {
        realization,
        experiments: found,
    })
}

/// Largest amplitude of every channel over the campaign.
fn peaks(drawn: &[(usize, Vec<Drawn>)]) -> Vec<f64> {
    let all = drawn.iter().flat_map(|(_, experiments)| experiments);
    let largest = all.map(Drawn::peaks).reduce(|a, b| {
        let pairs = a.into_iter().zip(b);
        pairs.map(|(a, b)| a.max(b)).collect()
    });
    largest.unwrap_or_default()
}
