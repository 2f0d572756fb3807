//! Every controller: what it does in time is what its linear system says, until a limit binds.

use frfid_plant::{Controller, LinearController, PiController};
use frfid_signals::random::{normal, stream};
use nalgebra::DVector;

const T: f64 = 1e-3;

fn pi(delay_samples: usize) -> PiController {
    PiController {
        gain_nms_per_rad: vec![1500.0, 400.0],
        integral_gain_nm_per_rad: vec![12_000.0, 3200.0],
        delay_samples,
        max_torque_nm: None,
        max_torque_rate_nm_per_s: None,
        position_gain_per_s: None,
    }
}

fn controllers() -> Vec<Box<dyn Controller>> {
    vec![Box::new(pi(0)), Box::new(pi(3))]
}

/// The linear system's torques on top of a constant one.
fn linear_torques(controller: &LinearController, errors: &[f64], holding_nm: f64) -> Vec<f64> {
    let mut state = DVector::zeros(controller.n_states());
    let asked = errors.iter().map(|&error| {
        let torque = (&controller.c * &state)[0] + controller.d * error;
        state = &controller.a * &state + &controller.b * error;
        holding_nm + torque
    });
    let on_their_way = std::iter::repeat_n(holding_nm, controller.delay_samples);
    on_their_way.chain(asked).take(errors.len()).collect()
}

#[test]
fn time_and_linear_system_are_the_same_controller() {
    for (number, controller) in controllers().iter().enumerate() {
        assert_eq!(controller.check(2, T), Ok(()));
        for axis in 0..2 {
            let mut rng = stream(7, "errors", &[number as u64, axis as u64]);
            let errors: Vec<f64> = (0..3000).map(|_| 0.1 * normal(&mut rng)).collect();
            let mut at_work = controller.axis(axis, T, 35.0);
            let linear = linear_torques(&controller.linear(axis, T), &errors, 35.0);
            for (error, expected) in errors.iter().zip(linear) {
                let found = at_work.step(*error);
                assert!(
                    (found.torque_nm - expected).abs() < 1e-9 && found.reached.is_none(),
                    "controller {number}, axis {axis}: {} for {expected} N m",
                    found.torque_nm
                );
            }
        }
    }
}
