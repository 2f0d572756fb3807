//! Motion of a robot, whatever moves and on however many axes: what testbeds deal with, sample by
//! sample.

pub(crate) mod equations;
pub(crate) mod event_location;
pub(crate) mod exact;
pub(crate) mod fleet;
pub(crate) mod formula;
mod in_lanes;
pub(crate) mod integrator;
pub(crate) mod links;
pub(crate) mod mechanics;
mod modes;
pub(crate) mod root;
pub(crate) mod segment;
pub(crate) mod side_by_side;
#[cfg(test)]
mod tests;
pub(crate) mod trajectory;

use std::any::Any;
use std::array::from_fn;

use frfid_signals::checks::channels;

use crate::error::PlantError;
use crate::motion::equations::State;
use crate::motion::fleet::Fleet;
use crate::motion::formula::Formula;
use crate::motion::integrator::Integrator;
use crate::motion::links::Links;
use crate::motion::segment::Segment;

/// The motor torques in N m from one sample to the next, one for each axis.
#[derive(Clone, Copy)]
pub enum Acting<'a> {
    /// They stay as they are.
    Held(&'a [f64]),
    /// A straight line from the first to the second.
    Line(&'a [f64], &'a [f64]),
    /// A smooth function of the time in s after the first of the two samples and of the axis.
    Function(&'a dyn Fn(f64, usize) -> f64),
}

/// A robot in motion. Slices hold one value for each axis, positions and torques on the joint side
/// of the gear.
pub trait Motion: Any {
    /// Moves on by `n_steps` steps of `step_s` under motor torques that may jump before the first
    /// step but not between.
    ///
    /// # Errors
    /// [`PlantError::Diverged`] if the state is no longer finite, [`PlantError::Chatter`],
    /// [`PlantError::Signal`] for torques of another number of axes.
    fn advance(&mut self, n_steps: usize, step_s: f64, torque: Acting) -> Result<(), PlantError>;

    /// Motor torques in N m that hold the present velocity against friction and against what the
    /// gears transmit.
    fn holding_nm(&self) -> Vec<f64>;

    /// Motor positions in rad.
    fn motor_position_rad(&self) -> &[f64];

    /// Motor velocities in rad/s, exactly 0 while stuck.
    fn motor_velocity_rad_s(&self) -> &[f64];

    /// Deflections of the gears in rad.
    fn deflection_rad(&self) -> &[f64];

    /// Link velocities in rad/s.
    fn link_velocity_rad_s(&self) -> &[f64];

    /// Time in s that each motor has spent stuck.
    fn stuck_s(&self) -> &[f64];

    /// Time in s since the start.
    fn time_s(&self) -> f64;

    /// A fleet of it, which others like it may join; `None` if it always moves alone.
    fn fleet(&self) -> Option<Box<dyn Fleet>> {
        None
    }
}

impl<K: Links<A>, F: Formula<K, A>, const A: usize> Motion for Integrator<K, A, F> {
    fn advance(&mut self, n_steps: usize, step_s: f64, torque: Acting) -> Result<(), PlantError> {
        self.formula.check_step(step_s)?;
        match torque {
            Acting::Held(torque) => {
                let segment = Segment::constant(channels("torque", torque)?);
                self.steps(n_steps, step_s, |_| segment)
            }
            Acting::Line(from, to) => {
                let [from, to]: [[f64; A]; 2] =
                    [channels("torque", from)?, channels("torque", to)?];
                self.steps(n_steps, step_s, |step| {
                    Segment::line(&from, &to, step, n_steps)
                })
            }
            Acting::Function(torque) => {
                F::check_function()?;
                self.steps(n_steps, step_s, |step| {
                    Segment::of(|share| {
                        let time_s = (step as f64 + share) * step_s;
                        from_fn(|axis| torque(time_s, axis))
                    })
                })
            }
        }
    }

    fn holding_nm(&self) -> Vec<f64> {
        (0..A).map(|axis| self.axis_holding_nm(axis)).collect()
    }

    fn motor_position_rad(&self) -> &[f64] {
        let State { motor_position, .. } = self.state();
        motor_position
    }

    fn motor_velocity_rad_s(&self) -> &[f64] {
        let State { motor_velocity, .. } = self.state();
        motor_velocity
    }

    fn deflection_rad(&self) -> &[f64] {
        let State { deflection, .. } = self.state();
        deflection
    }

    fn link_velocity_rad_s(&self) -> &[f64] {
        let State { link_velocity, .. } = self.state();
        link_velocity
    }

    fn stuck_s(&self) -> &[f64] {
        self.stuck()
    }

    fn time_s(&self) -> f64 {
        self.time()
    }

    fn fleet(&self) -> Option<Box<dyn Fleet>> {
        F::fleet(self)
    }
}
