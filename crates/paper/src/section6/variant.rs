//! Variants of the paper's single joint: friction, stiffening and constant velocity.

use frfid_experiment::{ConstantVelocityTable, Experiment, ExperimentError, Progress, Template};
use frfid_plant::Hold;
use frfid_signals::{Frf, Limit};

use crate::against_truth::Measured;

/// A constant velocity that the 150 N m excitations cannot turn round.
pub(crate) const FAST_RAD_S: f64 = 0.25;
/// One that they do turn round.
pub(crate) const SLOW_RAD_S: f64 = 0.011;

/// A variant of the paper's joint and of the way it is excited.
#[derive(Clone, Copy)]
pub(crate) struct Variant {
    coulomb_nm: f64,
    stiffness_beyond_nm_per_rad: f64,
    velocity_rad_s: f64,
}

/// No friction, k2 = k1, at rest.
pub(crate) const LINEAR: Variant = Variant {
    coulomb_nm: 0.0,
    stiffness_beyond_nm_per_rad: 1.5e5,
    velocity_rad_s: 0.0,
};

/// With the Coulomb friction of figure 4.
pub(crate) const FRICTION: Variant = Variant {
    coulomb_nm: 50.0,
    ..LINEAR
};

/// With the stiffness beyond the knee of figure 5, 1.7 k1.
pub(crate) const STIFFENING: Variant = Variant {
    stiffness_beyond_nm_per_rad: 2.55e5,
    ..LINEAR
};

impl Variant {
    /// The same joint, excited on a constant velocity.
    pub(crate) fn gliding_at(self, velocity_rad_s: f64) -> Self {
        Self {
            velocity_rad_s,
            ..self
        }
    }

    /// The experiment of the template `kind` on this joint.
    pub(crate) fn experiment(self, kind: &str) -> Result<Experiment, ExperimentError> {
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
                config.limits.given.remove(Limit::Torque);
            }
        });
        Ok(experiment?)
    }

    /// The exact FRF of this joint without its nonlinearities.
    pub(crate) fn truth(self, frequency_hz: &[f64]) -> Result<Frf, ExperimentError> {
        let experiment = self.experiment("chirp")?;
        experiment.truth(frequency_hz, Hold::Zoh, false)
    }

    /// The FRF that the experiment of the template `kind` finds, beside the truth.
    pub(crate) fn measure(
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
