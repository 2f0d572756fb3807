//! Stability of loops around their critical gain, against the growth of the same loops stepped in
//! time by an exact map of their own.

use frfid_plant::{PiController, SingleJoint, check_stability};
use frfid_signals::random::{stream, uniform};
use nalgebra::{Matrix4, Vector3};

const T: f64 = 1e-3;
const N_SAMPLES: usize = 20_000;
const N_LOOPS: u64 = 200;

/// A joint, its integral gain and its delay, at random.
struct Case {
    joint: SingleJoint,
    integral_gain: f64,
    delay_samples: usize,
    /// Multiple of the critical gain.
    factor: f64,
}

impl Case {
    fn new(index: u64) -> Self {
        let mut rng = stream(13, "loops", &[index]);
        let mut between = |low: f64, high: f64| low * (high / low).powf(uniform(&mut rng));
        let mut joint = SingleJoint::default();
        joint.joint.motor_inertia_kg_m2 = between(0.5, 50.0);
        joint.link_inertia_kg_m2 = joint.joint.motor_inertia_kg_m2 * between(0.3, 10.0);
        let stiffness = joint.link_inertia_kg_m2 * (60.0 * between(0.3, 3.0)).powi(2);
        joint.joint.spring.stiffness_nm_per_rad = stiffness;
        joint.joint.spring.stiffness_beyond_nm_per_rad = stiffness;
        joint.joint.damping_nms_per_rad = stiffness * between(5e-4, 5e-3);
        joint.joint.friction.viscous_nms_per_rad =
            joint.joint.motor_inertia_kg_m2 * between(0.1, 1.0);
        Self {
            integral_gain: joint.joint.motor_inertia_kg_m2 * between(1.0, 100.0),
            delay_samples: (between(1.0, 4.0) - 1.0) as usize,
            factor: between(0.9, 1.1),
            joint,
        }
    }

    fn is_stable(&self, gain: f64) -> bool {
        let controller = PiController {
            delay_samples: self.delay_samples,
            ..PiController::new(vec![gain], vec![self.integral_gain])
        };
        check_stability(&self.joint, &controller, T, &[Default::default()]).is_ok()
    }

    /// The largest gain up to which the loop is stable, from a small one on.
    fn critical_gain(&self) -> Option<f64> {
        let motor = self.joint.joint.motor_inertia_kg_m2;
        let mut below = 5.0 * motor;
        let mut beyond = below;
        while self.is_stable(beyond) {
            beyond *= 1.5;
        }
        if beyond == below {
            return None;
        }
        below = beyond / 1.5;
        for _ in 0..40 {
            let middle = 0.5 * (below + beyond);
            *(if self.is_stable(middle) {
                &mut below
            } else {
                &mut beyond
            }) = middle;
        }
        Some(below)
    }

    /// The exact map of motor velocity, link velocity, deflection and torque over a sample.
    fn map(&self) -> Matrix4<f64> {
        let joint = &self.joint.joint;
        let (motor, link) = (joint.motor_inertia_kg_m2, self.joint.link_inertia_kg_m2);
        let (k, d) = (joint.spring.stiffness_nm_per_rad, joint.damping_nms_per_rad);
        let viscous = joint.friction.viscous_nms_per_rad;
        #[rustfmt::skip]
        let rates = Matrix4::new(
            -(d + viscous) / motor, d / motor, -k / motor, 1.0 / motor,
            d / link, -d / link, k / link, 0.0,
            1.0, -1.0, 0.0, 0.0,
            0.0, 0.0, 0.0, 0.0,
        );
        (rates * T).exp()
    }

    /// Logarithm of what the free motion grows by in the second half of a long run.
    fn growth(&self, gain: f64) -> f64 {
        let map = self.map();
        let mut state = Vector3::new(1.0, 0.0, 0.0);
        let (mut integral, mut sent) = (0.0, vec![0.0; self.delay_samples]);
        let (mut grown, mut halves) = (0.0, [f64::NEG_INFINITY; 2]);
        for k in 0..N_SAMPLES {
            let error = -state[0];
            sent.push(gain * error + integral);
            integral += self.integral_gain * T * error;
            let torque = sent.remove(0);
            let next = map * state.push(torque);
            state = next.xyz();
            let size = state.norm() + integral.abs() / gain;
            // kept near 1: a loop that diverges soon leaves what numbers can hold
            state /= size;
            integral /= size;
            sent.iter_mut().for_each(|torque| *torque /= size);
            grown += size.ln();
            let places = [0.4..0.5, 0.9..1.0];
            for (half, place) in halves.iter_mut().zip(places) {
                if place.contains(&(k as f64 / N_SAMPLES as f64)) {
                    *half = half.max(grown);
                }
            }
        }
        halves[1] - halves[0]
    }
}

#[test]
fn two_hundred_loops_about_their_critical_gain_are_told_apart() {
    let (mut stable, mut diverging) = (0, 0);
    for index in 0..N_LOOPS {
        let case = Case::new(index);
        let Some(critical) = case.critical_gain() else {
            continue; // its integral alone makes it diverge
        };
        let gain = case.factor * critical;
        let grows = case.growth(gain) > 0.0;
        assert_eq!(
            case.is_stable(gain),
            !grows,
            "loop {index} at {} of {critical}: grows by e^{}",
            case.factor,
            case.growth(gain)
        );
        *(if grows { &mut diverging } else { &mut stable }) += 1;
    }
    assert!(stable > 80 && diverging > 80, "{stable} and {diverging}");
}
