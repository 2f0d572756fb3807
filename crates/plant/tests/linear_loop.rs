//! The linear closed loop: FRFs and poles against the simulation of the same loop.

use std::f64::consts::TAU;
use std::sync::Arc;

use frfid_plant::{
    Controller, FilteredPi, Hold, LoopFrf, PiController, PlantError, Robot, Sensor, SimulatedRobot,
    SingleJoint, TorqueLowPass, TorqueNotch, check_stability, loop_poles,
};
use frfid_signals::{Run, RunId, RunKind, SignalError, Testbed};
use ndarray::Array2;
use num_complex::Complex64;

const T: f64 = 1e-3;
/// Samples of a period: lines at whole Hz.
const PERIOD: usize = 1000;
const N_PERIODS: usize = 8;

fn controller() -> PiController {
    PiController::new(vec![2500.0], vec![20_000.0])
}

fn joint() -> SingleJoint {
    {
        let mut robot = SingleJoint::default();
        robot.joint.damping_nms_per_rad = 800.0;
        robot.joint.friction.viscous_nms_per_rad = 30.0;
        robot
    }
}

fn run(reference: Array2<f64>) -> Run {
    let id = RunId {
        kind: RunKind::Excitation,
        realization: 0,
        experiment: 0,
        repetition: 0,
    };
    Run {
        id,
        sample_time_s: T,
        reference,
        velocity_rad_s: vec![0.0],
        start_rad: vec![0.0],
    }
}

/// DFT of the last period at one line.
fn dft(x: &Array2<f64>, line: usize) -> Complex64 {
    let last = x.ncols() - PERIOD;
    let turn = |n: usize| Complex64::cis(-TAU * (n * line % PERIOD) as f64 / PERIOD as f64);
    (0..PERIOD).map(|n| x[[0, last + n]] * turn(n)).sum()
}

/// The controller, or the same with a notch and a low-pass.
fn controller_of(pi: PiController, is_filtered: bool) -> Arc<dyn Controller> {
    if !is_filtered {
        return Arc::new(pi);
    }
    Arc::new(FilteredPi {
        pi,
        low_pass: Some(TorqueLowPass {
            corner_hz: vec![180.0],
            damping: None,
        }),
        notch: Some(TorqueNotch {
            frequency_hz: vec![40.0],
            width_hz: vec![10.0],
            gain: Some(vec![0.3]),
        }),
    })
}

#[test]
fn a_steady_period_of_the_loop_has_its_analytic_frfs() {
    let lines: Vec<usize> = (1..120).step_by(7).chain([251, 409]).collect();
    let hz: Vec<f64> = lines.iter().map(|&line| line as f64).collect();
    let sine = |n: usize, line: usize| {
        (TAU * (n * line % PERIOD) as f64 / PERIOD as f64 + (line * line) as f64).sin()
    };
    let multisine = |n: usize| 0.01 * lines.iter().map(|&line| sine(n, line)).sum::<f64>();
    let reference = Array2::from_shape_fn((1, N_PERIODS * PERIOD), |(_, n)| multisine(n));
    for case in 0..48 {
        let pi = PiController {
            delay_samples: case % 3,
            position_gain_per_s: (case / 3 % 2 == 1).then(|| vec![5.0]),
            ..controller()
        };
        let controller = controller_of(pi, case / 24 == 1);
        let sensor = Sensor {
            velocity_by_differencing: [false, true][case / 6 % 2],
            velocity_filter_hz: (case / 12 % 2 == 1).then_some(200.0),
            ..Sensor::default()
        };
        let truth = LoopFrf::new(&joint(), &*controller, T, &[sensor], &hz).expect("sound");
        check_stability(&joint(), &*controller, T, &[sensor]).expect("stable");
        let described = format!("{controller:?}, {sensor:?}");
        // half the usual step: differences at 409 Hz are small, and RK4 errs by 1.3e-9 of them with
        // the usual one
        let (sensors, max_step_s) = (vec![sensor], Some(5e-5));
        let testbed = SimulatedRobot {
            sensors,
            max_step_s,
            ..SimulatedRobot::closed_loop(Arc::new(joint()), controller, T)
        };
        let record = testbed.run(&run(reference.clone())).expect("sound");
        for (what, output, input, truth) in [
            ("r to u", &record.u, &reference, &truth.reference_to_torque),
            (
                "r to y",
                &record.y,
                &reference,
                &truth.reference_to_velocity,
            ),
            ("u to y", &record.y, &record.u, &truth.plant),
        ] {
            for (&line, truth) in lines.iter().zip(&truth.response) {
                let error = (dft(output, line) / dft(input, line) / truth - 1.0).norm();
                assert!(
                    error < 1e-9,
                    "{what} at {line} Hz: {error:e} with {described}"
                );
            }
        }
    }
}

#[test]
fn without_a_position_loop_the_sensitivity_is_what_is_left_of_the_reference() {
    let hz = [0.5, 3.0, 11.0, 60.0];
    let LoopFrf {
        sensitivity,
        reference_to_velocity,
        plant,
        ..
    } = LoopFrf::new(&joint(), &controller(), T, &[Sensor::default()], &hz).expect("sound");
    for line in 0..hz.len() {
        let left = 1.0 - reference_to_velocity.response[[line, 0, 0]];
        assert!((sensitivity.response[[line, 0, 0]] - left).norm() < 1e-12);
    }
    assert_eq!(plant, joint().frf(&hz, Hold::Zoh, T).expect("sound"));
}

/// Growth per sample of the loop's motion, measured over the samples from `from` on.
fn growth(controller: &Arc<dyn Controller>, sensors: &[Sensor], [from, to]: [usize; 2]) -> f64 {
    let kick = Array2::from_shape_fn((1, to + 200), |(_, n)| f64::from(u8::from(n < 5)));
    let testbed = SimulatedRobot {
        sensors: sensors.to_vec(),
        ..SimulatedRobot::closed_loop(Arc::new(joint()), Arc::clone(controller), T)
    };
    let y = testbed.run(&run(kick)).expect("numbers").y;
    let peak = |from: usize| {
        (from..from + 200)
            .map(|n| y[[0, n]].abs())
            .fold(0.0, f64::max)
    };
    (peak(to) / peak(from)).powf(1.0 / (to - from) as f64)
}

#[test]
fn a_loop_grows_in_simulation_as_its_poles_say() {
    let sensors = [Sensor {
        velocity_by_differencing: true,
        velocity_filter_hz: Some(200.0),
        ..Sensor::default()
    }];
    let mut verdicts = Vec::new();
    let gains = [5000.0, 10_000.0, 15_000.0, 20_000.0];
    for (gain, is_filtered) in gains
        .into_iter()
        .flat_map(|gain| [(gain, false), (gain, true)])
    {
        let pi = PiController {
            gain_nms_per_rad: vec![gain],
            delay_samples: 2,
            position_gain_per_s: Some(vec![5.0]),
            ..controller()
        };
        let controller = controller_of(pi, is_filtered);
        let radius = loop_poles(&joint(), &*controller, T, &sensors).expect("sound")[0].norm();
        let verdict = check_stability(&joint(), &*controller, T, &sensors);
        verdicts.push(verdict.is_ok());
        assert_eq!(verdict.is_ok(), radius < 1.0);
        if let Err(error) = verdict {
            let PlantError::Unstable {
                spectral_radius,
                hz,
                channel,
                gain_nms_per_rad,
            } = error
            else {
                panic!("{error}")
            };
            assert_eq!(
                (spectral_radius, channel, gain_nms_per_rad),
                (radius, 0, gain)
            );
            assert!((10.0..250.0).contains(&hz), "{hz}");
        }
        let grown = growth(&controller, &sensors, [2000, 6000]);
        assert!(
            (grown - radius).abs() < 1e-3,
            "gain {gain}: {grown} in simulation, {radius} by the poles"
        );
    }
    assert!(
        verdicts.contains(&true) && verdicts.contains(&false),
        "{verdicts:?}"
    );
}

#[test]
fn velocity_control_leaves_the_position_free_and_is_stable() {
    for sensors in [
        [Sensor::default()],
        [Sensor {
            velocity_by_differencing: true,
            ..Sensor::default()
        }],
    ] {
        let poles = loop_poles(&joint(), &controller(), T, &sensors).expect("sound");
        assert!(
            (poles[0] - 1.0).norm() < 1e-9 && poles[1].norm() < 1.0 - 1e-4,
            "{poles:?}"
        );
        check_stability(&joint(), &controller(), T, &sensors).expect("stable");
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let frf = |controller: &PiController, sensors: &[Sensor], hz| {
        LoopFrf::new(&joint(), controller, T, sensors, &[hz])
    };
    let sensors = [Sensor::default()];
    for hz in [0.0, -1.0, 500.0, 1000.0, f64::NAN] {
        assert!(
            frf(&controller(), &sensors, hz)
                .expect_err("out of range")
                .to_string()
                .starts_with("hz is")
        );
    }
    assert!(
        frf(&controller(), &[], 1.0)
            .expect_err("no sensor")
            .to_string()
            .starts_with("sensors has shape")
    );
    let two = PiController {
        gain_nms_per_rad: vec![1.0; 2],
        ..controller()
    };
    let gains = SignalError::Shape {
        name: "gain_nms_per_rad",
        found: vec![2],
        needed: "(1)".to_owned(),
    };
    assert_eq!(frf(&two, &sensors, 1.0), Err(gains.clone()));
    assert_eq!(loop_poles(&joint(), &two, T, &sensors), Err(gains));
    let huge = PiController {
        gain_nms_per_rad: vec![f64::MAX],
        ..controller()
    };
    assert!(matches!(
        loop_poles(&joint(), &huge, T, &sensors),
        Err(SignalError::Parameter {
            key: "sample_time_s",
            ..
        })
    ));
    assert!(matches!(
        check_stability(&joint(), &huge, T, &sensors),
        Err(PlantError::Signal(SignalError::Parameter {
            key: "sample_time_s",
            ..
        }))
    ));
}
