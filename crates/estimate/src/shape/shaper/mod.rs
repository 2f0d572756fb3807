//! State of a shaping: a reference to apply, then what was measured, then the next reference.
//!
//! Nothing but the records decides what follows, so that feeding the recorded iterations again
//! leads to the same state: that is how a shaping is resumed or looked at again.

mod judgement;

use frfid_signals::checks::require_shape;
use frfid_signals::{Peaks, Record, Run, RunId, SignalError};
use ndarray::{Array2, Array3, ArrayView2, Axis};

use crate::excitation_strength::stuck::stuck_samples;
use crate::frf::matrices::Matrix;
use crate::shape::error::ShapeError;
use crate::shape::iteration::{Estimate, Iteration};
use crate::shape::limits::{Margins, exceeded, peaks_of_signals, signals_of};
use crate::shape::measure::{estimate, stopped};
use crate::shape::note::Note;
use crate::shape::options::ShapeOptions;
use crate::shape::proposal::{Origin, Proposal};
use crate::shape::spectra::Band;
use crate::shape::sticking::{Sweep, sticking};
use crate::shape::summary::{Shaped, Stop, Summary};

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
    desired: Vec<Matrix>,
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
        let n_axes = start.len_of(Axis(1));
        options.check(n_axes)?;
        check_shapes(&desired, &start)?;
        let band = Band::new(&desired, &options)?;
        let target = band.all("desired", desired.axis_iter(Axis(0)))?;
        band.check_excited(&target)?;
        band.all("start", start.axis_iter(Axis(0)))?;
        Proposal::check_start(&start, &options)?;
        let damping = options.step.damping();
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
        let references = self.reference.axis_iter(Axis(0)).enumerate();
        references
            .map(|(experiment, reference)| self.run(experiment, reference))
            .collect()
    }

    fn run(&self, experiment: usize, reference: ArrayView2<f64>) -> Run {
        Run {
            id: RunId::excitation(self.number(), experiment, 0),
            sample_time_s: self.options.sample_time_s,
            reference: reference.to_owned(),
            velocity_rad_s: vec![0.0; reference.nrows()],
            start_rad: vec![0.0; reference.nrows()],
        }
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
        Ok(Shaped {
            sticking: sticking(&best, &self.options),
            best,
            iterations: self.iterations,
            stop: self.stop.unwrap_or(Stop::Watcher),
        })
    }

    /// The iteration that the records show, without what follows from it.
    fn evaluate(&self, records: Vec<Record>) -> Result<Iteration, ShapeError> {
        let sample_time_s = self.options.sample_time_s;
        let mut notes = stopped(&records, self.reference.dim(), sample_time_s)?;
        let is_complete = notes.is_empty();
        let estimate = is_complete.then(|| self.estimate(&records)).transpose()?;
        let peaks = peaks_of_signals(signals_of(&records, sample_time_s).each_ref());
        let excesses = exceeded(&self.options.limits, &peaks).into_iter();
        notes.extend(excesses.map(Note::Exceeded));
        let within_limits = notes.is_empty();
        let still_rad_s = self.options.still_rad_s;
        let stuck: Vec<_> = records
            .iter()
            .map(|record| stuck_samples(record, still_rad_s))
            .collect();
        let stuck_share = self.sweep.stuck_share(&stuck);
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

    fn estimate(&self, records: &[Record]) -> Result<Estimate, ShapeError> {
        let (reference, desired) = (&self.reference, &self.desired);
        estimate(records, reference, &self.band, desired, &self.options)
    }

    /// Makes the next reference: from this iteration, or from the best one if this is taken back.
    fn propose(&mut self, iteration: &mut Iteration, improved: bool) -> Result<(), ShapeError> {
        let take_back = !improved && (self.goes_back() || !iteration.within_limits);
        let best = self.best.as_ref().filter(|_| take_back);
        let from = best.unwrap_or(&*iteration);
        let Some(estimate) = &from.estimate else {
            return Ok(()); // without one it is taken back
        };
        let origin = Origin {
            iteration: from,
            estimate,
            band: &self.band,
            options: &self.options,
        };
        let proposal = Proposal::after(&origin, &self.desired, &self.next_damping, &self.margins)?;
        self.stepped_from = Some((from.peaks.clone(), estimate.error_per_frequency.clone()));
        iteration.notes.extend(proposal.notes);
        iteration.next_predicted = Some(proposal.predicted.clone());
        self.reference = proposal.reference;
        self.predicted = Some(proposal.predicted);
        self.damping = self.next_damping.mean();
        Ok(())
    }
}

/// Refuses a desired signal and an initial reference that do not go together.
fn check_shapes(desired: &Array3<f64>, start: &Array3<f64>) -> Result<(), SignalError> {
    let (n_experiments, n_axes, n_samples) = start.dim();
    let fits = n_experiments == n_axes && desired.dim() == start.dim();
    let shape = [n_axes, n_axes, n_samples];
    let needed = format_args!("{shape:?}, as the initial reference, one experiment per channel");
    require_shape("desired", desired.shape(), fits, needed)
}
