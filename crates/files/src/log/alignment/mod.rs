//! Alignment of the topics of a recording on one grid of samples, by their stamps.

pub(crate) mod pairing;

use ndarray::Array2;

use crate::log::ClockFit;
use crate::log::alignment::pairing::{Paced, cover, shift};
use crate::log::clock::line::Points;
use crate::log::clock::{Flaw, NOTABLE_JITTER, OUT_OF_SLOT, flaw};
use crate::log::map::Signal;
use crate::log::recording::TimedDamage;
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
        let (start, end) = cover(topics, &shifts, warnings)?;
        let step = lead.clock.sample_time_s;
        let lead_ns = (start as f64 * step * 1e9).round() as i64;
        let from_start = |shift: &i64| shift.saturating_sub(start);
        Ok(Self {
            sample_time_s: step,
            n_samples: end.saturating_sub(start) as usize,
            start_ns: lead.series.stamps_ns[0].saturating_add(lead_ns),
            shifts: shifts.iter().map(from_start).collect(),
        })
    }

    /// Puts every value in its place; what is missing, contested or no number is told.
    pub(crate) fn fill(
        &self,
        topics: &[Paced],
        signals: &[&Signal],
        values: &mut Array2<f64>,
    ) -> Vec<Loss> {
        let mut losses = Vec::new();
        for (topic, shift) in topics.iter().zip(&self.shifts) {
            let series = topic.series;
            let came = self.place(topic, *shift, values);
            let mut contested = vec![false; self.n_samples];
            let slots = topic.clock.contested.iter();
            for sample in slots.filter_map(|slot| self.sample_of(*slot, *shift)) {
                contested[sample] = !came[sample];
            }
            let is_missing = |sample: usize| !came[sample] && !contested[sample];
            losses.extend(self.gaps(&series.topic, "are missing", is_missing));
            let reason = "have two messages of one stamp and different values";
            losses.extend(self.gaps(&series.topic, reason, |sample| contested[sample]));
            for &signal in &series.signals {
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
            let Some(sample) = self.sample_of(*slot, shift) else {
                continue;
            };
            came[sample] = true;
            for (&signal, column) in topic.series.signals.iter().zip(&topic.series.columns) {
                values[[signal, sample]] = column[row];
            }
        }
        came
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
        let mut places: Vec<f64> = (0..self.n_samples).map(|sample| sample as f64).collect();
        let shift = self.shifts.first().copied().unwrap_or(0);
        let points = Points {
            stamps_ns: &topic.series.stamps_ns,
            slots: &clock.slots,
        };
        for (row, slot) in clock.slots.iter().enumerate() {
            let deviation = clock.line.deviation(points, row);
            match self.sample_of(*slot, shift) {
                Some(sample) if deviation.abs() <= OUT_OF_SLOT => places[sample] += deviation,
                _ => {}
            }
        }
        let first = places.first().copied().unwrap_or(0.0);
        let time_s = |place: f64| (place - first) * self.sample_time_s;
        Some(places.into_iter().map(time_s).collect())
    }

    /// The clock of the first topic over the grid.
    pub(crate) fn clock_fit(&self, topic: &Paced) -> ClockFit {
        let shift = self.shifts.first().copied().unwrap_or(0);
        let on_grid = |slot: &&u32| self.sample_of(**slot, shift).is_some();
        let n_rows = topic.clock.slots.iter().filter(on_grid).count();
        ClockFit {
            sample_time_s: self.sample_time_s,
            resolution_s: topic.clock.resolution_s,
            jitter: topic.clock.jitter,
            n_lost: self.n_samples - n_rows,
        }
    }

    /// Damages to the file, on the grid's time.
    pub(crate) fn of_file(&self, damages: &[TimedDamage]) -> Vec<Loss> {
        let since_start_s = |at_ns: i64| (at_ns as f64 - self.start_ns as f64) / 1e9;
        let loss = |(at_ns, reason): &TimedDamage| {
            loss::of_no_sample("file", at_ns.map_or(0.0, since_start_s), reason)
        };
        damages.iter().map(loss).collect()
    }
}
