//! Occurrences of references in a recording: where each was played, told from the others.

use std::ops::Range;

use crate::alignment::bins::{bin_s, binned};
use crate::alignment::fit::{Alignment, fit};
use crate::alignment::match_peaks::{MatchPeak, match_peaks};
use crate::alignment::{Logged, Template, about_mean, power_about_mean};

/// Two places are one where they share this part of a reference.
const SAME: f64 = 0.5;
/// A run may begin in the last part of the one before it, ramps included.
const SHARED: f64 = 0.1;
/// Likeness that leaves no doubt that the whole was played.
const SURE: f64 = 0.9;
/// Candidates at a place that are looked at closely.
const CLOSE: usize = 6;
/// Part of the reference in s over which a stop is looked for.
const CHUNK_S: f64 = 0.25;
/// Power of a rest against what was to be played.
const REST: f64 = 0.05;
/// Shortest part in s by which an aborted run is recognised.
const SHORTEST_S: f64 = 1.0;

/// A reference that was played.
#[derive(Debug, Clone, PartialEq)]
pub struct Occurrence {
    /// Which of the references.
    pub template: usize,
    /// Where, and by which clock.
    pub alignment: Alignment,
    /// Correlation coefficient between what was logged and what was to be played, mean of the channels.
    pub likeness: f64,
    /// The same of the reference that comes next at this place; 0 where there is none.
    pub rival: f64,
    /// Plan time in s from which the machine rests where it should move.
    pub stopped_s: Option<f64>,
}

/// A place where a reference may have been played.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    template: usize,
    begin_s: f64,
    likeness: f64,
}

/// Where the references were played, by time: at each place the most likely, outside what is `taken`, in s of
/// the recorder. The clock's ratio is fitted, or one that is known.
#[must_use]
pub fn find_occurrences(
    logged: &Logged,
    templates: &[Template],
    taken: &[Range<f64>],
    known_ratio: Option<f64>,
) -> Vec<Occurrence> {
    let mut open = candidates(logged, templates);
    open.retain(|candidate| is_free(candidate, templates, taken));
    open.sort_by(|a, b| b.likeness.total_cmp(&a.likeness));
    let mut found: Vec<Occurrence> = Vec::new();
    while let Some(first) = open.first().copied() {
        let (here, elsewhere): (Vec<_>, Vec<_>) = open
            .into_iter()
            .partition(|other| shared(&first, other, templates) > SAME);
        open = elsewhere;
        let Some(best) = best_of(&here, logged, templates, known_ratio) else {
            continue;
        };
        let length_s = best
            .stopped_s
            .unwrap_or(templates[best.template].length_s());
        let span = best.alignment.start_s..best.alignment.start_s + length_s;
        open.retain(|other| is_free(other, templates, std::slice::from_ref(&span)));
        found.push(best);
    }
    found.sort_by(|a, b| a.alignment.start_s.total_cmp(&b.alignment.start_s));
    found
}

/// Every place of every reference.
fn candidates(logged: &Logged, templates: &[Template]) -> Vec<Candidate> {
    let Some((&first_s, &last_s)) = logged.times_s.first().zip(logged.times_s.last()) else {
        return Vec::new();
    };
    let high_hz = templates
        .iter()
        .map(|template| template.high_hz)
        .fold(0.0, f64::max);
    let longest_s = templates.iter().map(Template::length_s).fold(0.0, f64::max);
    let step_s = bin_s(high_hz);
    let begin_s = first_s - longest_s; // a run may have begun before the recording, or end after it
    let n_bins = ((last_s - first_s + 2.0 * longest_s) / step_s) as usize + 1;
    let recording = binned(logged.times_s, logged.values, begin_s, step_s, n_bins);
    let of_template = |(place, template): (usize, &Template)| {
        let reference = coarse(template, step_s);
        let candidate = move |MatchPeak { bin, likeness }| Candidate {
            template: place,
            begin_s: begin_s + bin as f64 * step_s,
            likeness,
        };
        match_peaks(&recording, &reference)
            .into_iter()
            .map(candidate)
    };
    templates.iter().enumerate().flat_map(of_template).collect()
}

/// A reference without its mean in bins.
fn coarse(template: &Template, step_s: f64) -> ndarray::Array2<f64> {
    let n_bins = (template.length_s() / step_s) as usize;
    let (times_s, reference) = (template.times_s(), template.reference);
    about_mean(binned(&times_s, reference, 0.0, step_s, n_bins).view())
}

/// Whether a place is outside of all that is taken.
fn is_free(candidate: &Candidate, templates: &[Template], taken: &[Range<f64>]) -> bool {
    let length_s = templates[candidate.template].length_s();
    let end_s = candidate.begin_s + length_s;
    taken.iter().all(|taken| {
        let shared_s = taken.end.min(end_s) - taken.start.max(candidate.begin_s);
        shared_s < SHARED * length_s.min(taken.end - taken.start)
    })
}

/// Share of the shorter of two references that both places have.
fn shared(a: &Candidate, b: &Candidate, templates: &[Template]) -> f64 {
    let [a_s, b_s] = [a, b].map(|one| templates[one.template].length_s());
    let common_s = (a.begin_s + a_s).min(b.begin_s + b_s) - a.begin_s.max(b.begin_s);
    common_s / a_s.min(b_s)
}

/// The most likely of the candidates at one place, best first.
fn best_of(
    here: &[Candidate],
    logged: &Logged,
    templates: &[Template],
    known_ratio: Option<f64>,
) -> Option<Occurrence> {
    let n_close = if here[0].likeness > SURE { 1 } else { CLOSE };
    let close = here.iter().take(n_close);
    let close = close.filter_map(|candidate| examined(candidate, logged, templates, known_ratio));
    let mut close: Vec<Occurrence> = close.collect();
    close.sort_by(|a, b| b.likeness.total_cmp(&a.likeness));
    let mut best = close.first()?.clone();
    let others = here.iter().filter(|other| other.template != best.template);
    let rivals = others.map(|other| {
        let examined = close.iter().find(|one| one.template == other.template);
        examined.map_or(other.likeness, |one| one.likeness)
    });
    best.rival = rivals.fold(0.0, f64::max);
    Some(best)
}

/// A candidate fitted to the samples, up to where it stops.
fn examined(
    candidate: &Candidate,
    logged: &Logged,
    templates: &[Template],
    known_ratio: Option<f64>,
) -> Option<Occurrence> {
    let template = &templates[candidate.template];
    let fitted =
        |start_s: f64, length_s: f64| fit(logged, template, start_s, length_s, known_ratio);
    let stopped_s = first_rest(logged, template, candidate.begin_s);
    if stopped_s.is_some_and(|stopped_s| stopped_s < SHORTEST_S) {
        return None;
    }
    let length_s = stopped_s.unwrap_or(template.length_s());
    let alignment = fitted(candidate.begin_s, length_s)?;
    let alignment = fitted(alignment.start_s, length_s)?; // with the samples that belong to it
    let likeness = (1.0 - alignment.residual).max(0.0).sqrt();
    let is_upright = alignment.gains.iter().flatten().any(|gain| *gain > 0.0);
    is_upright.then_some(Occurrence {
        template: candidate.template,
        alignment,
        likeness,
        rival: 0.0,
        stopped_s,
    })
}

/// Plan time in s of the chunk before the first that rests where the reference moves.
fn first_rest(logged: &Logged, template: &Template, begin_s: f64) -> Option<f64> {
    let length_s = template.length_s();
    let n_chunks = (length_s / CHUNK_S) as usize;
    let wanted: Vec<f64> = (0..n_chunks)
        .map(|chunk| template_power(template, chunk))
        .collect();
    let found: Vec<Option<f64>> = (0..n_chunks)
        .map(|chunk| logged_power(logged, begin_s + chunk as f64 * CHUNK_S))
        .collect();
    let total = |powers: &[f64]| powers.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let typical = total(&wanted) / n_chunks.max(1) as f64;
    let known: Vec<f64> = found.iter().flatten().copied().collect();
    let strongest = known.iter().copied().fold(0.0, f64::max);
    let rests = |chunk: &usize| {
        let moves = wanted[*chunk] > 0.2 * typical;
        moves && found[*chunk].is_none_or(|power| power < REST * REST * strongest)
    };
    let first = (0..n_chunks).find(rests)?;
    Some(first.saturating_sub(1) as f64 * CHUNK_S)
}

/// Power of a reference about its mean in one chunk, all channels alike.
fn template_power(template: &Template, chunk: usize) -> f64 {
    let samples = |chunk: usize| (chunk as f64 * CHUNK_S / template.sample_time_s) as usize;
    let range = samples(chunk)..samples(chunk + 1).min(template.n_samples());
    let rows = template.reference.rows();
    let powers = rows
        .into_iter()
        .map(|row| power_about_mean(row.iter().skip(range.start).take(range.len())));
    powers.sum()
}

/// The same of a recording; `None` without samples.
fn logged_power(logged: &Logged, begin_s: f64) -> Option<f64> {
    let from = logged.times_s.partition_point(|time| *time < begin_s);
    let to = logged
        .times_s
        .partition_point(|time| *time < begin_s + CHUNK_S);
    let rows = logged.values.rows();
    let power = |row: ndarray::ArrayView1<f64>| {
        let present = row
            .iter()
            .skip(from)
            .take(to - from)
            .filter(|value| value.is_finite());
        power_about_mean(present.collect::<Vec<_>>().into_iter())
    };
    (to > from + 2).then(|| rows.into_iter().map(power).sum())
}
