//! Beginning of the shaping that a description asks for (SK15 section 5.3): from the reference of
//! its `[chirp]` towards what its `[shape]` desires, inside its limits.

use frfid_estimate::{EstimateError, ShapeError, ShapeOptions, Shaper, Target};
use frfid_plant::Sensor;
use frfid_signals::{Amplitude, Chirp, Excitation, Limit, Plan, Profile, RunId};
use ndarray::{Array3, Axis};

use crate::description::fault::check_entries;
use crate::description::shape::ShapeTable;
use crate::description::text::ConfigError;
use crate::error::ExperimentError;
use crate::experiment::Experiment;

/// Multiple of the noise on a velocity reading below which the motor may be standing.
const STILL: f64 = 3.0;

impl Experiment {
    /// The shaper at its beginning, with its options: the reference of `[chirp]` is its first, what
    /// `[shape]` desires is the same chirp with other amplitudes.
    ///
    /// # Errors
    /// [`ExperimentError::Config`] with the place of what is missing or does not fit: no chirp, no
    /// controller, no table `[shape]`, a desired torque or an initial reference beyond its limit.
    pub fn shaper(&self) -> Result<(Shaper, ShapeOptions), ExperimentError> {
        let (chirp, table) = self.shaped()?;
        let (target, _) = self.desired(table)?;
        let options = self.shape_options(chirp, table, target);
        let (desired, initial) = (self.desired_signal()?, experiments(&self.plan)?);
        let shaper = Shaper::new(desired, initial, options.clone());
        Ok((shaper.map_err(|error| self.at_its_place(error))?, options))
    }

    /// An error of the shaper at the place of what it complains about.
    fn at_its_place(&self, error: ShapeError) -> ExperimentError {
        match error {
            ShapeError::StartTooLarge { .. } => {
                let key = &["chirp", "amplitude_rad_s"];
                self.text.error(key, error.to_string()).into()
            }
            ShapeError::Estimate(EstimateError::Signal(error)) => {
                self.text.locate(&["shape"], error).into()
            }
            error => error.into(),
        }
    }

    /// What the target shall be, `(experiment, channel, sample)`: the chirp with the amplitudes
    /// that `[shape]` desires.
    ///
    /// # Errors
    /// As [`Experiment::shaper`].
    pub fn desired_signal(&self) -> Result<Array3<f64>, ExperimentError> {
        let (chirp, table) = self.shaped()?;
        let (_, amplitude) = self.desired(table)?;
        let desired = Chirp {
            amplitude,
            ..chirp.clone()
        };
        experiments(&Plan {
            excitation: Excitation::Chirp(desired),
            ..self.plan.clone()
        })
    }

    /// The chirp and its table, once everything stands that shaping needs.
    pub(crate) fn shaped(&self) -> Result<(&Chirp, &ShapeTable), ConfigError> {
        let refused = |path: &[&str], message: &str| Err(self.text.error(path, message));
        let Excitation::Chirp(chirp) = &self.plan.excitation else {
            return refused(
                &["multisine"],
                "a chirp is shaped: give a table [chirp] instead of [multisine]",
            );
        };
        let Some(table) = &self.config.shape else {
            let message = "no [shape]: add this table with desired_nm, the motor torque that the chirp shall lead to on each axis";
            return refused(&["chirp"], message);
        };
        if self.config.controller.is_none() {
            let message = "shaping is for closed loops: add a table [controller] with its gains, and give the initial reference \
                           [chirp].amplitude_rad_s";
            return refused(&["shape"], message);
        }
        if self.config.constant_velocity.is_some() {
            return refused(
                &["constant_velocity"],
                "a chirp is shaped from rest: leave [constant_velocity] out",
            );
        }
        if self.plan.n_repetitions != 1 {
            return refused(
                &["averaging", "repetitions"],
                "shaping does each run of an iteration once: leave repetitions at 1",
            );
        }
        Ok((chirp, table))
    }

    /// Which signal is to follow, and its amplitude on each axis.
    fn desired(&self, table: &ShapeTable) -> Result<(Target, Vec<Profile>), ConfigError> {
        let (target, key, amplitude) = table.desired().ok_or_else(|| {
            let message =
                "give the desired torque (desired_nm) or velocity (desired_rad_s), one of the two";
            self.text.error(&["shape"], message)
        })?;
        let profiles: Vec<Profile> = amplitude.iter().map(Amplitude::profile).collect();
        self.check_desired(key, &profiles)
            .and_then(|()| self.check_inside_limits(target, &profiles))
            .map_err(|message| self.text.error(&["shape", key], message))?;
        Ok((target, profiles))
    }

    /// Refuses amplitudes that are not one for each axis, of which one is not sound or nothing.
    fn check_desired(&self, key: &str, profiles: &[Profile]) -> Result<(), String> {
        check_entries(key, profiles.len(), self.plan.n_inputs, "axes")?;
        for (axis, profile) in profiles.iter().enumerate() {
            profile.check().map_err(|error| error.to_string())?;
            if profile.peak() == 0.0 {
                let axis = axis + 1;
                return Err(format!(
                    "axis {axis} desires nothing; needed: an amplitude above 0"
                ));
            }
        }
        Ok(())
    }

    /// Refuses what is desired beyond a limit.
    fn check_inside_limits(&self, target: Target, profiles: &[Profile]) -> Result<(), String> {
        let limit = match target {
            Target::Torque => Limit::Torque,
            Target::Velocity => Limit::Velocity,
        };
        for (axis, profile) in profiles.iter().enumerate() {
            let (peak, allowed) = (profile.peak(), self.limits.of(limit, axis));
            if peak > allowed {
                let (axis, unit, name) = (axis + 1, limit.unit(), limit.key());
                return Err(format!(
                    "axis {axis} desires {peak} {unit}, beyond its {name} of {allowed}; lower it"
                ));
            }
        }
        Ok(())
    }

    fn shape_options(&self, chirp: &Chirp, table: &ShapeTable, target: Target) -> ShapeOptions {
        ShapeOptions {
            target,
            step: table.step(),
            low_hz: chirp.low_hz,
            high_hz: chirp.high_hz,
            sample_time_s: self.plan.sample_time_s,
            n_iterations: table.n_iterations,
            good_enough: table.good_enough,
            largest_change: table.largest_change,
            limits: self.watch().limits,
            margin: table.margin,
            max_stuck_share: table.max_stuck_share,
            still_rad_s: self.still_rad_s(),
            coulomb_nm: self.robot.as_ref().map(|robot| robot.coulomb_nm()),
        }
    }

    /// Velocity reading in rad/s up to which a motor may be standing: a few times the noise of the
    /// noisiest sensor, 0 without noise.
    #[must_use]
    pub fn still_rad_s(&self) -> f64 {
        self.sensors
            .iter()
            .map(|sensor| STILL * velocity_noise_rad_s(sensor, self.plan.sample_time_s))
            .fold(0.0, f64::max)
    }
}

/// Rms of the noise on a velocity reading: its own, or that of the difference of two positions.
fn velocity_noise_rad_s(sensor: &Sensor, sample_time_s: f64) -> f64 {
    let own = sensor.velocity_noise_rad_s.unwrap_or(0.0);
    let position = sensor
        .position_noise_rad
        .filter(|_| sensor.velocity_by_differencing)
        .unwrap_or(0.0);
    own.hypot(2.0_f64.sqrt() * position / sample_time_s)
}

/// The references of all experiments of a plan, rest before the chirp included,
/// `(experiment, channel, sample)`.
fn experiments(plan: &Plan) -> Result<Array3<f64>, ExperimentError> {
    let mut stacked = Array3::zeros((plan.n_experiments(), plan.n_inputs, plan.run_samples()?));
    for (experiment, mut to) in stacked.axis_iter_mut(Axis(0)).enumerate() {
        let id = RunId::excitation(0, experiment, 0);
        to.assign(&plan.run(id)?.reference);
    }
    Ok(stacked)
}
