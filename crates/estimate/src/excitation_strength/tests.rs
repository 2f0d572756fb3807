//! Strength of chirps and multisines whose torque and motion are known.

use std::f64::consts::{SQRT_2, TAU};

use frfid_signals::{
    Chirp, Excitation, GridDesign, GridKind, Injection, InputKind, Multisine, Phasing, Plan,
    Profile, Record, RunId, RunKind, SignalError,
};
use ndarray::{Array2, s};

use crate::error::EstimateError;
use crate::excitation_strength::pooling::pooled_strength;
use crate::excitation_strength::strength;
use crate::excitation_strength::warnings::strength_warnings;

const BANDS_HZ: [[f64; 2]; 4] = [[0.1, 1.0], [2.0, 10.0], [10.0, 40.0], [40.0, 60.0]];

fn chirp() -> Excitation {
    let amplitude = vec![Profile {
        points: vec![(39.9, 150.0), (40.0, 75.0)],
    }];
    Excitation::Chirp(Chirp {
        low_hz: 2.0,
        high_hz: 60.0,
        duration_s: 20.0,
        amplitude,
        fade_s: 0.0,
        tail_s: 1.0,
    })
}

fn multisine() -> Excitation {
    let design = GridDesign {
        low_hz: 2.0,
        high_hz: 60.0,
        sample_time_s: 1e-3,
        resolution_hz: 1.0,
        n_lines: None,
        kind: GridKind::Odd,
        seed: 0,
    };
    let grid = design.design().expect("sound");
    Excitation::Multisine(Multisine::flat(grid, vec![100.0]))
}

fn plan(excitation: Excitation, n_periods: usize) -> Plan {
    Plan {
        seed: 1,
        sample_time_s: 1e-3,
        n_inputs: 1,
        excitation,
        phasing: Phasing::Orthogonal,
        injection: Injection::Torque,
        n_realizations: 1,
        n_repetitions: 1,
        n_periods,
        lead_in_samples: 500,
        ramp_samples: 0,
        velocity_rad_s: vec![0.0],
        n_glides: 0,
    }
}

/// The reference of the plan's first run as torque on a holding torque, and a motion at 1 rad/s.
fn record(plan: &Plan) -> Record {
    let id = RunId {
        kind: RunKind::Excitation,
        realization: 0,
        experiment: 0,
        repetition: 0,
    };
    let u = plan.run(id).expect("in the plan").reference + 300.0;
    let position = Array2::from_shape_fn(u.dim(), |(_, k)| {
        1e-3 * k as f64 + 1e-2 * (1e-2 * k as f64).sin()
    });
    Record {
        sample_time_s: 1e-3,
        y: Array2::ones(u.dim()),
        u,
        r: None,
        position_rad: Some(position),
        input_kind: InputKind::Commanded,
        events: Vec::new(),
    }
}

#[test]
fn a_chirps_torque_and_stuck_time_stand_in_the_band_it_passes() {
    let plan = plan(chirp(), 1);
    let mut record = record(&plan);
    let Excitation::Chirp(chirp) = &plan.excitation else {
        unreachable!("made above")
    };
    let from = 500 + (1000.0 * chirp.instant_of(40.0)).round() as usize;
    for k in (from..20_500).step_by(3) {
        record.position_rad.as_mut().expect("measured")[[0, k]] =
            record.position_rad.as_ref().expect("measured")[[0, k - 1]];
    }
    let axes = strength(&record, &plan, &BANDS_HZ).expect("sound");
    let bands = &axes[0].bands;
    assert_eq!(
        bands.iter().map(|band| band.low_hz).collect::<Vec<_>>(),
        [2.0, 10.0, 40.0]
    );
    for (band, amplitude, stuck) in [
        (bands[0], 150.0, 0.0),
        (bands[1], 150.0, 0.0),
        (bands[2], 75.0, 1.0 / 3.0),
    ] {
        assert!(
            (band.rms_nm * SQRT_2 / amplitude - 1.0).abs() < 0.01,
            "{band:?}"
        );
        assert!(
            (band.stuck_share.expect("a chirp") - stuck).abs() < 1e-3,
            "{band:?}"
        );
    }
    let said = strength_warnings(&axes, &["axis 2".into()], Some(&[105.0]));
    assert_eq!(
        said,
        [
            "axis 2 sticks above 40 Hz: 33 % of the time, torque 75 N m is below its friction 105 N m"
        ]
    );
}

#[test]
fn a_multisines_bands_add_up_to_its_power() {
    let plan = plan(multisine(), 2);
    let record = record(&plan);
    let axes = strength(&record, &plan, &[[1.0, 10.0], [10.0, 61.0]]).expect("sound");
    let total: f64 = axes[0].bands.iter().map(|band| band.rms_nm.powi(2)).sum();
    assert!((total.sqrt() / axes[0].rms_nm - 1.0).abs() < 1e-12);
    assert!(axes[0].bands.iter().all(|band| band.stuck_share.is_none()));
    assert_eq!(
        (axes[0].stuck_share, axes[0].crosses_zero),
        (Some(0.0), None)
    );
    let said = strength_warnings(&axes, &["a".into()], Some(&[200.0]));
    assert!(
        said.len() == 1 && said[0].contains("below its friction"),
        "{said:?}"
    );
    assert!(strength_warnings(&axes, &["a".into()], None).is_empty());
}

#[test]
fn a_velocity_that_turns_back_is_found_and_runs_are_pooled() {
    let mut plan = plan(multisine(), 1);
    plan.velocity_rad_s = vec![-0.5];
    let mut record = record(&plan);
    record.y = Array2::from_shape_fn(record.y.dim(), |(_, k)| {
        -0.5 + 0.4 * (TAU * k as f64 / 100.0).sin()
    });
    let smooth = strength(&record, &plan, &[]).expect("sound");
    assert!(smooth[0].crosses_zero == Some(false) && (smooth[0].slowest_rad_s - 0.1).abs() < 1e-9);
    record.y[[0, 700]] = 0.02;
    let turning = strength(&record, &plan, &[]).expect("sound");
    assert!(strength_warnings(&turning, &["a".into()], Some(&[1e3]))[0].contains("changes sign"));
    let pooled = pooled_strength(&[smooth.clone(), turning], Some(&[2.0 * smooth[0].rms_nm]))
        .expect("two runs");
    assert!(pooled[0].crosses_zero == Some(true) && pooled[0].slowest_rad_s == 0.02);
    assert!(
        (pooled[0].rms_nm / smooth[0].rms_nm - 1.0).abs() < 1e-12
            && pooled_strength(&[], None).is_none()
    );
}

#[test]
fn records_too_short_or_of_other_axes_are_refused() {
    let plan = plan(multisine(), 2);
    let whole = record(&plan);
    let mut cut = whole.clone();
    for signal in [
        &mut cut.u,
        &mut cut.y,
        cut.position_rad.as_mut().expect("measured"),
    ] {
        *signal = signal.slice(s![.., ..600]).to_owned();
    }
    assert!(matches!(
        strength(&cut, &plan, &[]),
        Err(EstimateError::Signal(SignalError::Shape { name: "u", .. }))
    ));
    let two = Record {
        y: Array2::ones((2, whole.n_samples())),
        ..whole
    };
    assert!(matches!(
        strength(&two, &plan, &[]),
        Err(EstimateError::Signal(SignalError::Shape { name: "y", .. }))
    ));
}

#[test]
fn what_is_not_known_is_no_warning_and_is_left_out_of_the_mean() {
    let plan = plan(multisine(), 1);
    let mut known = strength(&record(&plan), &plan, &[]).expect("sound");
    let mut unknown = known.clone();
    (known[0].stuck_share, unknown[0].stuck_share) = (Some(0.6), None);
    let names = ["a".into()];
    assert!(strength_warnings(&unknown, &names, None).is_empty());
    assert!(strength_warnings(&unknown, &names, Some(&[0.0])).is_empty());
    let said = strength_warnings(&known, &names, Some(&[0.0]));
    assert_eq!(said, ["a sticks: 60 % of the time, torque 31 N m rms"]);
    let pooled = pooled_strength(&[unknown.clone(), known], Some(&[0.0])).expect("two runs");
    assert_eq!(
        (pooled[0].stuck_share, pooled[0].rms_over_coulomb),
        (Some(0.6), None)
    );
    let pooled = pooled_strength(&[unknown.clone(), unknown], None).expect("two runs");
    assert_eq!(pooled[0].stuck_share, None);
}
