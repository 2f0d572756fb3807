//! Draws of random phases: realizations that repeat one are found by measurement and counted as
//! repetitions, since they know the noise but not the nonlinear distortion.

use std::collections::hash_map::DefaultHasher;
use std::collections::{BTreeMap, HashSet};
use std::hash::{Hash, Hasher};

use ndarray::Array1;
use num_complex::Complex64;
use rayon::prelude::*;

use crate::period_index::PeriodIndex;
use crate::spectra::campaign::Campaign;
use crate::spectra::delay::{DelaySearch, Shift};
use crate::spectra::draw_match::{Drawn, Repeat};
use crate::spectra::equal_draws::EqualDraws;
use crate::spectra::run_spectra::RunSpectra;

/// What the experiments of a realization excite.
struct Realization {
    number: usize,
    experiments: Vec<Drawn>,
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
        let groups = Matcher::of(&drawn, &self.frequency_hz).groups(&drawn);
        let equal = groups.iter().filter(|group| !group.repetitions.is_empty());
        equal.map(|group| self.pool(group)).collect()
    }

    /// What the experiments of every realization excite; realizations that lack one are left out.
    fn drawn(&self) -> Vec<Realization> {
        let all = self.periods_of_experiments().into_iter();
        let complete = all.filter(|(_, experiments)| !experiments.iter().any(Vec::is_empty));
        let drawn = complete.map(|(number, experiments)| Realization {
            number,
            experiments: experiments.iter().map(|runs| Drawn::of(runs)).collect(),
        });
        drawn.collect()
    }

    /// The periods of every experiment, by realization.
    fn periods_of_experiments(&self) -> BTreeMap<usize, Vec<Vec<&RunSpectra>>> {
        let none = vec![Vec::new(); self.n_experiments()];
        let mut periods = BTreeMap::new();
        for (place, run) in &self.runs {
            let experiments = periods.entry(place.realization);
            experiments.or_insert_with(|| none.clone())[place.experiment].push(run);
        }
        periods
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
        for (place, run) in self.of_realization(realization) {
            run.hash_bits(hashers.entry(place.period).or_default());
        }
        let hashers = hashers.into_iter();
        hashers
            .map(|(period, hasher)| (period, hasher.finish()))
            .collect()
    }

    /// Takes the runs of a period out.
    fn take(&mut self, realization: usize, period: usize) -> Vec<(usize, RunSpectra)> {
        let of_period = self.of_realization(realization);
        let places = of_period.map(|(place, _)| *place);
        let places: Vec<PeriodIndex> = places.filter(|place| place.period == period).collect();
        let runs = places.into_iter();
        let runs = runs.filter_map(|place| Some((place.experiment, self.runs.remove(&place)?)));
        runs.collect()
    }

    /// The first period that a realization does not have yet.
    fn next_period(&self, realization: usize) -> usize {
        let last = self.of_realization(realization).next_back();
        last.map_or(0, |(place, _)| place.period + 1)
    }

    /// Adds the runs of a repetition as the last period of a realization.
    fn append(
        &mut self,
        realization: usize,
        repetition: &Repetition,
        runs: Vec<(usize, RunSpectra)>,
    ) {
        let period = self.next_period(realization);
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

impl Repetition {
    /// The largest of its experiments: where they are orthogonal, one says no more than another.
    fn chance(&self) -> f64 {
        let chances = self.experiments.iter().map(|(_, repeat)| repeat.chance);
        chances.fold(0.0, f64::max)
    }
}

impl Group {
    /// One without repetitions yet.
    fn of(first: usize) -> Self {
        Self {
            first,
            repetitions: Vec::new(),
        }
    }
    /// How their experiments repeat those of the first.
    fn repeats(&self) -> impl Iterator<Item = Repeat> {
        let all = self.repetitions.iter().flat_map(|own| &own.experiments);
        all.map(|(_, repeat)| *repeat)
    }

    /// The numbers of the realizations.
    fn realizations(&self) -> Vec<usize> {
        let others = self.repetitions.iter().map(|other| other.realization);
        std::iter::once(self.first).chain(others).collect()
    }

    /// What there is to say of it.
    fn told(&self, n_copies: usize) -> EqualDraws {
        let residuals = self.repeats().map(|repeat| repeat.residual_rad);
        let n_lines = self.repeats().map(|repeat| repeat.n_lines).min();
        EqualDraws {
            realizations: self.realizations(),
            residual_rad: residuals.fold(0.0, f64::max),
            n_lines: n_lines.unwrap_or(0),
            n_copies,
        }
    }
}

impl RunSpectra {
    /// Undoes a shift in time.
    fn turn_back(&mut self, shift: Shift, frequency_hz: &[f64]) {
        let factors: Array1<Complex64> = frequency_hz.iter().map(|&hz| shift.undone(hz)).collect();
        let signals = [Some(&mut self.u), Some(&mut self.y), self.r.as_mut()];
        for signal in signals.into_iter().flatten() {
            *signal *= &factors;
        }
    }

    /// Adds the bits of u and y to a number that tells them from others.
    fn hash_bits(&self, hasher: &mut DefaultHasher) {
        for value in self.u.iter().chain(&self.y) {
            (value.re.to_bits(), value.im.to_bits()).hash(hasher);
        }
    }
}

/// The search for realizations that repeat others.
struct Matcher<'a> {
    delays: DelaySearch<'a>,
    /// Largest amplitude of every channel over the campaign.
    peaks: Vec<f64>,
}

impl<'a> Matcher<'a> {
    fn of(drawn: &[Realization], frequency_hz: &'a [f64]) -> Self {
        let all = drawn.iter().flat_map(|own| &own.experiments);
        let peaks = all.map(Drawn::peaks).reduce(larger);
        Self {
            delays: DelaySearch::new(frequency_hz),
            peaks: peaks.unwrap_or_default(),
        }
    }

    /// Groups of realizations of one draw, each by its first. Of so many comparisons some agree by chance:
    /// a chance counts times the comparisons for each repetition that is found (Y. Benjamini, Y. Hochberg, J.
    /// Royal Statistical Society B 57 (1995) 289), stricter until all that are left pass.
    fn groups(&self, drawn: &[Realization]) -> Vec<Group> {
        let mut granted = 1.0;
        loop {
            let (groups, n_compared) = self.groups_within(drawn, granted);
            let chances = groups.iter().flat_map(|group| &group.repetitions);
            let chances: Vec<f64> = chances.map(Repetition::chance).collect();
            granted = chances.len() as f64 / n_compared as f64;
            if chances.iter().all(|&chance| chance <= granted) {
                return groups;
            }
        }
    }

    /// The same with so much of the chance for each comparison, and how many there were.
    fn groups_within(&self, drawn: &[Realization], granted: f64) -> (Vec<Group>, usize) {
        let (mut groups, mut n_compared): (Vec<(&Realization, Group)>, usize) = (Vec::new(), 0);
        for own in drawn {
            let repeated = groups.par_iter().enumerate();
            let repeated = repeated.find_map_first(|(place, (first, _))| {
                let repetition = self.repetition(own, first)?;
                (repetition.chance() <= granted).then_some((place, repetition))
            });
            n_compared += repeated
                .as_ref()
                .map_or(groups.len(), |(place, _)| place + 1);
            match repeated {
                Some((place, repetition)) => groups[place].1.repetitions.push(repetition),
                None => groups.push((own, Group::of(own.number))),
            }
        }
        let groups = groups.into_iter().map(|(_, group)| group).collect();
        (groups, n_compared)
    }

    /// How the experiments of a realization repeat those of another, each another one, the one of the
    /// same number tried first; `None` if one of them repeats none.
    fn repetition(&self, own: &Realization, other: &Realization) -> Option<Repetition> {
        let mut free: Vec<usize> = (0..other.experiments.len()).collect();
        let mut experiments = Vec::new();
        for (number, experiment) in own.experiments.iter().enumerate() {
            free.sort_by_key(|&other| (other != number, other));
            let (place, repeat) = self.first_repeated(experiment, other, &free)?;
            experiments.push((free.remove(place), repeat));
        }
        Some(Repetition {
            realization: own.number,
            experiments,
        })
    }

    /// Which of the experiments that are free is the first that is repeated, and how.
    fn first_repeated(
        &self,
        experiment: &Drawn,
        other: &Realization,
        free: &[usize],
    ) -> Option<(usize, Repeat)> {
        let mut free = free.iter().enumerate();
        free.find_map(|(place, &number)| {
            let other = &other.experiments[number];
            Some((place, experiment.repeats(other, &self.peaks, &self.delays)?))
        })
    }
}

/// The larger ones of two lists.
fn larger(a: Vec<f64>, b: Vec<f64>) -> Vec<f64> {
    let pairs = a.into_iter().zip(b);
    pairs.map(|(a, b)| a.max(b)).collect()
}
