//! Pairing of topics, cycle by cycle: rates, delays and clocks of the topics of one recording.

use crate::log::clock::{Clock, Flaw, NOTABLE_JITTER, flaw};
use crate::log::map::LogMap;
use crate::log::recording::Series;
use crate::log::text::duration;

/// A topic with its clock.
pub(crate) struct Paced<'t> {
    pub(crate) series: &'t Series,
    pub(crate) clock: &'t Clock,
    /// Which of the map's roles it plays, for people: `u` or `r, position`.
    pub(crate) roles: String,
}

impl<'t> Paced<'t> {
    pub(crate) fn of(map: &LogMap, series: &'t Series, clock: &'t Clock) -> Self {
        Self {
            series,
            clock,
            roles: map.roles_of(&series.signals),
        }
    }

    /// For people: `u (/commands)`.
    fn name(&self) -> String {
        format!("{} ({})", self.roles, self.series.topic)
    }

    /// Whether a delay of it turns the phase of the FRF: that of a reference cancels.
    fn counts(&self) -> bool {
        self.roles
            .split(", ")
            .any(|role| role == "u" || role == "y")
    }

    /// Time of its sample 0 in ns after that of another.
    fn behind_ns(&self, other: &Self) -> f64 {
        let apart = self.first_ns() - other.first_ns();
        apart as f64 + self.clock.line.origin_ns() - other.clock.line.origin_ns()
    }

    fn first_ns(&self) -> i128 {
        i128::from(self.series.stamps_ns[0])
    }

    /// How many samples it lies behind the cycle of another that it is paired with.
    fn delay(&self, other: &Self) -> f64 {
        let offset = self.behind_ns(other) / other.clock.line.step_ns;
        offset - offset.round()
    }
}

/// Topics of one cycle are stamped one after the other, some ten us apart: a delay below this share
/// of a sample is not worth a word.
const NOTABLE_DELAY: f64 = 0.1;
/// A topic may slip against the first one by this many samples over the recording.
const MOST_SLIP: f64 = 0.25;
/// Rates that differ by less are one rate on two clocks.
const SAME_RATE: f64 = 0.01;
/// Topics that cover less than this share of the longest are told.
const MOST_COVERED: f64 = 0.9;
/// Frequency at which a delay is told as a phase, in Hz.
const TOLD_HZ: f64 = 10.0;

/// Phase in deg at `TOLD_HZ` of a time.
fn degrees(time_s: f64) -> f64 {
    360.0 * TOLD_HZ * time_s
}

/// Which sample of the first topic the first one of this topic goes with: the nearest. Their rates
/// must agree.
pub(crate) fn shift(lead: &Paced, topic: &Paced) -> Result<i64, Flaw> {
    check_rate(lead, topic)?;
    let offset = topic.behind_ns(lead) / lead.clock.line.step_ns;
    Ok(offset.round() as i64)
}

/// Refuses a topic of another rate, and one that slips against the first.
fn check_rate(lead: &Paced, topic: &Paced) -> Result<(), Flaw> {
    let (step, own_step) = (lead.clock.line.step_ns, topic.clock.line.step_ns);
    let ratio = own_step / step - 1.0;
    let slip = ratio * topic.clock.n_slots() as f64;
    if slip.abs() <= MOST_SLIP {
        return Ok(());
    }
    let (first, name) = (lead.name(), topic.name());
    if ratio.abs() < SAME_RATE {
        return flaw(
            format!(
                "the clocks of {first} and {name} run apart by {:.0} ppm, {:.1} samples in the end",
                1e6 * ratio.abs(),
                slip.abs()
            ),
            "stamps of one clock for all signals",
        );
    }
    flaw(
        format!(
            "{first} every {}, {name} every {}",
            duration(step),
            duration(own_step)
        ),
        "one rate for all signals: frfid does not resample; record all of them at the rate of the fastest",
    )
}

/// The samples of the first topic that all topics cover, the last one not included.
pub(crate) fn cover(
    topics: &[Paced],
    shifts: &[i64],
    warnings: &mut Vec<String>,
) -> Result<(i64, i64), Flaw> {
    let start = shifts.iter().copied().max().unwrap_or(0);
    let lengths = topics.iter().map(|topic| topic.clock.n_slots() as i64);
    let ends = shifts.iter().zip(lengths.clone());
    let end = ends
        .map(|(shift, length)| shift.saturating_add(length))
        .min();
    let end = end.unwrap_or(0);
    if end <= start {
        return flaw(nowhere(topics), "recordings of the same run, on one clock");
    }
    let longest = lengths.max().unwrap_or(0);
    let covered = end.saturating_sub(start);
    if (covered as f64) < MOST_COVERED * longest as f64 {
        warnings.push(format!(
            "only {covered} of {longest} samples are covered by all signals and used"
        ));
    }
    Ok((start, end))
}

/// What there is where topics have no time in common.
fn nowhere(topics: &[Paced]) -> String {
    let span = |topic: &Paced| {
        let stamps = &topic.series.stamps_ns;
        let second = |stamp: Option<&i64>| stamp.map_or(0.0, |stamp| *stamp as f64 / 1e9);
        let (first, last) = (second(stamps.first()), second(stamps.last()));
        format!("{} from {first:.3} s to {last:.3} s", topic.name())
    };
    let spans: Vec<_> = topics.iter().map(span).collect();
    format!("no time that all topics cover: {}", spans.join(", "))
}

/// That u and y are on two clocks, in a sentence: stamps of headers and of the recorder.
pub(crate) fn two_clocks(topics: &[Paced]) -> Option<String> {
    let of = |is_recorders: bool| {
        let is_so = |topic: &&Paced| topic.counts() && topic.series.is_recorders == is_recorders;
        let names: Vec<_> = topics.iter().filter(is_so).map(Paced::name).collect();
        (!names.is_empty()).then(|| names.join(" and "))
    };
    let (headers, recorders) = (of(false)?, of(true)?);
    Some(format!(
        "two clocks: {recorders} has no header stamps and is on the recorder's clock, {headers} on that of its header stamps; the delay between them is unknown, and the phase cannot be trusted ({:.1} deg at {TOLD_HZ} Hz for each ms)",
        degrees(1e-3)
    ))
}

/// Delays between inputs and outputs that may be cycles.
pub(crate) fn delay_warnings(topics: &[Paced]) -> Vec<String> {
    let mut counting = topics.iter().filter(|topic| topic.counts());
    let Some(first) = counting.next() else {
        return Vec::new();
    };
    let told = |topic: &Paced| delay_warning(first, topic, topic.delay(first));
    let late = counting.filter(|topic| topic.delay(first).abs() >= NOTABLE_DELAY);
    late.map(told).collect()
}

fn delay_warning(first: &Paced, topic: &Paced, delay: f64) -> String {
    let delay_s = delay * first.clock.sample_time_s;
    format!(
        "{} is stamped {:.4} ms after {}, {:.0} % of a sample: they are paired by the nearest stamp and not corrected; if the delay is real the phase is off by {:.2} deg at {TOLD_HZ} Hz, and stamps cannot tell",
        topic.name(),
        1e3 * delay_s,
        first.name(),
        100.0 * delay,
        degrees(delay_s)
    )
}

/// What a careful reader should know of the stamps of a topic.
pub(crate) fn stamp_warnings(topic: &Paced) -> Vec<String> {
    let name = &topic.series.topic;
    let Clock { jitter, line, .. } = *topic.clock;
    let recorders = topic.series.is_recorders.then(|| {
        format!("{name} has no header stamps: the time of recording was taken instead, which is late by a changing delay")
    });
    let rounded = topic.clock.resolution_s.map(|resolution_s| {
        let (unit, step) = (duration(1e9 * resolution_s), duration(line.step_ns));
        format!(
            "{name}: stamps are in whole {unit}, at {step} for each sample: rounded; taken as even"
        )
    });
    let uneven = (jitter > NOTABLE_JITTER && rounded.is_none()).then(|| {
        format!(
            "{name}: stamps jitter by {:.2} % of the sample time (largest {:.1} %): {:.3} deg of phase error at {TOLD_HZ} Hz",
            100.0 * jitter,
            100.0 * topic.clock.largest_jitter,
            degrees(jitter * line.step_ns / 1e9)
        )
    });
    let out = (topic.clock.n_out > 0).then(|| {
        format!(
            "{name}: {} stamps are off by more than half a sample, up to {:.1} samples, as of messages that came late: samples are taken in their order; next to lost ones they may be one off",
            topic.clock.n_out, topic.clock.largest_jitter
        )
    });
    let all = [recorders, rounded, uneven, out];
    all.into_iter().flatten().collect()
}
