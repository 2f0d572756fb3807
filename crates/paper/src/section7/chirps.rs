//! Section 7.2 of the paper: chirps whose references are shaped until the torque is as desired
//! (figures 3, 7 and 9).

use frfid_estimate::{Estimate, Shaped, Summary, scaled_condition_number};
use frfid_experiment::{Estimator, Experiment, ExperimentError, Progress};
use frfid_plant::Hold;
use frfid_signals::{Chirp, Excitation, Frf, Peaks, Plan};
use nalgebra::DMatrix;
use ndarray::{Array1, s};
use num_complex::Complex64;

/// Axis of figures 3 and 7, from 0.
const SHOWN_AXIS: usize = 2;

/// One iterative shaping of chirps, section 7.2.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapedChirps {
    /// Every iteration.
    pub iterations: Vec<Summary>,
    /// Number of the best iteration, from 1.
    pub best: usize,
    /// Number of the first iteration in which every axis moves, from 1.
    pub first: usize,
    /// FRF by excerpts from its records (figure 9).
    pub first_frf: Frf,
    /// FRF by excerpts from the records of the best iteration (figures 9 and 10).
    pub frf: Frf,
    /// The truth at the pose at the same frequencies, seen through the sensor.
    pub truth: Frf,
    /// How well U can be inverted; empty if the best iteration was stopped before its end.
    pub conditions: Conditions,
    /// Sample time in s.
    pub sample_time_s: f64,
    /// Torque of axis 3 in N m in the first experiment of the best iteration (figure 7), and its
    /// spectrum (figure 3).
    pub torque_nm: Array1<f64>,
    /// The torque that was desired there.
    pub desired_nm: Array1<f64>,
    /// The chirp, for its frequency over time.
    pub chirp: Chirp,
    /// Largest values of the best iteration.
    pub peaks: Peaks,
    /// Number of runs.
    pub n_runs: usize,
    /// Time on the robot in s.
    pub robot_time_s: f64,
    /// What is to be said of axes that stick, in words.
    pub warnings: Vec<String>,
}

/// Condition numbers of U, its channels scaled to equal size, line by line.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Conditions {
    /// Frequencies in Hz: lines of the whole record.
    pub frequency_hz: Vec<f64>,
    /// In the best iteration: orthogonality was made at u.
    pub at_torque: Vec<f64>,
    /// As the references of `[chirp]` would make them through the same response: orthogonality made
    /// at r.
    pub at_reference: Vec<f64>,
}

impl ShapedChirps {
    /// Shapes the chirp of `experiment` on its model.
    ///
    /// # Errors
    /// [`ExperimentError`] of a run, the shaping or an estimate, or an interruption.
    pub fn run(
        experiment: &Experiment,
        jobs: usize,
        progress: Progress,
    ) -> Result<Self, ExperimentError> {
        let plan = experiment.plan();
        let chirp = chirp_of(plan);
        let estimator = Estimator::new(plan, &experiment.config().estimate)?;
        let (shaped, first) = shape(experiment, &estimator, jobs, progress)?;
        let desired = experiment.desired_signal()?;
        let frf = estimator.frf_of_experiments(&shaped.best.records)?;
        let (first, first_frf) = first.unwrap_or_else(|| (shaped.best.number, frf.clone()));
        let axis = SHOWN_AXIS.min(plan.n_inputs - 1);
        let n_runs = shaped.iterations.len() * plan.n_experiments();
        Ok(Self {
            first,
            first_frf,
            truth: experiment.truth(&frf.frequency_hz, Hold::Zoh, true)?,
            frf,
            best: shaped.best.number,
            conditions: match &shaped.best.estimate {
                Some(estimate) => Conditions::of(estimate, plan, chirp)?,
                None => Conditions::default(),
            },
            sample_time_s: plan.sample_time_s,
            torque_nm: shaped.best.records[0].u.row(axis).to_owned(),
            desired_nm: desired.slice(s![0, axis, ..]).to_owned(),
            chirp: chirp.clone(),
            peaks: shaped.best.peaks,
            n_runs,
            robot_time_s: n_runs as f64 * plan.run_samples()? as f64 * plan.sample_time_s,
            warnings: shaped.sticking.iter().map(ToString::to_string).collect(),
            iterations: shaped.iterations,
        })
    }

    /// The iteration that came closest.
    pub(crate) fn best_iteration(&self) -> &Summary {
        &self.iterations[self.best - 1]
    }
}

/// Number and FRF of an iteration.
type NumberedFrf = (usize, Frf);

/// The shaping, and number and FRF of its first iteration in which every axis moves.
fn shape(
    experiment: &Experiment,
    estimator: &Estimator,
    jobs: usize,
    progress: Progress,
) -> Result<(Shaped, Option<NumberedFrf>), ExperimentError> {
    let mut first = None;
    let shaped = experiment.shape_in_memory(jobs, progress, &mut |iteration| {
        if first.is_none() && iteration.stuck_share.iter().all(|share| *share < 1.0) {
            let frf = estimator.frf_of_experiments(&iteration.records)?;
            first = Some((iteration.number, frf));
        }
        Ok(())
    })?;
    Ok((shaped, first))
}

/// The chirp of a plan.
fn chirp_of(plan: &Plan) -> &Chirp {
    match &plan.excitation {
        Excitation::Chirp(chirp) => chirp,
        _ => unreachable!("the template is a chirp"),
    }
}

impl Conditions {
    /// cond(U) as it is, and as the references of the plan would make it through the same response.
    fn of(estimate: &Estimate, plan: &Plan, chirp: &Chirp) -> Result<Self, ExperimentError> {
        let n = plan.n_inputs;
        let r_to_u = &estimate.r_to_u;
        let through_response = |(line, &hz): (usize, &f64)| {
            let r = references(plan, chirp, hz);
            let g = DMatrix::from_fn(n, n, |output, input| r_to_u.response[[line, output, input]]);
            Ok(scaled_condition_number(&(g * r))?)
        };
        let lines = r_to_u.frequency_hz.iter().enumerate();
        let at_reference = lines
            .map(through_response)
            .collect::<Result<Vec<f64>, ExperimentError>>()?;
        Ok(Self {
            frequency_hz: r_to_u.frequency_hz.clone(),
            at_torque: estimate.condition.clone(),
            at_reference,
        })
    }
}

/// The references of a plan at one frequency, `(channel, experiment)`.
fn references(plan: &Plan, chirp: &Chirp, hz: f64) -> DMatrix<Complex64> {
    let n = plan.n_inputs;
    DMatrix::from_fn(n, n, |channel, experiment| {
        let amplitude = chirp.amplitude[channel % chirp.amplitude.len()].at(hz);
        Complex64::from_polar(amplitude, plan.phasing.phase_rad(channel, experiment, n))
    })
}
