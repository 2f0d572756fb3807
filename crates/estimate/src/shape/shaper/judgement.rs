//! Judgement of an iteration: whether it is the best so far, what it teaches, whether it is the last.

use crate::shape::error::ShapeError;
use crate::shape::iteration::{Estimate, Iteration};
use crate::shape::limits::teach;
use crate::shape::note::Note;
use crate::shape::options::Step;
use crate::shape::shaper::Shaper;
use crate::shape::step::adapt;
use crate::shape::summary::Stop;

impl Shaper {
    /// Whether the iteration is the best so far; adapts damping and margins.
    pub(super) fn judge(&mut self, iteration: &mut Iteration) -> Result<bool, ShapeError> {
        self.learn_margins(iteration);
        let best = self.best.as_ref().and_then(Iteration::error);
        let estimate = iteration.estimate.as_ref();
        let improved = match (estimate.filter(|_| iteration.within_limits), best) {
            (None, None) => return Err(first_too_much(iteration)),
            (None, Some(_)) => {
                self.next_damping *= 0.5;
                false
            }
            (Some(estimate), best) => {
                self.adapt(estimate);
                best.is_none_or(|best| estimate.error < best)
            }
        };
        if let (Some(found), Some(best), false) = (iteration.error(), best, improved) {
            iteration.notes.push(Note::Rose { found, best });
        }
        self.rises = if improved { 0 } else { self.rises + 1 };
        Ok(improved)
    }

    /// Learns from how well the peaks were predicted.
    fn learn_margins(&mut self, iteration: &Iteration) {
        if let Some((before, _)) = &self.stepped_from
            && let Some(predicted) = &iteration.predicted
        {
            let peaks = [&iteration.peaks, before, predicted];
            teach(&mut self.margins, peaks, &self.options.limits);
        }
    }

    /// Halves the damping where the error rose.
    fn adapt(&mut self, estimate: &Estimate) {
        if let Step::Damped {
            adaptive: true,
            smoothing_bins,
            ..
        } = self.options.step
            && let Some((_, before)) = &self.stepped_from
        {
            let error = &estimate.error_per_frequency;
            adapt(&mut self.next_damping, error, before, smoothing_bins);
        }
    }

    /// Whether an iteration that is not the best is taken back.
    pub(super) fn goes_back(&self) -> bool {
        matches!(self.options.step, Step::Damped { adaptive: true, .. })
    }

    /// Why the iteration is the last; `None` if another one follows.
    pub(super) fn reason_to_stop(&self, iteration: &Iteration) -> Option<Stop> {
        if iteration.within_limits && self.is_good_enough(iteration) {
            Some(if self.is_free(iteration) {
                Stop::GoodEnough
            } else {
                Stop::Sticking
            })
        } else if self.rises >= 2 {
            Some(Stop::RoseTwice)
        } else if iteration.number >= self.options.n_iterations {
            Some(Stop::AllIterations)
        } else {
            None
        }
    }

    /// Whether the error is small enough on every channel.
    fn is_good_enough(&self, iteration: &Iteration) -> bool {
        let fits = |error: &f64| *error <= self.options.good_enough;
        let estimate = iteration.estimate.as_ref();
        estimate.is_some_and(|estimate| estimate.channel_error.iter().all(fits))
    }

    /// Whether no axis sticks for too long.
    fn is_free(&self, iteration: &Iteration) -> bool {
        let fits = |share: &f64| *share <= self.options.max_stuck_share;
        iteration.stuck_share.iter().all(fits)
    }
}

/// The error of a first iteration beyond its limits; the notes after the first say the same of the
/// other experiments.
fn first_too_much(iteration: &Iteration) -> ShapeError {
    let first = iteration.notes.first();
    ShapeError::FirstTooMuch {
        reason: first.map_or_else(String::new, ToString::to_string),
    }
}
