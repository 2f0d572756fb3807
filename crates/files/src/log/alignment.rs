//! Alignment of the topics of a recording on one grid of samples, by their stamps.

use ndarray::Array2;

use crate::log::clock::{Clock, NOTABLE_JITTER};
use crate::log::map::Signal;
use crate::log::recording::Series;
use crate::loss::{self, Loss};

/// What is wrong with the stamps: found, needed.
type Flaw = (String, String);

/// Refuses stamps that run backwards; drops messages that were recorded twice.
pub(crate) fn drop_duplicates(series: &mut Series, warnings: &mut Vec<String>) -> Result<(), Flaw> {
    let backwards = series
        .stamps_ns
        .windows(2)
        .filter(|pair| pair[1] < pair[0])
        .count();
    let twice = |k: usize| k > 0 && series.stamps_ns[k] == series.stamps_ns[k - 1];
    let bits = |k: usize| series.rows[k].iter().map(|value| value.to_bits());
    let twins = (0..series.rows.len()).filter(|&k| twice(k)).count();
    let different = (0..series.rows.len())
        .filter(|&k| twice(k) && !bits(k).eq(bits(k - 1)))
        .count();
    if backwards + different > 0 {
        let found = format!(
            "{backwards} stamps before their predecessor, {different} equal ones with different values"
        );
        return Err((
            found,
            "rising stamps: several recordings or clocks are mixed".into(),
        ));
    }
    if twins > 0 {
        warnings.push(format!(
            "{}: {twins} messages are there twice; one of each was dropped",
            series.topic
        ));
        let keep: Vec<bool> = (0..series.rows.len()).map(|k| !twice(k)).collect();
        let mut kept = keep.iter();
        series.stamps_ns.retain(|_| *kept.next().unwrap_or(&true));
        let mut kept = keep.iter();
        series.rows.retain(|_| *kept.next().unwrap_or(&true));
    }
    Ok(())
}

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
            return Err(("none".into(), "at least one".into()));
        };
        let step = lead.sample_time_s;
        let pairs = || series.iter().zip(clocks);
        let shifts = pairs().map(|(series, clock)| shift((first, lead), (series, clock), warnings));
        let shifts = shifts.collect::<Result<Vec<_>, _>>()?;
        let start = shifts.iter().copied().max().unwrap_or(0);
        let ends = shifts
            .iter()
            .zip(clocks)
            .map(|(shift, clock)| shift.saturating_add(clock.n_slots() as i64));
        let end = ends.min().unwrap_or(0);
        if end <= start {
            return Err((
                "no time that all topics cover".into(),
                "recordings of the same run".into(),
            ));
        }
        let start_ns =
            first.stamps_ns[0].saturating_add((start as f64 * step * 1e9).round() as i64);
        let shifts = shifts
            .into_iter()
            .map(|shift| shift.saturating_sub(start))
            .collect();
        Ok(Self {
            sample_time_s: step,
            n_samples: end.saturating_sub(start) as usize,
            start_ns,
            shifts,
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
            let mut came = vec![false; self.n_samples];
            for (slot, row) in clock.slots.iter().zip(&series.rows) {
                let sample = usize::try_from((*slot as i64).saturating_add(*shift))
                    .ok()
                    .filter(|&sample| sample < self.n_samples);
                let Some(sample) = sample else { continue };
                came[sample] = true;
                for (&signal, &value) in series.signals.iter().zip(row) {
                    values[[signal, sample]] = value;
                }
            }
            let gaps = |name: &str, reason, is_lost: &dyn Fn(usize) -> bool| {
                loss::gaps(name, self.n_samples, self.sample_time_s, reason, is_lost)
            };
            losses.extend(gaps(&series.topic, "are missing", &|sample| !came[sample]));
            for &signal in &series.signals {
                let is_lost = |sample: usize| came[sample] && !values[[signal, sample]].is_finite();
                losses.extend(gaps(&signals[signal].source, "are not numbers", &is_lost));
            }
        }
        losses
    }

    /// Damage to the file, on the grid's time.
    pub(crate) fn of_file(&self, at_ns: Option<i64>, reason: String) -> Loss {
        let at_s = at_ns.map_or(0.0, |at| (at as f64 - self.start_ns as f64) / 1e9);
        Loss {
            topic: "file".into(),
            from_s: at_s,
            to_s: at_s,
            reason,
        }
    }
}

/// Which sample of the first topic the first one of this topic goes with. Their rates must agree;
/// jitter and delay are told.
fn shift(
    (first, lead): (&Series, &Clock),
    (series, clock): (&Series, &Clock),
    warnings: &mut Vec<String>,
) -> Result<i64, Flaw> {
    let (name, step) = (&series.topic, lead.sample_time_s);
    let slip = (clock.sample_time_s / step - 1.0) * clock.n_slots() as f64;
    if slip.abs() > 0.25 {
        let found = format!(
            "{} every {step} s, {name} every {} s",
            first.topic, clock.sample_time_s
        );
        return Err((
            found,
            "one rate for all signals; frfid does not resample".into(),
        ));
    }
    if clock.jitter > NOTABLE_JITTER {
        warnings.push(format!(
            "{name}: stamps jitter by {:.2} % of the sample time (largest {:.1} %): {:.3} deg of phase error at 10 Hz",
            100.0 * clock.jitter,
            100.0 * clock.largest_jitter,
            3600.0 * clock.jitter * step
        ));
    }
    let offset_ns = series.stamps_ns[0].saturating_sub(first.stamps_ns[0]) as f64 + clock.origin_ns
        - lead.origin_ns;
    let offset = offset_ns / 1e9 / step;
    let delay = offset - offset.round();
    if delay.abs() > NOTABLE_JITTER {
        let delay_ms = 1e3 * delay * step;
        warnings.push(format!(
            "{name} is stamped {delay_ms:.4} ms after {} (a constant delay; not corrected)",
            first.topic
        ));
    }
    Ok(offset.round() as i64)
}
