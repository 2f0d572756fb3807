//! The gear's elasticity: a spring with two slopes (SK15 eq. (2)).

use frfid_signals::SignalError;
use frfid_signals::checks::positive;

/// tau_s(dq) = k1 dq within the knee b, k1 b sgn(dq) + k2 (dq - b sgn(dq)) beyond it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Stiffness k1 in N m/rad up to the knee.
    pub stiffness_nm_per_rad: f64,
    /// Stiffness k2 in N m/rad beyond it.
    pub stiffness_beyond_nm_per_rad: f64,
    /// Deflection b in rad at which the slope changes.
    pub knee_rad: f64,
}

/// The part of the spring's characteristic that the deflection is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Branch {
    /// |dq| <= b.
    Within,
    /// dq > b.
    Above,
    /// dq < -b.
    Below,
}

impl Branch {
    /// The branch that the deflection enters where it leaves this one, upwards or downwards.
    pub(crate) fn next(self, upwards: bool) -> Self {
        match self {
            Self::Within if upwards => Self::Above,
            Self::Within => Self::Below,
            Self::Above | Self::Below => Self::Within,
        }
    }
}

/// That of SK15 section 6.1, linear.
impl Default for Spring {
    fn default() -> Self {
        Self {
            stiffness_nm_per_rad: 1.5e5,
            stiffness_beyond_nm_per_rad: 1.5e5,
            knee_rad: 1e-3,
        }
    }
}

impl Spring {
    /// Checks every parameter.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] naming the first one that is not finite and above 0.
    pub fn check(&self) -> Result<(), SignalError> {
        positive("stiffness_nm_per_rad", self.stiffness_nm_per_rad)?;
        positive(
            "stiffness_beyond_nm_per_rad",
            self.stiffness_beyond_nm_per_rad,
        )?;
        positive("knee_rad", self.knee_rad)
    }

    /// The branch of a deflection.
    #[must_use]
    pub(crate) fn branch(&self, deflection_rad: f64) -> Branch {
        if self.is_linear() || deflection_rad.abs() <= self.knee_rad {
            Branch::Within
        } else if deflection_rad > 0.0 {
            Branch::Above
        } else {
            Branch::Below
        }
    }

    /// Slope in N m/rad and torque at zero deflection in N m of the straight line that a branch
    /// lies on.
    #[must_use]
    pub(crate) fn line(&self, branch: Branch) -> (f64, f64) {
        let offset = (self.stiffness_nm_per_rad - self.stiffness_beyond_nm_per_rad) * self.knee_rad;
        match branch {
            Branch::Within => (self.stiffness_nm_per_rad, 0.0),
            Branch::Above => (self.stiffness_beyond_nm_per_rad, offset),
            Branch::Below => (self.stiffness_beyond_nm_per_rad, -offset),
        }
    }

    /// The interval of deflections in rad of a branch: (lowest, highest).
    #[must_use]
    pub(crate) fn interval(&self, branch: Branch) -> (f64, f64) {
        match branch {
            Branch::Within if self.is_linear() => (f64::NEG_INFINITY, f64::INFINITY),
            Branch::Within => (-self.knee_rad, self.knee_rad),
            Branch::Above => (self.knee_rad, f64::INFINITY),
            Branch::Below => (f64::NEG_INFINITY, -self.knee_rad),
        }
    }

    /// The deflection in rad under a torque in N m.
    #[must_use]
    pub fn deflection_rad(&self, torque_nm: f64) -> f64 {
        let within_nm = torque_nm
            .abs()
            .min(self.stiffness_nm_per_rad * self.knee_rad);
        let beyond_nm = torque_nm.abs() - within_nm;
        let size =
            within_nm / self.stiffness_nm_per_rad + beyond_nm / self.stiffness_beyond_nm_per_rad;
        size.copysign(torque_nm)
    }

    /// The slope in N m/rad at which the spring rests under a torque in N m.
    pub(crate) fn slope_under(&self, torque_nm: f64) -> f64 {
        self.line(self.branch(self.deflection_rad(torque_nm))).0
    }

    /// The larger of the two slopes in N m/rad.
    pub(crate) fn stiffest_nm_per_rad(&self) -> f64 {
        self.stiffness_nm_per_rad
            .max(self.stiffness_beyond_nm_per_rad)
    }

    /// Whether the two slopes are one.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        self.stiffness_nm_per_rad == self.stiffness_beyond_nm_per_rad
    }

    /// Potential energy in J stored at a deflection.
    #[must_use]
    pub fn energy_j(&self, deflection_rad: f64) -> f64 {
        let within = deflection_rad.abs().min(self.knee_rad);
        let beyond = deflection_rad.abs() - within;
        let (k1, k2) = (self.stiffness_nm_per_rad, self.stiffness_beyond_nm_per_rad);
        0.5 * k1 * within * within + k1 * within * beyond + 0.5 * k2 * beyond * beyond
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPRING: Spring = Spring {
        stiffness_nm_per_rad: 1.5e5,
        stiffness_beyond_nm_per_rad: 2.55e5,
        knee_rad: 1e-3,
    };

    fn torque(deflection: f64) -> f64 {
        let (slope, offset) = SPRING.line(SPRING.branch(deflection));
        slope * deflection + offset
    }

    #[test]
    fn the_characteristic_is_continuous_odd_and_has_the_two_slopes() {
        assert!((torque(1e-3) - 150.0).abs() < 1e-9);
        assert!((torque(1e-3 + 1e-12) - 150.0).abs() < 1e-6);
        assert!((torque(2e-3) - (150.0 + 255.0)).abs() < 1e-9);
        assert!((torque(-2e-3) + 405.0).abs() < 1e-9);
    }

    #[test]
    fn the_deflection_under_a_torque_is_the_inverse_of_the_characteristic() {
        for deflection in [-3e-3, -1e-3, 0.0, 4e-4, 2e-3] {
            assert!((SPRING.deflection_rad(torque(deflection)) - deflection).abs() < 1e-17);
        }
    }

    #[test]
    fn the_energy_is_the_integral_of_the_torque() {
        let steps = 100_000;
        let width = -3e-3 / f64::from(steps);
        let integral: f64 = (0..steps)
            .map(|k| torque((f64::from(k) + 0.5) * width) * width)
            .sum();
        assert!((integral - SPRING.energy_j(-3e-3)).abs() < 1e-9 * integral);
    }
}
