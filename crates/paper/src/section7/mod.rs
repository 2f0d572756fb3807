//! Section 7 of the paper: the base axes of a robot in closed loop, every experiment of figures 3
//! and 6 to 10.

pub(crate) mod chirps;
pub(crate) mod claims;
pub(crate) mod figures;
pub(crate) mod frf_errors;
pub(crate) mod lists;
pub(crate) mod multisine;
mod parts;

use frfid_estimate::Summary;
use frfid_experiment::{Experiment, ExperimentError, Progress, StepName, Template, in_pool};
use frfid_plant::Hold;
use frfid_signals::{Amplitude, Frf, Phasing, log_spaced};
use rayon::join;

use crate::section7::chirps::ShapedChirps;
use crate::section7::multisine::MultisineCampaign;
use crate::section7::parts::{Part, Parts};

/// Everything section 7 shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Section7 {
    /// Names of the joints.
    pub joint_names: Vec<String>,
    /// Coulomb friction of every axis in N m.
    pub coulomb_nm: Vec<f64>,
    /// The linear truth at the pose, seen through the sensor, on a grid dense enough to be drawn.
    pub truth: Frf,
    /// Section 7.1: the multisine on a constant velocity.
    pub multisine: MultisineCampaign,
    /// Section 7.2: shaped chirps, SK15 (9).
    pub orthogonal: ShapedChirps,
    /// Section 7.2: shaped chirps, SK15 (26).
    pub sign_flip: ShapedChirps,
    /// Every iteration of the paper's undamped step, SK15 (18), with the phasing of `sign_flip`.
    pub paper_step: Vec<Summary>,
    /// What is said of the desired torques of the paper's table 1, which are weaker than this
    /// robot's friction.
    pub table1_warnings: Vec<String>,
}

/// Of a shaping: its experiments move side by side on one thread, while other shapings take the others.
const ONE_JOB: usize = 1;

impl Section7 {
    /// Does every experiment on the model; `progress` is reported in percent.
    ///
    /// # Errors
    /// [`ExperimentError::Interrupted`] and [`ExperimentError::ShapingInterrupted`]; any other
    /// would be a fault of this library.
    pub fn run(jobs: usize, progress: Progress) -> Result<Self, ExperimentError> {
        let parts = Parts::of(progress);
        let chirp = of_template("r3-chirp")?;
        let chirps = |part: Part, phasing: Phasing| {
            let chirp = with_phasing(&chirp, phasing)?;
            ShapedChirps::run(&chirp, ONE_JOB, &parts.of_part(part))
        };
        let multisine = papers_multisine()?;
        let campaign = MultisineCampaign::run(&multisine, jobs, &parts.of_part(Part::Multisine))?;
        let shapings = || {
            Ok(join(
                || {
                    join(
                        || chirps(Part::Orthogonal, Phasing::Orthogonal),
                        || chirps(Part::SignFlip, Phasing::SignFlip),
                    )
                },
                || {
                    join(
                        || paper_step(&chirp, &parts.of_part(Part::PaperStep)),
                        || table1(&chirp, &parts.of_part(Part::Table1)),
                    )
                },
            ))
        };
        let ((orthogonal, sign_flip), (paper_step, table1_warnings)) = in_pool(jobs, shapings)?;
        Ok(Self {
            joint_names: multisine.joint_names().to_vec(),
            coulomb_nm: multisine.model()?.coulomb_nm(),
            truth: multisine.truth(&log_spaced(2.0, 60.0, 600)?, Hold::Zoh, true)?,
            multisine: campaign,
            orthogonal: orthogonal?,
            sign_flip: sign_flip?,
            paper_step: paper_step?,
            table1_warnings: table1_warnings?,
        })
    }
}

/// The experiment of a template.
fn of_template(kind: &str) -> Result<Experiment, ExperimentError> {
    let template = Template::named(kind).expect("the templates of section 7 are built in");
    Ok(Experiment::of_template(template)?)
}

/// The multisines of section 7.1: a wider way and a stronger excitation than the template's, which a machine can
/// play from rest to rest.
fn papers_multisine() -> Result<Experiment, ExperimentError> {
    let template = of_template("r3-multisine")?;
    let papers = template.with(|config| {
        config.averaging.lead_in_s = Some(2.0);
        if let Some(multisine) = &mut config.multisine {
            multisine.peak_of_velocity = Some(0.75);
        }
        if let Some(velocity) = &mut config.constant_velocity {
            velocity.travel_rad = Some(vec![0.136, 0.12, 0.128]);
        }
    });
    Ok(papers?)
}

/// The same chirps with other phases between channels and experiments.
fn with_phasing(experiment: &Experiment, phasing: Phasing) -> Result<Experiment, ExperimentError> {
    let phased = experiment.with(|config| {
        if let Some(chirp) = &mut config.chirp {
            chirp.mimo = phasing;
        }
    });
    Ok(phased?)
}

/// Iterations of the paper's own step: enough to see where it leads.
const PAPER_ITERATIONS: usize = 9;

/// Every iteration of the paper's own step, without the limits on the way: they would hold it where
/// it is.
fn paper_step(
    experiment: &Experiment,
    progress: Progress,
) -> Result<Vec<Summary>, ExperimentError> {
    let experiment = experiment.with(|config| {
        if let Some(shape) = &mut config.shape {
            shape.step = StepName::Paper;
            shape.n_iterations = PAPER_ITERATIONS;
        }
        config.limits = Default::default();
    })?;
    let mut iterations = Vec::new();
    experiment.shape_in_memory(ONE_JOB, progress, &mut |iteration| {
        iterations.push(iteration.summary());
        Ok(())
    })?;
    Ok(iterations)
}

/// What is said of the torques of the paper's table 1, half of them above 40 Hz: too weak for this
/// robot's friction.
fn table1(experiment: &Experiment, progress: Progress) -> Result<Vec<String>, ExperimentError> {
    const TORQUES_NM: [f64; 3] = [100.0, 150.0, 120.0];
    let experiment = experiment.with(|config| {
        if let Some(shape) = &mut config.shape {
            shape.desired_nm = Some(TORQUES_NM.map(half_above_40_hz).to_vec());
        }
    })?;
    Ok(ShapedChirps::run(&experiment, ONE_JOB, progress)?.warnings)
}

/// An amplitude in N m that falls to one half around 40 Hz.
fn half_above_40_hz(torque_nm: f64) -> Amplitude {
    Amplitude::Points(vec![(38.0, torque_nm), (42.0, 0.5 * torque_nm)])
}
