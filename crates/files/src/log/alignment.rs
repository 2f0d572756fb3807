//! Alignment of the topics of a recording on one grid of samples, by their stamps.

use ndarray::Array2;

use crate::log::clock::{Clock, Flaw, NOTABLE_JITTER, flaw};
use crate::log::map::Signal;
use crate::log::recording::Series;
use crate::loss::{self, Loss};

/// Refuses stamps that run backwards; drops messages that were recorded twice.
pub(crate) fn drop_duplicates(series: &mut Series, warnings: &mut Vec<String>) -> Result<(), Flaw> {
    check_order(series)?;
    let twice: Vec<bool> = (0..series.rows.len()).map(|k| series.is_twin(k)).collect();
    let twins = twice.iter().filter(|twice| **twice).count();
    if twins > 0 {
        warnings.push(format!(
            "{}: {twins} messages are there twice; one of each was dropped",
            series.topic
        ));
        drop_marked(&mut series.stamps_ns, &twice);
        drop_marked(&mut series.rows, &twice);
    }
    Ok(())
}

/// Refuses stamps that run backwards, and equal ones of different messages.
fn check_order(series: &Series) -> Result<(), Flaw> {
    let pairs = series.stamps_ns.windows(2);
    let backwards = pairs.filter(|pair| pair[1] < pair[0]).count();
    let bits = |k: usize| series.rows[k].iter().map(|value| value.to_bits());
    let is_other = |k: &usize| series.is_twin(*k) && !bits(*k).eq(bits(*k - 1));
    let different = (0..series.rows.len()).filter(is_other).count();
    if backwards + different == 0 {
        return Ok(());
    }
    flaw(
        format!(
            "{backwards} stamps before their predecessor, {different} equal ones with different values"
        ),
        "rising stamps: several recordings or clocks are mixed",
    )
}

fn drop_marked<T>(list: &mut Vec<T>, marks: &[bool]) {
    let mut marks = marks.iter();
    list.retain(|_| !*marks.next().unwrap_or(&false));
}

/// A topic and its clock.
type Paced<'t> = (&'t Series, &'t Clock);

/// The common clock: sample times of the first topic, over the time that all topics cover.
pub(crate) struct Grid {
    pub(crate) sample_time_s: f64,
    pub(crate) n_samples: usize,
    start_ns: i64,
    /// Grid sample of each topic's own sample 0; negative if it starts before the grid.
    shifts: Vec<i64>,
}

impl Grid {
    pub(crate) fn of(
        series: &[Series],
        clocks: &[Clock],
        warnings: &mut Vec<String>,
    ) -> Result<Self, Flaw> {
        let (Some(first), Some(lead)) = (series.first(), clocks.first()) else {
            return flaw("none", "at least one");
        };
        let lead = (first, lead);
        let shifts = series.iter().zip(clocks);
        let shifts = shifts.map(|(series, clock)| shift(lead, (series, clock), warnings));
        let shifts = shifts.collect::<Result<Vec<_>, _>>()?;
        Self::covered(lead, clocks, &shifts)
    }

    /// The time that all topics cover, each of them shifted against the first.
    fn covered((first, lead): Paced, clocks: &[Clock], shifts: &[i64]) -> Result<Self, Flaw> {
        let start = shifts.iter().copied().max().unwrap_or(0);
        let ends = shifts
            .iter()
            .zip(clocks)
            .map(|(shift, clock)| shift.saturating_add(clock.n_slots() as i64));
        let end = ends.min().unwrap_or(0);
        if end <= start {
            return flaw(
                "no time that all topics cover",
                "recordings of the same run",
            );
        }
        let step = lead.sample_time_s;
        let lead_ns = (start as f64 * step * 1e9).round() as i64;
        let from_start = |shift: &i64| shift.saturating_sub(start);
        Ok(Self {
            sample_time_s: step,
            n_samples: end.saturating_sub(start) as usize,
            start_ns: first.stamps_ns[0].saturating_add(lead_ns),
            shifts: shifts.iter().map(from_start).collect(),
        })
    }

    /// Puts every value in its place; what is missing or no number is told.
    pub(crate) fn fill(
        &self,
        series: &[Series],
        clocks: &[Clock],
        signals: &[&Signal],
        values: &mut Array2<f64>,
    ) -> Vec<Loss> {
        let mut losses = Vec::new();
        for ((series, clock), shift) in series.iter().zip(clocks).zip(&self.shifts) {
            let came = self.place((series, clock), *shift, values);
            losses.extend(self.gaps(&series.topic, "are missing", |sample| !came[sample]));
            for &signal in &series.signals {
                let is_lost = |sample: usize| came[sample] && !values[[signal, sample]].is_finite();
                losses.extend(self.gaps(&signals[signal].source, "are not numbers", is_lost));
            }
        }
        losses
    }

    /// Puts the values of a topic in their places; returns which samples came.
    fn place(&self, (series, clock): Paced, shift: i64, values: &mut Array2<f64>) -> Vec<bool> {
        let mut came = vec![false; self.n_samples];
        for (slot, row) in clock.slots.iter().zip(&series.rows) {
            let Some(sample) = self.sample_of(*slot, shift) else {
                continue;
            };
            came[sample] = true;
            for (&signal, &value) in series.signals.iter().zip(row) {
                values[[signal, sample]] = value;
            }
        }
        came
    }

    /// The grid's sample of a topic's own, if it is on the grid.
    fn sample_of(&self, slot: usize, shift: i64) -> Option<usize> {
        let sample = usize::try_from((slot as i64).saturating_add(shift)).ok()?;
        (sample < self.n_samples).then_some(sample)
    }

    fn gaps(&self, name: &str, reason: &str, is_lost: impl Fn(usize) -> bool) -> Vec<Loss> {
        loss::gaps(name, self.n_samples, self.sample_time_s, reason, is_lost)
    }

    /// Damage to the file, on the grid's time.
    pub(crate) fn of_file(&self, at_ns: Option<i64>, reason: String) -> Loss {
        let since_start_s = |at_ns: i64| (at_ns as f64 - self.start_ns as f64) / 1e9;
        loss::of_no_sample("file", at_ns.map_or(0.0, since_start_s), reason)
    }
}

/// Which sample of the first topic the first one of this topic goes with. Their rates must agree;
/// jitter and delay are told.
fn shift(lead: Paced, topic: Paced, warnings: &mut Vec<String>) -> Result<i64, Flaw> {
    check_rate(lead, topic)?;
    let ((first, lead), (series, clock)) = (lead, topic);
    let step = lead.sample_time_s;
    warnings.extend(jitter_warning(&series.topic, clock, step));
    let offset_ns = series.stamps_ns[0].saturating_sub(first.stamps_ns[0]) as f64 + clock.origin_ns
        - lead.origin_ns;
    let offset = offset_ns / 1e9 / step;
    let delay = offset - offset.round();
    if delay.abs() > NOTABLE_JITTER {
        let (name, delay_ms) = (&series.topic, 1e3 * delay * step);
        warnings.push(format!(
            "{name} is stamped {delay_ms:.4} ms after {} (a constant delay; not corrected)",
            first.topic
        ));
    }
    Ok(offset.round() as i64)
}

/// Refuses a topic that slips against the first one by a quarter of a sample or more.
fn check_rate((first, lead): Paced, (series, clock): Paced) -> Result<(), Flaw> {
    let (step, own_step) = (lead.sample_time_s, clock.sample_time_s);
    let slip = (own_step / step - 1.0) * clock.n_slots() as f64;
    if slip.abs() > 0.25 {
        let (first, name) = (&first.topic, &series.topic);
        return flaw(
            format!("{first} every {step} s, {name} every {own_step} s"),
            "one rate for all signals; frfid does not resample",
        );
    }
    Ok(())
}

fn jitter_warning(name: &str, clock: &Clock, step: f64) -> Option<String> {
    let told = || {
        format!(
            "{name}: stamps jitter by {:.2} % of the sample time (largest {:.1} %): {:.3} deg of phase error at 10 Hz",
            100.0 * clock.jitter,
            100.0 * clock.largest_jitter,
            3600.0 * clock.jitter * step
        )
    };
    (clock.jitter > NOTABLE_JITTER).then(told)
}
