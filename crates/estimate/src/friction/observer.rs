//! Observer of a motor with friction: it follows the record, so that noise on the velocity does not decide when it
//! sticks.
//!
//! ```text
//! J v' = u - H(s) v - tau_f + J l (y - v)
//! ```
//!
//! in steps short against the sample time. A step without friction would end at v + h f / J; friction takes off
//! as much as it can, at most h F_c / J: at 0 it sticks, without ever being asked.

use nalgebra::{Matrix3, Vector2};

use crate::friction::inverse_model::InverseModel;
use crate::spectra::mean;

/// Steps of a sample.
const STEPS: usize = 10;

/// A record to follow.
pub(super) struct Observer {
    pub(super) torque_nm: Vec<f64>,
    pub(super) velocity_rad_s: Vec<f64>,
    pub(super) sample_time_s: f64,
    /// l.
    pub(super) gain_per_s: f64,
}

impl Observer {
    /// What the torque is in the mean beyond the friction.
    fn load(&self, model: &InverseModel, shape: &[f64]) -> f64 {
        mean(&self.torque_nm) - model.coulomb_nm * mean(shape)
    }

    /// The torque of the friction, mean over the time after each sample. What the torque is in the mean beyond the
    /// friction before, `shape` over F_c, holds a load.
    pub(super) fn friction(&self, model: &InverseModel, shape: &[f64]) -> Vec<f64> {
        let step_s = self.sample_time_s / STEPS as f64;
        let transmitted = Transmitted::of(model, step_s);
        let half = 0.5 * step_s * transmitted.of_velocity;
        let mobility = step_s / (model.inertia + half);
        let kept = (model.inertia - half) / (model.inertia + half);
        let pull = 1.0 - (-self.gain_per_s * self.sample_time_s).exp();
        let load = self.load(model, shape);
        let (mut v, mut state) = (0.0, Vector2::zeros());
        let pairs = self.torque_nm.iter().zip(&self.velocity_rad_s);
        let friction = pairs.map(|(u, y)| {
            v += pull * (y - v);
            let mut sum = 0.0;
            for _ in 0..STEPS {
                let free = kept * v + mobility * (u - load - transmitted.of_state.dot(&state));
                let torque = (free / mobility).clamp(-model.coulomb_nm, model.coulomb_nm);
                let next = free - mobility * torque;
                state = transmitted.moved(state, next);
                v = next;
                sum += torque;
            }
            sum / STEPS as f64
        });
        friction.collect()
    }
}

/// H as a system of two states, in steps of constant velocity.
struct Transmitted {
    step: Matrix3<f64>,
    of_state: Vector2<f64>,
    of_velocity: f64,
}

impl Transmitted {
    /// `H = (n_0 + n_1 s + n_2 s^2) / (1 + d_1 s + d_2 s^2)` in controllable form.
    fn of(model: &InverseModel, step_s: f64) -> Self {
        let ([n0, n1, n2], [d1, d2]) = (model.numerator, model.denominator);
        #[rustfmt::skip]
        let rates = Matrix3::new(
            0.0, 1.0, 0.0,
            -1.0 / d2, -d1 / d2, 1.0 / d2,
            0.0, 0.0, 0.0,
        );
        let of_velocity = n2 / d2;
        Self {
            step: (rates * step_s).exp(),
            of_state: Vector2::new(n0 - of_velocity, n1 - of_velocity * d1),
            of_velocity,
        }
    }

    fn moved(&self, state: Vector2<f64>, v: f64) -> Vector2<f64> {
        let moved = self.step * state.push(v);
        Vector2::new(moved[0], moved[1])
    }
}
