//! Several realizations side by side: the lanes that batching will use.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::joint::flexible_joint::{Mode, Regime};
use crate::joint::friction::Slip;
use crate::joint::ripple::Ripple;
use crate::joint::spring::Branch;
use crate::motion::equations::State;
use crate::scalar::Scalar;
use crate::single_joint::SingleJoint;

/// Four realizations side by side.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Four([f64; 4]);

impl Add for Four {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(from_fn(|lane| self.0[lane] + other.0[lane]))
    }
}

impl Sub for Four {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(from_fn(|lane| self.0[lane] - other.0[lane]))
    }
}

impl Mul for Four {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(from_fn(|lane| self.0[lane] * other.0[lane]))
    }
}

impl Div for Four {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self(from_fn(|lane| self.0[lane] / other.0[lane]))
    }
}

impl Neg for Four {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(Neg::neg))
    }
}

impl Scalar for Four {
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }
    fn sin(self) -> Self {
        Self(self.0.map(f64::sin))
    }
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), Self(self.0.map(f64::cos)))
    }
}

#[test]
fn lanes_in_different_modes_step_together_as_they_would_alone() {
    let ripple = vec![Ripple {
        cycles_per_turn: 12.0,
        amplitude_nm: 3.0,
        phase_rad: 0.1,
    }];
    let mut joint = SingleJoint::default();
    joint.joint.friction.coulomb_nm = 50.0;
    joint.joint.spring.stiffness_beyond_nm_per_rad = 2.55e5;
    joint.joint.ripple = ripple;
    let machine = joint.machine();
    let modes = [
        (Slip::Stuck, Branch::Within),
        (Slip::Forward, Branch::Above),
        (Slip::Backward, Branch::Below),
        (Slip::Forward, Branch::Within),
    ];
    let regimes = modes.map(|(slip, branch)| machine.joints[0].regime(Mode { slip, branch }));
    let velocities = [0.0, 0.1, -0.2, 0.3];
    let states = velocities.map(|v| State {
        motor_position: [v],
        deflection: [2e-3 * v],
        motor_velocity: [v],
        link_velocity: [0.5 * v],
    });
    let (torques, steps) = ([10.0, 60.0, -70.0, 150.0], [1e-4, 3e-5, 0.0, 7e-5]);
    let alone: [State<f64, 1>; 4] = from_fn(|lane| {
        let (regime, torque, x) = ([regimes[lane]], [torques[lane]], &states[lane]);
        machine.rk4(
            &regime,
            [&torque; 2],
            x,
            &machine.derivative(&regime, &torque, x),
            steps[lane],
        )
    });
    let four = |f: &dyn Fn(usize) -> f64| Four(from_fn(f));
    let regime = [Regime {
        mobility: four(&|lane| regimes[lane].mobility),
        coulomb_nm: four(&|lane| regimes[lane].coulomb_nm),
        slope_nm_per_rad: four(&|lane| regimes[lane].slope_nm_per_rad),
        offset_nm: four(&|lane| regimes[lane].offset_nm),
    }];
    let side_by_side = |states: &[State<f64, 1>; 4]| State {
        motor_position: [four(&|lane| states[lane].motor_position[0])],
        deflection: [four(&|lane| states[lane].deflection[0])],
        motor_velocity: [four(&|lane| states[lane].motor_velocity[0])],
        link_velocity: [four(&|lane| states[lane].link_velocity[0])],
    };
    let (x, torque) = (side_by_side(&states), [Four(torques)]);
    let first = machine.derivative(&regime, &torque, &x);
    assert_eq!(
        machine.rk4(&regime, [&torque; 2], &x, &first, Four(steps)),
        side_by_side(&alone)
    );
}
