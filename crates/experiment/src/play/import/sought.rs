//! Sought references: what may have been played of a plan, each reference once.

use frfid_estimate::{Logged, Occurrence, Template, find_occurrences};
use frfid_files::LogMap;
use frfid_signals::{Plan, Played, Player, Run, RunId, RunKind, median};
use ndarray::{Array2, s};
use std::ops::Range;

use crate::error::ExperimentError;
use crate::play::import::places::Places;
use crate::play::import::plays::Play;
use crate::run::planned_runs::{PlannedRuns, first_repetitions};

/// How much of a recording before and after a play is looked at, in s: a machine comes after its player.
const BESIDE_S: f64 = 0.2;

/// A reference of a plan.
pub(super) struct Sought {
    /// The first of its repetitions.
    pub(super) id: RunId,
    /// What moves, `(channel, sample)`: the run above the constant velocity, or a glide from rest to rest.
    reference: Array2<f64>,
    sample_time_s: f64,
    /// Where the run itself begins and ends in it, in s.
    run_s: Range<f64>,
    high_hz: f64,
}

/// A run that was found in a recording.
#[derive(Debug, Clone)]
pub(super) struct FoundRun {
    /// The first of the repetitions that it may be.
    pub(super) id: RunId,
    /// Where; the start is that of the run's own first sample.
    pub(super) occurrence: Occurrence,
    /// Length of the run in s of the plan.
    pub(super) length_s: f64,
    /// How long after its place by the clock of the player it begins, in s; `None` where that was not logged.
    pub(super) delay_s: Option<f64>,
}

impl FoundRun {
    /// Its place in s of the recorder.
    fn span_s(&self) -> Range<f64> {
        let alignment = &self.occurrence.alignment;
        let length_s = self.occurrence.stopped_s.unwrap_or(self.length_s);
        alignment.start_s..alignment.start_s + alignment.clock_ratio * length_s
    }
}

/// References of a plan by kind.
#[derive(Default)]
pub(super) struct SoughtRuns {
    excited: Vec<Sought>,
    glides: Vec<Sought>,
    /// Where they are by the player's clock, if recordings bring it back.
    pub(super) places: Option<Places>,
}

impl SoughtRuns {
    /// All references of a plan, as `player` plays them and a recording with this map has them.
    pub(super) fn of(
        planned: &PlannedRuns,
        player: &Player,
        map: &LogMap,
    ) -> Result<Self, ExperimentError> {
        let (mut all, plan) = (Self::default(), &planned.experiment.plan);
        if !map.plan_clock.is_empty() {
            all.places = Some(Places::of(planned, player)?);
        }
        for id in first_repetitions(plan) {
            all.add(plan, planned.run(id)?, player)?;
        }
        Ok(all)
    }

    /// The reference of one run.
    pub(super) fn of_run(
        plan: &Plan,
        run: &Run,
        player: &Player,
        map: &LogMap,
    ) -> Result<Self, ExperimentError> {
        let mut one = Self::default();
        if !map.plan_clock.is_empty() {
            one.places = Some(Places::of_run(plan, run, player)?);
        }
        one.add(plan, run.clone(), player)?;
        Ok(one)
    }

    fn add(&mut self, plan: &Plan, run: Run, player: &Player) -> Result<(), ExperimentError> {
        match run.id.kind {
            RunKind::Excitation => self.excited.push(excitation(plan, run)),
            RunKind::Glide => self.glides.push(glide(plan, &run, player)?),
        }
        Ok(())
    }

    /// The runs in each play of a recording, by the clock of its player.
    pub(super) fn find_in(
        &self,
        plays: &[Play],
        places: &Places,
        logged: &Logged,
    ) -> Vec<FoundRun> {
        let in_play = |play: &Play| {
            let mut runs = self.find(&played(play, logged), Some(play.ratio));
            for run in &mut runs {
                let begin_s = play.player_s(run.occurrence.alignment.start_s);
                run.delay_s = places.delay_s(run.id, begin_s);
            }
            runs
        };
        plays.iter().flat_map(in_play).collect()
    }

    /// The runs in a recording, excited ones first: a glide has no more than its ramps to be told by, and its clock
    /// is that of the others, or the one that is known.
    pub(super) fn find(&self, logged: &Logged, known_ratio: Option<f64>) -> Vec<FoundRun> {
        let excited = found(&self.excited, logged, &[], None);
        let ratios: Vec<f64> = excited
            .iter()
            .map(|run| run.occurrence.alignment.clock_ratio)
            .collect();
        let known = median(ratios).or(known_ratio);
        let beside_s = self.glides.first().map_or(0.0, |glide| glide.run_s.start);
        let taken = excited.iter().map(|run| widened(run.span_s(), beside_s));
        let taken: Vec<Range<f64>> = taken.collect();
        let mut glides = found(&self.glides, logged, &taken, known);
        glides.retain(|glide| is_inside(&glide.span_s(), logged));
        excited.into_iter().chain(glides).collect()
    }
}

/// What was logged during a play and shortly before and after it.
fn played<'l>(play: &Play, logged: &'l Logged) -> Logged<'l> {
    let times_s = logged.times_s;
    let [first, last] = [play.samples.start, play.samples.end - 1].map(|sample| times_s[sample]);
    let begin = times_s.partition_point(|time_s| *time_s < first - BESIDE_S);
    let end = times_s.partition_point(|time_s| *time_s <= last + BESIDE_S);
    Logged {
        times_s: &times_s[begin..end],
        values: logged.values.slice_move(s![.., begin..end]),
    }
}

/// A place with the moves and ramps around it.
fn widened(span_s: Range<f64>, beside_s: f64) -> Range<f64> {
    span_s.start - beside_s..span_s.end + beside_s
}

/// Whether a place lies in the recording: of a glide every part looks like the next.
fn is_inside(span_s: &Range<f64>, logged: &Logged) -> bool {
    let ends = logged.times_s.first().zip(logged.times_s.last());
    ends.is_some_and(|(first, last)| *first <= span_s.start && span_s.end <= *last)
}

fn found(
    sought: &[Sought],
    logged: &Logged,
    taken: &[Range<f64>],
    known_ratio: Option<f64>,
) -> Vec<FoundRun> {
    let templates: Vec<Template> = sought.iter().map(Sought::template).collect();
    let occurrences = find_occurrences(logged, &templates, taken, known_ratio);
    let of_run = |mut occurrence: Occurrence| {
        let sought = &sought[occurrence.template];
        let alignment = &mut occurrence.alignment;
        alignment.start_s += alignment.clock_ratio * sought.run_s.start;
        occurrence.stopped_s = occurrence
            .stopped_s
            .map(|stopped_s| stopped_s - sought.run_s.start);
        let length_s = sought.run_s.end - sought.run_s.start;
        FoundRun {
            id: sought.id,
            occurrence,
            length_s,
            delay_s: None,
        }
    };
    occurrences.into_iter().map(of_run).collect()
}

impl Sought {
    fn template(&self) -> Template<'_> {
        Template {
            reference: self.reference.view(),
            sample_time_s: self.sample_time_s,
            high_hz: self.high_hz,
        }
    }
}

/// An excited run above its constant velocity.
fn excitation(plan: &Plan, run: Run) -> Sought {
    let length_s = run.reference.ncols() as f64 * run.sample_time_s;
    let reference = without_mean(run.reference);
    Sought {
        id: run.id,
        reference,
        sample_time_s: run.sample_time_s,
        run_s: 0.0..length_s,
        high_hz: plan.excitation.waveform().band_hz()[1],
    }
}

fn without_mean(mut signal: Array2<f64>) -> Array2<f64> {
    for mut row in signal.rows_mut() {
        row -= row.mean().unwrap_or(0.0);
    }
    signal
}

/// A glide from rest to rest.
fn glide(plan: &Plan, run: &Run, player: &Player) -> Result<Sought, ExperimentError> {
    let playback = plan.playback(run, player)?;
    let t = playback.sample_time_s;
    let begin_s = playback.first_sample as f64 * t;
    let length_s = plan.run_samples()? as f64 * plan.sample_time_s;
    let reference = match playback.played {
        Played::Motion(motion) => motion.velocity_rad_s,
        Played::Torque(torque) => torque,
    };
    Ok(Sought {
        id: run.id,
        reference,
        sample_time_s: t,
        run_s: begin_s..begin_s + length_s,
        high_hz: plan.excitation.waveform().band_hz()[1],
    })
}
