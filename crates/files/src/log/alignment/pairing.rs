//! Pairing of topics, cycle by cycle: rates, delays and clocks of the topics of one recording.

use std::ops::Range;

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

    /// For people: from when to when it is.
    fn span(&self) -> String {
        let stamps = &self.series.stamps_ns;
        let (first, last) = (seconds(stamps.first()), seconds(stamps.last()));
        format!("{} from {first:.3} s to {last:.3} s", self.name())
    }

    /// For people: how often it is.
    fn rate(&self) -> String {
        let step = duration(self.clock.line.step_ns);
        format!("{} every {step}", self.name())
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

    /// The grid's sample behind its last one, if its first one is at `shift`.
    fn end(&self, shift: i64) -> i64 {
        shift.saturating_add(self.clock.n_slots() as i64)
    }

    /// How many samples it lies behind the cycle of another that it is paired with.
    fn delay(&self, other: &Self) -> f64 {
        let offset = self.behind_ns(other) / other.clock.line.step_ns;
        offset - offset.round()
    }
}

fn seconds(stamp: Option<&i64>) -> f64 {
    stamp.map_or(0.0, |stamp| *stamp as f64 / 1e9)
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
    let ratio = topic.clock.line.step_ns / lead.clock.line.step_ns - 1.0;
    let slip = ratio * topic.clock.n_slots() as f64;
    if slip.abs() <= MOST_SLIP {
        return Ok(());
    }
    if ratio.abs() < SAME_RATE {
        return two_quartzes(lead, topic, 1e6 * ratio.abs(), slip.abs());
    }
    two_rates(lead, topic)
}

fn two_quartzes(lead: &Paced, topic: &Paced, apart_ppm: f64, slip: f64) -> Result<(), Flaw> {
    let (first, name) = (lead.name(), topic.name());
    flaw(
        format!(
            "the clocks of {first} and {name} run apart by {apart_ppm:.0} ppm, {slip:.1} samples in the end"
        ),
        "stamps of one clock for all signals",
    )
}

fn two_rates(lead: &Paced, topic: &Paced) -> Result<(), Flaw> {
    flaw(
        format!("{}, {}", lead.rate(), topic.rate()),
        "one rate for all signals: frfid does not resample; record all of them at the rate of the fastest",
    )
}

/// The samples of the first topic that all topics cover.
pub(crate) fn cover(
    topics: &[Paced],
    shifts: &[i64],
    warnings: &mut Vec<String>,
) -> Result<Range<i64>, Flaw> {
    let start = shifts.iter().copied().max().unwrap_or(0);
    let end = first_end(topics, shifts);
    if end <= start {
        return flaw(nowhere(topics), "recordings of the same run, on one clock");
    }
    warnings.extend(cover_warning(topics, end.saturating_sub(start)));
    Ok(start..end)
}

/// The sample of the first topic before which the first of all topics ends.
fn first_end(topics: &[Paced], shifts: &[i64]) -> i64 {
    let pairs = shifts.iter().zip(topics);
    let ends = pairs.map(|(shift, topic)| topic.end(*shift));
    ends.min().unwrap_or(0)
}

fn cover_warning(topics: &[Paced], covered: i64) -> Option<String> {
    let lengths = topics.iter().map(|topic| topic.clock.n_slots());
    let longest = lengths.max()?;
    let is_short = (covered as f64) < MOST_COVERED * longest as f64;
    is_short
        .then(|| format!("only {covered} of {longest} samples are covered by all signals and used"))
}

/// What there is where topics have no time in common.
fn nowhere(topics: &[Paced]) -> String {
    let spans: Vec<_> = topics.iter().map(Paced::span).collect();
    format!("no time that all topics cover: {}", spans.join(", "))
}

/// That u and y are on two clocks, in a sentence: stamps of headers and of the recorder.
pub(crate) fn two_clocks(topics: &[Paced]) -> Option<String> {
    let headers = stamped_by(topics, false)?;
    let recorders = stamped_by(topics, true)?;
    Some(format!(
        "two clocks: {recorders} has no header stamps and is on the recorder's clock, {headers} on that of its header stamps; the delay between them is unknown, and the phase cannot be trusted ({:.1} deg at {TOLD_HZ} Hz for each ms)",
        degrees(1e-3)
    ))
}

/// The inputs and outputs that are stamped by the recorder, or by headers; none if there are none.
fn stamped_by(topics: &[Paced], is_recorders: bool) -> Option<String> {
    let is_so = |topic: &&Paced| topic.counts() && topic.series.is_recorders == is_recorders;
    let names: Vec<_> = topics.iter().filter(is_so).map(Paced::name).collect();
    (!names.is_empty()).then(|| names.join(" and "))
}

/// Delays between inputs and outputs that may be cycles.
pub(crate) fn delay_warnings(topics: &[Paced]) -> Vec<String> {
    let mut counting = topics.iter().filter(|topic| topic.counts());
    let first = counting.next();
    counting
        .filter_map(|topic| delay_warning(first?, topic))
        .collect()
}

fn delay_warning(first: &Paced, topic: &Paced) -> Option<String> {
    let delay = topic.delay(first);
    (delay.abs() >= NOTABLE_DELAY).then(|| delay_told(first, topic, delay))
}

fn delay_told(first: &Paced, topic: &Paced, delay: f64) -> String {
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
    let series = topic.series;
    let all = [
        recorder_warning(series),
        unevenness_warning(&series.topic, topic.clock),
        late_warning(&series.topic, topic.clock),
    ];
    all.into_iter().flatten().collect()
}

fn recorder_warning(series: &Series) -> Option<String> {
    let name = &series.topic;
    series.is_recorders.then(|| {
        format!("{name} has no header stamps: the time of recording was taken instead, which is late by a changing delay")
    })
}

fn unevenness_warning(name: &str, clock: &Clock) -> Option<String> {
    rounding_warning(name, clock).or_else(|| jitter_warning(name, clock))
}

fn rounding_warning(name: &str, clock: &Clock) -> Option<String> {
    let (unit, step) = (1e9 * clock.resolution_s?, clock.line.step_ns);
    Some(format!(
        "{name}: stamps are in whole {}, at {} for each sample: rounded; taken as even",
        duration(unit),
        duration(step)
    ))
}

fn jitter_warning(name: &str, clock: &Clock) -> Option<String> {
    let jitter = clock.jitter;
    (jitter > NOTABLE_JITTER).then(|| {
        format!(
            "{name}: stamps jitter by {:.2} % of the sample time (largest {:.1} %): {:.3} deg of phase error at {TOLD_HZ} Hz",
            100.0 * jitter,
            100.0 * clock.largest_jitter,
            degrees(jitter * clock.line.step_ns / 1e9)
        )
    })
}

fn late_warning(name: &str, clock: &Clock) -> Option<String> {
    let (count, largest) = (clock.n_out, clock.largest_jitter);
    (count > 0).then(|| {
        format!(
            "{name}: {count} stamps are off by more than half a sample, up to {largest:.1} samples, as of messages that came late: samples are taken in their order; next to lost ones they may be one off"
        )
    })
}
