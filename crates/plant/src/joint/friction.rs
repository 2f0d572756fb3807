//! Friction of the motor: Coulomb's set-valued law with a viscous term (SK15 eq. (1)).

use frfid_signals::SignalError;
use frfid_signals::checks::not_negative;

/// tau_f = F_c sgn(v) + F_v v while the motor moves; at rest any torque in [-F_c, F_c], whatever
/// holds the motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Coulomb torque F_c in N m.
    pub coulomb_nm: f64,
    /// Viscous coefficient F_v in N m s/rad.
    pub viscous_nms_per_rad: f64,
}

/// What the motor does: the branch of the friction law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Slip {
    /// There is no Coulomb friction: nothing happens at zero velocity.
    Free,
    /// At rest, held by friction.
    Stuck,
    /// Motion (or about to move) at positive velocity.
    Forward,
    /// Motion (or about to move) at negative velocity.
    Backward,
}

impl Friction {
    /// Checks every parameter.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] naming the first one that is not finite and 0 or above.
    pub fn check(&self) -> Result<(), SignalError> {
        not_negative("coulomb_nm", self.coulomb_nm)?;
        not_negative("viscous_nms_per_rad", self.viscous_nms_per_rad)
    }

    /// The branch of a velocity; at rest the motor is stuck until its net torque says otherwise.
    #[must_use]
    pub(crate) fn slip(&self, velocity_rad_s: f64) -> Slip {
        if self.coulomb_nm == 0.0 {
            Slip::Free
        } else if velocity_rad_s > 0.0 {
            Slip::Forward
        } else if velocity_rad_s < 0.0 {
            Slip::Backward
        } else {
            Slip::Stuck
        }
    }

    /// The branch at zero velocity under the torque that acts on the motor besides friction.
    #[must_use]
    pub(crate) fn at_rest(&self, net_nm: f64) -> Slip {
        if self.coulomb_nm == 0.0 {
            Slip::Free
        } else if net_nm > self.coulomb_nm {
            Slip::Forward
        } else if net_nm < -self.coulomb_nm {
            Slip::Backward
        } else {
            Slip::Stuck
        }
    }

    /// Coulomb torque in N m of a branch; 0 when stuck, where the constraint v = 0 takes its place.
    #[must_use]
    pub(crate) fn coulomb(&self, slip: Slip) -> f64 {
        match slip {
            Slip::Free | Slip::Stuck => 0.0,
            Slip::Forward => self.coulomb_nm,
            Slip::Backward => -self.coulomb_nm,
        }
    }

    /// The interval in which a branch holds: of the velocity in rad/s while slipping, of the net
    /// torque in N m when stuck.
    #[must_use]
    pub(crate) fn interval(&self, slip: Slip) -> (f64, f64) {
        match slip {
            Slip::Free => (f64::NEG_INFINITY, f64::INFINITY),
            Slip::Stuck => (-self.coulomb_nm, self.coulomb_nm),
            Slip::Forward => (0.0, f64::INFINITY),
            Slip::Backward => (f64::NEG_INFINITY, 0.0),
        }
    }

    /// Torque in N m that balances friction at a constant velocity; 0 at rest.
    #[must_use]
    pub fn holding_nm(&self, velocity_rad_s: f64) -> f64 {
        self.coulomb(self.slip(velocity_rad_s)) + self.viscous_nms_per_rad * velocity_rad_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_rest_friction_holds_up_to_its_limit_and_no_further() {
        let friction = Friction {
            coulomb_nm: 50.0,
            viscous_nms_per_rad: 2.0,
        };
        assert_eq!(
            [-50.0, 0.0, 50.0].map(|net| friction.at_rest(net)),
            [Slip::Stuck; 3]
        );
        assert_eq!(
            [50.1, -50.1].map(|net| friction.at_rest(net)),
            [Slip::Forward, Slip::Backward]
        );
    }

    #[test]
    fn the_holding_torque_has_no_sign_at_rest() {
        let friction = Friction {
            coulomb_nm: 50.0,
            viscous_nms_per_rad: 2.0,
        };
        assert_eq!(
            [0.0, -0.0, 0.5, -0.5].map(|v| friction.holding_nm(v)),
            [0.0, 0.0, 51.0, -51.0]
        );
    }
}
