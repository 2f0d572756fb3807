//! Section 6 of the paper: the academic example, every experiment of figures 4 and 5 and the claims
//! drawn from them.

pub(crate) mod claims;
pub(crate) mod figures;

use frfid_experiment::{ConstantVelocityTable, Experiment, ExperimentError, Progress, Template};
use frfid_plant::Hold;
use frfid_signals::{Draw, Excitation, Frf, Limit, log_spaced, power};

use crate::against_truth::Measured;

/// Stiffness beyond the knee of figure 5, 1.7 k1.
const STIFFER_NM_PER_RAD: f64 = 2.55e5;
/// Coulomb friction of figure 4.
const FRICTION_NM: f64 = 50.0;
/// A constant velocity that the 150 N m excitations cannot turn round.
const FAST_RAD_S: f64 = 0.25;
/// One that they do turn round.
const SLOW_RAD_S: f64 = 0.011;

/// A multisine's and a chirp's FRF of the same joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// Best linear approximation from 30 realizations of an odd random multisine.
    pub multisine: Measured,
    /// Excerpts of a 20 s chirp.
    pub chirp: Measured,
}

/// Everything section 6 shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Section6 {
    /// The exact FRF of the linear joint with k1, on a grid dense enough to be drawn.
    pub truth: Frf,
    /// No friction, k2 = k1.
    pub linear: Pair,
    /// F_c = 50 N m, k2 = k1: figure 4.
    pub friction: Pair,
    /// F_c = 50 N m on a constant velocity of 0.25 rad/s.
    pub gliding: Pair,
    /// The chirp on the same constant velocity without friction: what the one with friction should
    /// equal.
    pub gliding_frictionless: Measured,
    /// F_c = 50 N m on a constant velocity of 0.011 rad/s, which is too slow.
    pub slow: Pair,
    /// The chirp at 0.011 rad/s without friction.
    pub slow_frictionless: Measured,
    /// No friction, k2 = 1.7 k1: figure 5.
    pub stiffening: Pair,
    /// Power of multisines over that of the chirp at equal peak, for 1000 realizations, rising.
    pub power_share: Vec<f64>,
}

/// A variant of the paper's joint and of the way it is excited.
#[derive(Clone, Copy)]
struct Variant {
    coulomb_nm: f64,
    stiffness_beyond_nm_per_rad: f64,
    velocity_rad_s: f64,
}

const LINEAR: Variant = Variant {
    coulomb_nm: 0.0,
    stiffness_beyond_nm_per_rad: 1.5e5,
    velocity_rad_s: 0.0,
};

impl Section6 {
    /// Runs every experiment in simulation.
    ///
    /// # Errors
    /// [`ExperimentError::Interrupted`]; any other would be a fault of this library.
    pub fn run(jobs: usize, progress: Progress) -> Result<Self, ExperimentError> {
        const EXPERIMENTS: usize = 12;
        // every experiment is told as 1000 steps, whatever the number of its runs
        let mut number = 0;
        let mut measure = |kind: &str, variant: Variant| {
            let step = |done: usize, total: usize| {
                progress(
                    1000 * number + 1000 * done / total.max(1),
                    1000 * EXPERIMENTS,
                )
            };
            let measured = variant.measure(kind, jobs, &step);
            number += 1;
            measured
        };
        let mut pair = |variant: Variant| -> Result<Pair, ExperimentError> {
            Ok(Pair {
                multisine: measure("multisine", variant)?,
                chirp: measure("chirp", variant)?,
            })
        };
        let friction = Variant {
            coulomb_nm: FRICTION_NM,
            ..LINEAR
        };
        let linear = pair(LINEAR)?;
        let with_friction = pair(friction)?;
        let gliding = pair(Variant {
            velocity_rad_s: FAST_RAD_S,
            ..friction
        })?;
        let slow = pair(Variant {
            velocity_rad_s: SLOW_RAD_S,
            ..friction
        })?;
        let stiffening = pair(Variant {
            stiffness_beyond_nm_per_rad: STIFFER_NM_PER_RAD,
            ..LINEAR
        })?;
        let dense = log_spaced(1.0, 60.0, 600)?;
        Ok(Self {
            truth: LINEAR
                .experiment("chirp")?
                .truth(&dense, Hold::Zoh, false)?,
            linear,
            friction: with_friction,
            gliding,
            gliding_frictionless: measure(
                "chirp",
                Variant {
                    velocity_rad_s: FAST_RAD_S,
                    ..LINEAR
                },
            )?,
            slow,
            slow_frictionless: measure(
                "chirp",
                Variant {
                    velocity_rad_s: SLOW_RAD_S,
                    ..LINEAR
                },
            )?,
            stiffening,
            power_share: power_share()?,
        })
    }
}

impl Variant {
    /// The experiment of the template `kind` on this joint.
    fn experiment(self, kind: &str) -> Result<Experiment, ExperimentError> {
        let template = Template::named(kind).expect("the templates of section 6 are built in");
        let experiment = Experiment::of_template(template)?.with(|config| {
            if let Some(joint) = &mut config.robot.single_joint {
                joint.coulomb_nm = self.coulomb_nm;
                joint.stiffness_beyond_nm_per_rad = Some(self.stiffness_beyond_nm_per_rad);
            }
            if self.velocity_rad_s > 0.0 {
                config.constant_velocity = Some(ConstantVelocityTable {
                    velocity_rad_s: Some(vec![self.velocity_rad_s]),
                    travel_rad: None,
                    glides: 0,
                });
                config.limits.remove(Limit::Torque);
            }
        });
        Ok(experiment?)
    }

    fn measure(
        self,
        kind: &str,
        jobs: usize,
        progress: Progress,
    ) -> Result<Measured, ExperimentError> {
        let experiment = self.experiment(kind)?;
        let frf = experiment
            .measure(&*experiment.testbed(), jobs, progress)?
            .result
            .frf;
        let truth = experiment.truth(&frf.frequency_hz, Hold::Zoh, false)?;
        Ok(Measured { frf, truth })
    }
}

/// Mean power of multisines over that of the chirp of equal peak, for 1000 realizations, sorted
/// (SK15 section 6.1).
fn power_share() -> Result<Vec<f64>, ExperimentError> {
    let chirp = LINEAR.experiment("chirp")?.plan().period(0)?;
    let chirp_power = power::mean_power(chirp.as_slice().unwrap_or_default());
    let experiment = LINEAR.experiment("multisine")?;
    let plan = experiment.plan();
    let Excitation::Multisine(signal) = &plan.excitation else {
        return Ok(Vec::new());
    };
    let share = |realization| {
        let drawn = signal.realize(&Draw {
            seed: plan.seed,
            realization,
            phasing: plan.phasing,
        })?;
        Ok(power::mean_power(drawn.signal.as_slice().unwrap_or_default()) / chirp_power)
    };
    let mut shares = (0..1000)
        .map(share)
        .collect::<Result<Vec<f64>, ExperimentError>>()?;
    shares.sort_by(f64::total_cmp);
    Ok(shares)
}
