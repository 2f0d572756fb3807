//! Recognised runs of a recording: where the clock of its player has them, or by their content alone.

use frfid_estimate::Logged;
use frfid_files::Log;
use frfid_signals::Plan;
use frfid_signals::format::significant;

use crate::error::ExperimentError;
use crate::play::import::places::Places;
use crate::play::import::plan_clock::followed;
use crate::play::import::plays::{Play, plays};
use crate::play::import::sought::{FoundRun, SoughtRuns};

/// A clock that runs faster or slower than the recorder's by more is no quartz: the speed was changed.
const MOST_OFF: f64 = 0.01;

/// What was recognised in a recording.
#[derive(Debug, Default)]
pub(super) struct Recognised {
    /// In no order.
    pub(super) runs: Vec<FoundRun>,
    /// What cannot be used.
    pub(super) unused: Vec<String>,
    /// What looks wrong.
    pub(super) warnings: Vec<String>,
}

impl Recognised {
    /// The runs in a log with samples at `times_s`.
    pub(super) fn of(log: &Log, times_s: &[f64], plan: &Plan, sought: &SoughtRuns) -> Self {
        let logged = followed(log, times_s, plan);
        let Some((clock, places)) = log.plan_clock.as_ref().zip(sought.places.as_ref()) else {
            return Self::by_content(&logged, sought);
        };
        let plays = plays(clock, times_s, places.step_s);
        if plays.is_empty() {
            let warnings = vec![STANDS.to_owned()];
            return Self {
                warnings,
                ..Self::by_content(&logged, sought)
            };
        }
        Self::in_plays(plays, places, &logged, sought)
    }

    /// The runs where the player's clock has them; at another speed there are none.
    fn in_plays(plays: Vec<Play>, places: &Places, logged: &Logged, sought: &SoughtRuns) -> Self {
        let (sound, scaled): (Vec<_>, Vec<_>) = plays.into_iter().partition(is_at_full_speed);
        let unused = scaled.iter().map(|play| scaled_words(play, logged.times_s));
        Self {
            runs: sought.find_in(&sound, places, logged),
            unused: unused.collect(),
            warnings: Vec::new(),
        }
    }

    fn by_content(logged: &Logged, sought: &SoughtRuns) -> Self {
        Self {
            runs: sought.find(logged, None),
            ..Self::default()
        }
    }
}

const STANDS: &str =
    "plan_clock of the map stands still in the recording: the runs are told by their content";

fn is_at_full_speed(play: &Play) -> bool {
    (play.ratio - 1.0).abs() <= MOST_OFF
}

fn scaled_words(play: &Play, times_s: &[f64]) -> String {
    let from_s = times_s[play.samples.start];
    let percent = significant(100.0 / play.ratio, 4);
    format!(
        "from {from_s:.3} s the player's clock runs at {percent} % of the recorder's: played at another speed or rate \
         (--rate), which moves every frequency"
    )
}

/// Checks that a recording is of the plan of this number, where it says so.
///
/// # Errors
/// [`ExperimentError::Logs`] of another plan, or none.
pub(super) fn check_plan_id(log: &Log, plan_id: u32) -> Result<(), ExperimentError> {
    let is_ours = |id: &f64| *id as f32 == plan_id as f32; // a REAL of a PLC has no more digits
    match &log.plan_id {
        Some(logged) if !logged.iter().any(is_ours) => Err(of_another_plan(logged, plan_id)),
        _ => Ok(()),
    }
}

fn of_another_plan(logged: &[f64], plan_id: u32) -> ExperimentError {
    let other = logged.iter().find(|id| id.is_finite() && **id != 0.0);
    ExperimentError::logs(
        "plan_id of the recording",
        other.map_or("0 all along".into(), f64::to_string),
        format!("{plan_id}, as `frfid export` of this plan writes it"),
        "name the plan that was played, or leave plan_id out of the map if the player did not bring it back",
    )
}
