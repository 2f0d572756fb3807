//! Simulated runs side by side: each goes as it does alone, sample by sample.

use frfid_signals::{GoOn, SignalError};

use crate::error::PlantError;
use crate::lanes::LANES;
use crate::motion::fleet::{Fleet, squads};
use crate::motion::{Acting, Motion};
use crate::testbed::run_loop::RunLoop;
use crate::testbed::simulate::Clock;

/// How many samples are done before it is asked again whether to go on.
const SAMPLES_BETWEEN: usize = 256;

/// A run at its beginning.
pub(crate) struct Begun<'a> {
    pub(crate) run_loop: RunLoop<'a>,
    pub(crate) clock: Clock,
    pub(crate) motion: Box<dyn Motion>,
}

/// A run that is going on, or has ended.
struct Going<'a> {
    run_loop: RunLoop<'a>,
    /// The number of its samples, or why there are none.
    end: Option<Result<usize, PlantError>>,
}

impl<'a> Going<'a> {
    /// What acts until the next sample; `None` once it has ended.
    fn acting(&self) -> Option<Acting<'_>> {
        self.end.is_none().then(|| self.run_loop.acting())
    }

    /// The loop, and how many samples were done.
    ///
    /// # Errors
    /// What ended the run.
    fn done(self) -> Result<(RunLoop<'a>, usize), PlantError> {
        let n_samples = self.end.unwrap_or(Err(SignalError::Interrupted.into()))?;
        Ok((self.run_loop, n_samples))
    }
}

/// Goes through runs; returns each with the number of its samples.
///
/// # Errors
/// Of each run, why it did not begin or what ended it; [`SignalError::Interrupted`] of those that
/// were going on when `go_on` said no.
pub(crate) fn go_through<'a>(
    begun: impl Iterator<Item = Result<Begun<'a>, PlantError>>,
    go_on: GoOn,
) -> Vec<Result<(RunLoop<'a>, usize), PlantError>> {
    let mut motions = Vec::new();
    let mut runs: Vec<Result<Going, PlantError>> = Vec::new();
    for begun in begun {
        runs.push(begun.map(|begun| {
            motions.push((begun.clock, begun.motion));
            Going {
                run_loop: begun.run_loop,
                end: None,
            }
        }));
    }
    let sound = runs.iter_mut().filter_map(|run| run.as_mut().ok());
    let mut sound: Vec<Option<&mut Going>> = sound.map(Some).collect();
    for mut squad in squads(motions) {
        let places = squad.places.iter();
        let mut going: Vec<&mut Going> = places.filter_map(|&place| sound[place].take()).collect();
        together(&mut *squad.fleet, &mut going, squad.pace, go_on);
    }
    let done = runs.into_iter().map(|run| run.and_then(Going::done));
    done.collect()
}

/// Goes through the runs of a fleet.
fn together(fleet: &mut dyn Fleet, runs: &mut [&mut Going], clock: Clock, go_on: GoOn) {
    for sample in 0.. {
        for (robot, run) in runs.iter_mut().enumerate() {
            if run.end.is_none() {
                run.end = run.run_loop.sample(sample, fleet.motion(robot)).map(Ok);
            }
        }
        let mut acting = [None; LANES];
        for (acting, run) in acting.iter_mut().zip(&*runs) {
            *acting = run.acting();
        }
        let all_ended = acting.iter().all(Option::is_none);
        if all_ended || (sample % SAMPLES_BETWEEN == 0 && !go_on()) {
            return;
        }
        let acting = &acting[..runs.len()];
        for (robot, error) in fleet.advance(clock.n_steps, clock.step_s(), acting) {
            runs[robot].end = Some(Err(error));
        }
    }
}
