//! Every controller: what it does in time is what its linear system says, until a limit binds.

use frfid_plant::{
    Controller, FilteredPi, LinearController, PiController, TorqueLowPass, TorqueNotch,
};
use frfid_signals::SignalError;
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

fn filtered(delay_samples: usize) -> FilteredPi {
    FilteredPi {
        pi: pi(delay_samples),
        low_pass: Some(TorqueLowPass {
            corner_hz: vec![200.0, 120.0],
            damping: None,
        }),
        notch: Some(TorqueNotch {
            frequency_hz: vec![19.0, 42.0],
            width_hz: vec![4.0, 9.0],
            gain: Some(vec![0.1, 0.4]),
        }),
    }
}

fn controllers() -> Vec<Box<dyn Controller>> {
    let (without_notch, without_low_pass) = (filtered(0), filtered(1));
    vec![
        Box::new(pi(0)),
        Box::new(pi(3)),
        Box::new(filtered(0)),
        Box::new(filtered(2)),
        Box::new(FilteredPi {
            notch: None,
            ..without_notch
        }),
        Box::new(FilteredPi {
            low_pass: None,
            ..without_low_pass
        }),
    ]
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

#[test]
fn filtered_torques_keep_their_limits_and_let_go_of_them() {
    let mut controller = filtered(0);
    controller.pi.max_torque_nm = Some(vec![50.0, 10.0]);
    let mut axis = controller.axis(0, T, 0.0);
    let pushed: Vec<f64> = (0..2000).map(|_| axis.step(1.0).torque_nm).collect();
    assert!(pushed.iter().all(|torque| torque.abs() <= 50.0));
    assert_eq!(pushed[1999], 50.0);
    // an integral that had gone on would hold the limit for hours; the filters' memory fades
    let freed = (0..400).map(|_| axis.step(-1e-4).torque_nm);
    assert!(freed.last().is_some_and(|torque| torque.abs() < 2.0));
}

#[test]
fn filters_out_of_range_are_named_with_their_table() {
    let refused = |spoil: &dyn Fn(&mut FilteredPi)| {
        let mut controller = filtered(0);
        spoil(&mut controller);
        controller.check(2, T).expect_err("out of range")
    };
    let low_pass = |spoil: &dyn Fn(&mut TorqueLowPass)| {
        refused(&|controller| spoil(controller.low_pass.as_mut().expect("given")))
    };
    let notch = |spoil: &dyn Fn(&mut TorqueNotch)| {
        refused(&|controller| spoil(controller.notch.as_mut().expect("given")))
    };
    let all: [(SignalError, [&str; 2], &str); 7] = [
        (
            low_pass(&|filter| filter.corner_hz = vec![500.0, 1.0]),
            ["low_pass", "corner_hz"],
            "below the Nyquist frequency",
        ),
        (
            low_pass(&|filter| filter.damping = Some(vec![0.0, 1.0])),
            ["low_pass", "damping"],
            "damping is 0",
        ),
        (
            low_pass(&|filter| filter.corner_hz = vec![100.0]),
            ["low_pass", "corner_hz"],
            "has shape [1], needed (2)",
        ),
        (
            notch(&|filter| filter.frequency_hz = vec![-1.0, 1.0]),
            ["notch", "frequency_hz"],
            "frequency_hz is -1",
        ),
        (
            notch(&|filter| filter.width_hz = vec![f64::NAN, 1.0]),
            ["notch", "width_hz"],
            "width_hz is NaN",
        ),
        (
            notch(&|filter| filter.gain = Some(vec![0.0, 1.5])),
            ["notch", "gain"],
            "a notch takes out",
        ),
        (
            refused(&|controller| controller.pi.gain_nms_per_rad = vec![1.0]),
            ["pi", "gain_nms_per_rad"],
            "pi: gain_nms_per_rad has shape [1]",
        ),
    ];
    for (error, path, says) in all {
        assert_eq!(error.path(), path);
        assert!(error.to_string().contains(says), "{error}");
    }
}
