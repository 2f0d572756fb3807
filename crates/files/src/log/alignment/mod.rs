//! Alignment of the topics of a recording on one grid of samples, by their stamps.

pub(crate) mod pairing;

use std::ops::Range;

use ndarray::{Array2, ArrayViewMut1};

use crate::log::ClockFit;
use crate::log::alignment::pairing::{Paced, cover, shift};
use crate::log::clock::{Clock, Flaw, NOTABLE_JITTER, OUT_OF_SLOT, flaw};
use crate::log::map::Signals;
use crate::log::recording::{Series, TimedDamage};
use crate::loss::{self, Loss};

/// The common clock: sample times of the first topic, over the time that all topics cover.
pub(crate) struct Grid {
    pub(crate) sample_time_s: f64,
    pub(crate) n_samples: usize,
    start_ns: i64,
    /// Grid sample of each topic's own sample 0; negative if it starts before the grid.
    shifts: Vec<i64>,
}

impl Grid {
    /// Pairs the topics by their nearest samples.
    pub(crate) fn of(topics: &[Paced], warnings: &mut Vec<String>) -> Result<Self, Flaw> {
        let Some(lead) = topics.first() else {
            return flaw("none", "at least one");
        };
        let shifts = topics.iter().map(|topic| shift(lead, topic));
        let shifts = shifts.collect::<Result<Vec<_>, _>>()?;
        let covered = cover(topics, &shifts, warnings)?;
        Ok(Self::over(covered, lead, &shifts))
    }

    /// The grid over samples of the first topic.
    fn over(covered: Range<i64>, lead: &Paced, shifts: &[i64]) -> Self {
        let Range { start, end } = covered;
        let sample_time_s = lead.clock.sample_time_s;
        let lead_ns = (start as f64 * sample_time_s * 1e9).round() as i64;
        let from_start = |shift: &i64| shift.saturating_sub(start);
        Self {
            sample_time_s,
            n_samples: end.saturating_sub(start) as usize,
            start_ns: lead.series.stamps_ns[0].saturating_add(lead_ns),
            shifts: shifts.iter().map(from_start).collect(),
        }
    }

    /// Puts every value in its place; what is missing, contested or no number is told.
    pub(crate) fn fill(
        &self,
        topics: &[Paced],
        signals: &Signals,
        values: &mut Array2<f64>,
    ) -> Vec<Loss> {
        let mut losses = Vec::new();
        for (topic, shift) in topics.iter().zip(&self.shifts) {
            let came = self.place(topic, *shift, values);
            let contested = self.contested(topic, *shift, &came);
            let is_missing = |sample: usize| !came[sample] && !contested[sample];
            losses.extend(self.gaps(&topic.series.topic, "are missing", is_missing));
            let reason = "have two messages of one stamp and different values";
            losses.extend(self.gaps(&topic.series.topic, reason, |sample| contested[sample]));
            for &signal in &topic.series.signals {
                let is_lost = |sample: usize| came[sample] && !values[[signal, sample]].is_finite();
                losses.extend(self.gaps(&signals[signal].source, "are not numbers", is_lost));
            }
        }
        losses
    }

    /// Puts the values of a topic in their places; returns which samples came.
    fn place(&self, topic: &Paced, shift: i64, values: &mut Array2<f64>) -> Vec<bool> {
        let mut came = vec![false; self.n_samples];
        for (row, slot) in topic.clock.slots.iter().enumerate() {
            if let Some(sample) = self.sample_of(*slot, shift) {
                came[sample] = true;
                put(topic.series, row, values.column_mut(sample));
            }
        }
        came
    }

    /// Which samples are contested, and did not come either.
    fn contested(&self, topic: &Paced, shift: i64, came: &[bool]) -> Vec<bool> {
        let mut contested = vec![false; self.n_samples];
        let slots = topic.clock.contested.iter();
        for sample in slots.filter_map(|slot| self.sample_of(*slot, shift)) {
            contested[sample] = !came[sample];
        }
        contested
    }

    /// The grid's sample of a topic's own, if it is on the grid.
    fn sample_of(&self, slot: u32, shift: i64) -> Option<usize> {
        let sample = usize::try_from(i64::from(slot).saturating_add(shift)).ok()?;
        (sample < self.n_samples).then_some(sample)
    }

    fn gaps(&self, name: &str, reason: &str, is_lost: impl Fn(usize) -> bool) -> Vec<Loss> {
        loss::gaps(name, self.n_samples, self.sample_time_s, reason, is_lost)
    }

    /// Times of the samples in s after the first by the stamps of a topic, the first one of the grid;
    /// on the even grid where a sample is lost or its stamp is out of its slot. `None` where the
    /// stamps are even, or only rounding makes them uneven.
    pub(crate) fn times_s(&self, topic: &Paced) -> Option<Vec<f64>> {
        let clock = topic.clock;
        if clock.jitter <= NOTABLE_JITTER || clock.resolution_s.is_some() {
            return None;
        }
        let places = self.stamped_places(topic);
        let first = places.first().copied().unwrap_or(0.0);
        let time_s = |place: f64| (place - first) * self.sample_time_s;
        Some(places.into_iter().map(time_s).collect())
    }

    /// Place of every sample in samples, as the first topic is stamped.
    fn stamped_places(&self, topic: &Paced) -> Vec<f64> {
        let Clock { line, slots, .. } = topic.clock;
        let points = topic.clock.points(&topic.series.stamps_ns);
        let mut places: Vec<f64> = (0..self.n_samples).map(|sample| sample as f64).collect();
        for (slot, deviation) in slots.iter().zip(line.deviations(points)) {
            match self.sample_of(*slot, self.first_shift()) {
                Some(sample) if deviation.abs() <= OUT_OF_SLOT => places[sample] += deviation,
                _ => {}
            }
        }
        places
    }

    fn first_shift(&self) -> i64 {
        self.shifts.first().copied().unwrap_or(0)
    }

    /// The clock of the first topic over the grid.
    pub(crate) fn clock_fit(&self, topic: &Paced) -> ClockFit {
        ClockFit {
            sample_time_s: self.sample_time_s,
            resolution_s: topic.clock.resolution_s,
            jitter: topic.clock.jitter,
            n_lost: self.n_samples - self.n_rows(&topic.clock.slots),
        }
    }

    /// How many rows of the first topic are on the grid.
    fn n_rows(&self, slots: &[u32]) -> usize {
        let shift = self.first_shift();
        let samples = slots.iter().map(|slot| self.sample_of(*slot, shift));
        samples.flatten().count()
    }

    /// Damages to the file, on the grid's time.
    pub(crate) fn of_file(&self, damages: &[TimedDamage]) -> Vec<Loss> {
        let loss = |(at_ns, reason): &TimedDamage| {
            loss::of_no_sample("file", self.since_start_s(*at_ns), reason)
        };
        damages.iter().map(loss).collect()
    }

    /// A time of the file; the start where that is not known.
    fn since_start_s(&self, at_ns: Option<i64>) -> f64 {
        at_ns.map_or(0.0, |at_ns| (at_ns as f64 - self.start_ns as f64) / 1e9)
    }
}

/// Puts a row of a topic into its sample of all signals.
fn put(series: &Series, row: usize, mut sample: ArrayViewMut1<f64>) {
    for (signal, column) in series.signals.iter().zip(&series.columns) {
        sample[*signal] = column[row];
    }
}
