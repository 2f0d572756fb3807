//! The iteration as a state: a reference to apply, then what was measured, then the next reference.
//!
//! Nothing but the records decides what follows, so that feeding the recorded iterations again
//! leads to the same state: that is how a shaping is resumed or looked at again.

use frfid_signals::{Peaks, Record, Run, RunId, RunKind, SignalError};
use nalgebra::DMatrix;
use ndarray::{Array2, Array3, Axis};
use num_complex::Complex64;

use crate::excitation_strength::stuck_samples;
use crate::shape::error::ShapeError;
use crate::shape::iteration::{Estimate, Iteration, Note, Shaped, Stop, Summary};
use crate::shape::limits::{Margins, exceeded, peaks_of_signals, teach, travel_of};
use crate::shape::measure::{estimate, stack, stopped};
use crate::shape::options::{ShapeOptions, Step};
use crate::shape::proposal::Proposal;
use crate::shape::spectra::Band;
use crate::shape::step::adapt;
use crate::shape::sticking::{Sweep, sticking};

/// Stuck share of the sweep from which an axis counts as stuck altogether.
const STUCK: f64 = 0.95;

/// Iterative shaping, one iteration at a time: apply [`Shaper::runs`], hand the records to
/// [`Shaper::measured`], until [`Shaper::stop`] says why it ended.
#[derive(Clone)]
pub struct Shaper {
    options: ShapeOptions,
    band: Band,
    sweep: Sweep,
    /// Desired spectra on the lines of the band, fades included.
    desired: Vec<DMatrix<Complex64>>,
    /// The reference to apply next.
    reference: Array3<f64>,
    /// What is predicted of it.
    predicted: Option<Peaks>,
    /// Damping of the step that led to it.
    damping: Option<f64>,
    /// Damping of the next step, `(frequency, channel)`.
    next_damping: Array2<f64>,
    /// Factors on predicted changes.
    margins: Margins,
    /// Peaks and errors of the iteration from which the next reference steps.
    stepped_from: Option<(Peaks, Array2<f64>)>,
    /// Iterations in a row that brought no smaller error.
    rises: usize,
    last: Option<Iteration>,
    best: Option<Iteration>,
    iterations: Vec<Summary>,
    stop: Option<Stop>,
}

impl Shaper {
    /// Begins towards `desired`, in the unit of the target, with the reference `start` in rad/s;
    /// both `(experiment, channel, sample)`, one experiment per channel.
    ///
    /// # Errors
    /// [`ShapeError::Estimate`] for options or shapes that are wrong,
    /// [`ShapeError::StartTooLarge`].
    pub fn new(
        desired: Array3<f64>,
        start: Array3<f64>,
        options: ShapeOptions,
    ) -> Result<Self, ShapeError> {
        let (n_experiments, n_axes, n_samples) = start.dim();
        options.check(n_axes)?;
        if n_experiments != n_axes || desired.dim() != start.dim() {
            let needed = format!(
                "{:?}, as the initial reference, one experiment per channel",
                [n_axes, n_axes, n_samples]
            );
            return Err(SignalError::Shape {
                name: "desired",
                found: desired.shape().to_vec(),
                needed,
            }
            .into());
        }
        let band = Band::new(&desired, &options)?;
        let target = band.all("desired", desired.axis_iter(Axis(0)))?;
        band.check_excited(&target)?;
        band.all("start", start.axis_iter(Axis(0)))?;
        Proposal::check_start(&start, &options)?;
        let damping = match options.step {
            Step::Paper => 1.0,
            Step::Damped { damping, .. } => damping,
        };
        Ok(Self {
            sweep: Sweep::of(&band, &desired, &target, [options.low_hz, options.high_hz]),
            margins: std::array::from_fn(|_| vec![options.margin; n_axes]),
            next_damping: Array2::from_elem((band.frequency_hz.len(), n_axes), damping),
            stepped_from: None,
            desired: target,
            reference: start,
            predicted: None,
            damping: None,
            rises: 0,
            last: None,
            best: None,
            iterations: Vec::new(),
            stop: None,
            options,
            band,
        })
    }

    /// Number of the next iteration, from 1.
    #[must_use]
    pub fn number(&self) -> usize {
        self.iterations.len() + 1
    }

    /// The reference to apply next, `(experiment, channel, sample)`, in rad/s.
    #[must_use]
    pub fn reference(&self) -> &Array3<f64> {
        &self.reference
    }

    /// Peaks predicted for the next reference; `None` before the first.
    #[must_use]
    pub fn predicted(&self) -> Option<&Peaks> {
        self.predicted.as_ref()
    }

    /// The runs of the next iteration, one per experiment, from rest: the realization is the number
    /// of the iteration.
    #[must_use]
    pub fn runs(&self) -> Vec<Run> {
        let run = |(experiment, reference): (usize, ndarray::ArrayView2<f64>)| Run {
            id: RunId {
                kind: RunKind::Excitation,
                realization: self.number(),
                experiment,
                repetition: 0,
            },
            sample_time_s: self.options.sample_time_s,
            reference: reference.to_owned(),
            velocity_rad_s: vec![0.0; reference.nrows()],
            start_rad: vec![0.0; reference.nrows()],
        };
        self.reference
            .axis_iter(Axis(0))
            .enumerate()
            .map(run)
            .collect()
    }

    /// Why it ended; `None` while there is a reference to apply.
    #[must_use]
    pub fn stop(&self) -> Option<Stop> {
        self.stop
    }

    /// Ends it from outside, unless it has ended already.
    pub fn end(&mut self) {
        self.stop.get_or_insert(Stop::Watcher);
    }

    /// The best iteration so far: the smallest error of those that kept all limits.
    #[must_use]
    pub fn best(&self) -> Option<&Iteration> {
        self.best.as_ref()
    }

    /// Takes the records of [`Shaper::runs`], in their order, and makes the next reference from
    /// them.
    ///
    /// # Errors
    /// [`ShapeError`]: records of another shape, a target that does not respond, a first iteration
    /// that exceeded a limit.
    pub fn measured(&mut self, records: Vec<Record>) -> Result<&Iteration, ShapeError> {
        let mut iteration = self.evaluate(records)?;
        let improved = self.judge(&mut iteration)?;
        if improved {
            self.best = Some(iteration.clone());
        }
        self.stop = self.reason_to_stop(&iteration);
        if self.stop.is_none() {
            self.propose(&mut iteration, improved)?;
        }
        self.iterations.push(iteration.summary());
        Ok(self.last.insert(iteration))
    }

    /// The result.
    ///
    /// # Errors
    /// [`ShapeError::NothingMeasured`] before the first iteration.
    pub fn finish(self) -> Result<Shaped, ShapeError> {
        let best = self.best.ok_or(ShapeError::NothingMeasured)?;
        let coulomb_nm = self.options.coulomb_nm.as_deref();
        let sticking = sticking(
            &best.bands,
            &best.stuck_share,
            self.options.max_stuck_share,
            coulomb_nm,
        );
        Ok(Shaped {
            best,
            iterations: self.iterations,
            stop: self.stop.unwrap_or(Stop::Watcher),
            sticking,
        })
    }

    /// What the records say, without what follows from it.
    fn evaluate(&self, records: Vec<Record>) -> Result<Iteration, ShapeError> {
        let mut notes = stopped(&records, self.reference.dim(), self.options.sample_time_s)?;
        let complete = notes.is_empty();
        let estimate = if complete {
            Some(estimate(
                &records,
                &self.reference,
                &self.band,
                &self.desired,
                &self.options,
            )?)
        } else {
            None
        };
        let (torque, velocity) = (
            stack(&records, |record| &record.u),
            stack(&records, |record| &record.y),
        );
        let travel = travel_of(&records, &velocity, self.options.sample_time_s);
        let peaks = peaks_of_signals([&torque, &velocity, &travel]);
        notes.extend(
            exceeded(&self.options.limits, &peaks)
                .into_iter()
                .map(Note::Exceeded),
        );
        let stuck: Vec<_> = records
            .iter()
            .map(|record| stuck_samples(record, self.options.still_rad_s))
            .collect();
        let stuck_share = self.sweep.stuck_share(&stuck);
        let within_limits = notes.is_empty();
        if stuck_share.iter().all(|&share| share > STUCK) {
            notes.push(Note::AllStuck);
        }
        Ok(Iteration {
            number: self.number(),
            reference: self.reference.clone(),
            damping: self.damping,
            estimate,
            bands: self.sweep.bands(&records, &stuck),
            stuck_share,
            records,
            predicted: self.predicted.clone(),
            peaks,
            next_predicted: None,
            within_limits,
            notes,
        })
    }

    /// Whether the iteration is the best so far; adapts damping and margins.
    fn judge(&mut self, iteration: &mut Iteration) -> Result<bool, ShapeError> {
        if let (Some((before, _)), Some(predicted)) = (&self.stepped_from, &iteration.predicted) {
            let peaks = [&iteration.peaks, before, predicted];
            teach(&mut self.margins, peaks, &self.options.limits);
        }
        let best = self.best.as_ref().and_then(Iteration::error);
        let estimate = iteration
            .estimate
            .as_ref()
            .filter(|_| iteration.within_limits);
        let improved = match (estimate, best) {
            (None, None) => {
                // the other notes say the same of the other experiments
                let reason = iteration
                    .notes
                    .first()
                    .map_or_else(String::new, ToString::to_string);
                return Err(ShapeError::FirstTooMuch { reason });
            }
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

    /// Halves the damping where the error rose.
    fn adapt(&mut self, estimate: &Estimate) {
        if let (
            Step::Damped {
                adaptive: true,
                smoothing_bins,
                ..
            },
            Some((_, before)),
        ) = (self.options.step, &self.stepped_from)
        {
            adapt(
                &mut self.next_damping,
                &estimate.error_per_frequency,
                before,
                smoothing_bins,
            );
        }
    }

    /// Whether an iteration that is not the best is taken back.
    fn goes_back(&self) -> bool {
        matches!(self.options.step, Step::Damped { adaptive: true, .. })
    }

    fn reason_to_stop(&self, iteration: &Iteration) -> Option<Stop> {
        let reached = iteration.within_limits
            && iteration.estimate.as_ref().is_some_and(|estimate| {
                estimate
                    .channel_error
                    .iter()
                    .all(|&error| error <= self.options.good_enough)
            });
        if reached {
            let free = iteration
                .stuck_share
                .iter()
                .all(|&share| share <= self.options.max_stuck_share);
            Some(if free {
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

    /// Makes the next reference: from this iteration, or from the best one if this is taken back.
    fn propose(&mut self, iteration: &mut Iteration, improved: bool) -> Result<(), ShapeError> {
        let take_back = !improved && (self.goes_back() || !iteration.within_limits);
        let best = self.best.as_ref().filter(|_| take_back);
        let from = best.unwrap_or(&*iteration);
        let Some(estimate) = &from.estimate else {
            return Ok(());
        }; // without one it is taken back
        let proposal = Proposal::after(
            from,
            estimate,
            &self.band,
            &self.desired,
            &self.next_damping,
            &self.margins,
            &self.options,
        )?;
        self.stepped_from = Some((from.peaks.clone(), estimate.error_per_frequency.clone()));
        iteration.notes.extend(proposal.notes);
        iteration.next_predicted = Some(proposal.predicted.clone());
        self.reference = proposal.reference;
        self.predicted = Some(proposal.predicted);
        self.damping = self.next_damping.mean();
        Ok(())
    }
}
