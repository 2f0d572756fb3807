//! The iteration as a state: a reference to apply, then what was measured, then the next reference.
//!
//! Nothing but the records decides what follows, so that feeding the recorded iterations again leads to the same state: that
//! is how a shaping is resumed or looked at again.

use frfid_signals::{Frf, Record, Run, RunId, RunKind, SignalError};
use nalgebra::DMatrix;
use ndarray::{Array2, Array3, Axis};
use num_complex::Complex64;

use super::iteration::{Estimate, Iteration, Note, Peaks, Shaped, Stop, Summary};
use super::limits::travel_of;
use super::proposal::Proposal;
use super::spectra::Band;
use super::step::{coherence, response};
use super::sticking::{Sweep, sticking, stuck_samples};
use super::{ShapeError, ShapeOptions, Step, Target};
use crate::singular::condition_of_finite;

/// Share of the target's power in the band that the references must explain; what has nothing to do with them gets 0.1 by
/// chance on three axes and 0.2 on six.
const NEEDED_COHERENCE: f64 = 0.3;
/// Stuck share of the sweep from which an axis counts as stuck altogether.
pub(super) const STUCK: f64 = 0.95;

/// Iterative shaping, one iteration at a time: apply [`Shaper::runs`], hand the records to [`Shaper::measured`], until
/// [`Shaper::stop`] says why it ended.
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
    /// Damping of the next step.
    next_damping: f64,
    /// Factor on predicted peaks.
    margin: f64,
    /// Iterations in a row that brought no smaller error.
    rises: usize,
    last: Option<Iteration>,
    best: Option<Iteration>,
    iterations: Vec<Summary>,
    stop: Option<Stop>,
}

impl Shaper {
    /// Begins towards `desired`, in the unit of the target, with the reference `start` in rad/s; both
    /// `(experiment, channel, sample)`, one experiment per channel.
    ///
    /// # Errors
    /// [`ShapeError::Estimate`] for options or shapes that are wrong, [`ShapeError::StartTooLarge`].
    pub fn new(desired: Array3<f64>, start: Array3<f64>, options: ShapeOptions) -> Result<Self, ShapeError> {
        let (n_experiments, n_axes, n_samples) = start.dim();
        options.check(n_axes)?;
        if n_experiments != n_axes || desired.dim() != start.dim() {
            let needed =
                format!("{:?}, as the initial reference, one experiment per channel", [n_axes, n_axes, n_samples]);
            return Err(SignalError::Shape { name: "desired", found: desired.shape().to_vec(), needed }.into());
        }
        let band = Band::new(n_samples, &options)?;
        let target = band.all("desired", desired.axis_iter(Axis(0)))?;
        band.all("start", start.axis_iter(Axis(0)))?;
        Proposal::check_start(&start, &options)?;
        let next_damping = match options.step {
            Step::Paper => 1.0,
            Step::Damped { damping, .. } => damping,
        };
        Ok(Self {
            sweep: Sweep::of(&band, &desired, &target, [options.low_hz, options.high_hz]),
            margin: options.limits.margin,
            desired: target,
            reference: start,
            predicted: None,
            damping: None,
            next_damping,
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

    /// The runs of the next iteration, one per experiment, from rest: the realization is the number of the iteration.
    #[must_use]
    pub fn runs(&self) -> Vec<Run> {
        let run = |(experiment, reference): (usize, ndarray::ArrayView2<f64>)| Run {
            id: RunId { kind: RunKind::Excitation, realization: self.number(), experiment, repetition: 0 },
            sample_time_s: self.options.sample_time_s,
            reference: reference.to_owned(),
            velocity_rad_s: vec![0.0; reference.nrows()],
            start_rad: vec![0.0; reference.nrows()],
        };
        self.reference.axis_iter(Axis(0)).enumerate().map(run).collect()
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

    /// Takes the records of [`Shaper::runs`], in their order, and makes the next reference from them.
    ///
    /// # Errors
    /// [`ShapeError`]: records of another shape, a target that does not respond, a first iteration that exceeded a limit.
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
        let sticking = sticking(&best.bands, &best.stuck_share, self.options.max_stuck_share, coulomb_nm);
        Ok(Shaped { best, iterations: self.iterations, stop: self.stop.unwrap_or(Stop::Watcher), sticking })
    }

    /// What the records say, without what follows from it.
    fn evaluate(&self, records: Vec<Record>) -> Result<Iteration, ShapeError> {
        let mut notes = Vec::new();
        self.check(&records, &mut notes)?;
        let complete = notes.is_empty();
        let (torque, velocity) = (stack(&records, |record| &record.u), stack(&records, |record| &record.y));
        let travel = travel_of(&records, &velocity, self.options.sample_time_s);
        let peaks = Peaks::of_signals([&torque, &velocity, &travel]);
        notes.extend(self.options.limits.exceeded(&peaks));
        let stuck: Vec<_> = records.iter().map(|record| stuck_samples(record, self.options.still_rad_s)).collect();
        let stuck_share = self.sweep.stuck_share(&stuck);
        let within_limits = notes.is_empty();
        if stuck_share.iter().all(|&share| share > STUCK) {
            notes.push(Note::AllStuck);
        }
        Ok(Iteration {
            number: self.number(),
            reference: self.reference.clone(),
            damping: self.damping,
            estimate: if complete { Some(self.estimate(&records)?) } else { None },
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

    /// Checks shapes and finiteness; a run that was stopped early is a note.
    fn check(&self, records: &[Record], notes: &mut Vec<Note>) -> Result<(), ShapeError> {
        let (n_experiments, n_axes, n_samples) = self.reference.dim();
        let shape = |name, found: Vec<usize>, needed| Err(SignalError::Shape { name, found, needed }.into());
        if records.len() != n_experiments {
            return shape("records", vec![records.len()], format!("({n_experiments}), one per experiment"));
        }
        for (experiment, record) in records.iter().enumerate() {
            record.check()?;
            for (name, signal) in [("u", &record.u), ("y", &record.y)] {
                if signal.nrows() != n_axes || signal.ncols() > n_samples {
                    return shape(name, signal.shape().to_vec(), format!("({n_axes}, {n_samples}), as the reference"));
                }
            }
            if record.n_samples() < n_samples {
                let reason =
                    record.events.last().map_or_else(|| "no reason given".into(), |event| format!("{:?}", event.kind));
                let time_s = record.n_samples() as f64 * self.options.sample_time_s;
                notes.push(Note::Stopped { experiment, time_s, reason });
            }
        }
        Ok(())
    }

    /// Responses and errors of complete records.
    fn estimate(&self, records: &[Record]) -> Result<Estimate, ShapeError> {
        let hz = &self.band.frequency_hz;
        let r = self.band.spectra("reference", self.reference.axis_iter(Axis(0)))?;
        let u = self.band.spectra("u", records.iter().map(|record| record.u.view()))?;
        let y = self.band.spectra("y", records.iter().map(|record| record.y.view()))?;
        let (target, name) = match self.options.target {
            Target::Torque => (&u, "torque"),
            Target::Velocity => (&y, "velocity"),
        };
        for (axis, &coherence) in coherence(target, &r, hz)?.iter().enumerate() {
            if coherence.is_nan() || coherence < NEEDED_COHERENCE {
                let (iteration, needed) = (self.number(), NEEDED_COHERENCE);
                return Err(ShapeError::NoResponse { iteration, target: name, axis, coherence, needed });
            }
        }
        let bins = match self.options.step {
            Step::Paper => 1,
            Step::Damped { smoothing_bins, .. } => smoothing_bins,
        };
        let frf = |x| Ok::<_, ShapeError>(Frf::new(hz.clone(), stacked(&response(x, &r, bins, hz)?))?);
        let desired = &self.desired[self.band.inside()];
        let error_per_frequency = relative_error(target, desired);
        let rms = |errors: &dyn Fn() -> Vec<f64>| frfid_signals::power::rms(&errors());
        let n_axes = error_per_frequency.ncols();
        Ok(Estimate {
            r_to_u: frf(&u)?,
            r_to_y: frf(&y)?,
            channel_error: (0..n_axes).map(|c| rms(&|| error_per_frequency.column(c).to_vec())).collect(),
            error: rms(&|| error_per_frequency.iter().copied().collect()),
            condition: u.iter().map(condition_of_finite).collect(),
            error_per_frequency,
        })
    }

    /// Whether the iteration is the best so far; adapts damping and margin.
    fn judge(&mut self, iteration: &mut Iteration) -> Result<bool, ShapeError> {
        if let Some(predicted) = &iteration.predicted {
            let limits = &self.options.limits;
            self.margin = limits.margin * iteration.peaks.surprise(predicted, limits).max(1.0);
        }
        let best = self.best.as_ref().and_then(Iteration::error);
        let (true, Some(found)) = (iteration.within_limits, iteration.error()) else {
            if best.is_none() {
                let reason = iteration.notes.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
                return Err(ShapeError::FirstTooMuch { reason });
            }
            self.next_damping *= 0.5;
            self.rises += 1;
            return Ok(false);
        };
        match best {
            Some(best) if found >= best => {
                iteration.notes.push(Note::Rose { found, best });
                self.rises += 1;
                if self.goes_back() {
                    self.next_damping *= 0.5;
                }
                Ok(false)
            }
            _ => {
                self.rises = 0;
                Ok(true)
            }
        }
    }

    /// Whether an iteration that is not the best is taken back.
    fn goes_back(&self) -> bool {
        matches!(self.options.step, Step::Damped { adaptive: true, .. })
    }

    fn reason_to_stop(&self, iteration: &Iteration) -> Option<Stop> {
        let reached = iteration.within_limits
            && iteration
                .estimate
                .as_ref()
                .is_some_and(|estimate| estimate.channel_error.iter().all(|&error| error <= self.options.good_enough));
        if reached {
            let free = iteration.stuck_share.iter().all(|&share| share <= self.options.max_stuck_share);
            Some(if free { Stop::GoodEnough } else { Stop::Sticking })
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
        let proposal = Proposal::after(from, &self.band, &self.desired, self.next_damping, self.margin, &self.options)?;
        iteration.notes.extend(proposal.notes);
        iteration.next_predicted = Some(proposal.predicted.clone());
        self.reference = proposal.reference;
        self.predicted = Some(proposal.predicted);
        self.damping = Some(self.next_damping);
        Ok(())
    }
}

/// One signal of all records, `(experiment, channel, sample)`; what is missing of a run that was stopped is 0.
pub(super) fn stack(records: &[Record], signal: impl Fn(&Record) -> &Array2<f64>) -> Array3<f64> {
    let n_samples = records.iter().map(Record::n_samples).max().unwrap_or(0);
    let n_channels = records.first().map_or(0, |record| signal(record).nrows());
    let mut stacked = Array3::zeros((records.len(), n_channels, n_samples));
    for (mut to, record) in stacked.axis_iter_mut(Axis(0)).zip(records) {
        to.slice_mut(ndarray::s![.., ..record.n_samples()]).assign(signal(record));
    }
    stacked
}

/// Matrices as one array `(frequency, output, input)`.
fn stacked(matrices: &[DMatrix<Complex64>]) -> Array3<Complex64> {
    let (rows, columns) = matrices[0].shape();
    Array3::from_shape_fn((matrices.len(), rows, columns), |(k, row, column)| matrices[k][(row, column)])
}

/// `|X - X_des| / |X_des|` over the experiments, `(frequency, channel)`.
fn relative_error(found: &[DMatrix<Complex64>], desired: &[DMatrix<Complex64>]) -> Array2<f64> {
    let n_channels = found[0].nrows();
    Array2::from_shape_fn((found.len(), n_channels), |(k, channel)| {
        let missing = &desired[k] - &found[k];
        missing.row(channel).norm() / desired[k].row(channel).norm()
    })
}
