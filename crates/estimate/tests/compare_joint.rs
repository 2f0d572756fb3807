//! Comparison of FRFs of the paper's joint without noise: what moved, what is damped, and why.

mod machines;

use frfid_estimate::{
    Agreement, CompareOptions, DampingMarks, EstimateError, FeatureKind, Side, UnknownAgreement,
    Verdict, compare, find_features,
};
use frfid_signals::{Frf, log_spaced};
use machines::Arm;
use ndarray::Array3;
use num_complex::Complex64;

/// The paper's joint with another stiffness, and a friction that acts like a damper on the motor.
fn joint(stiffness: f64, friction: f64, points: usize) -> Frf {
    let arm = Arm {
        stiffness: vec![stiffness],
        ..Arm::joint()
    };
    let hz = log_spaced(1.0, 60.0, points).expect("a band");
    let mut frf = arm.frf(&hz);
    frf.response
        .mapv_inplace(|plant| plant / (1.0 + plant * friction));
    frf
}

fn verdict_of(a: &Frf, b: &Frf, stronger: Option<Side>) -> Option<Verdict> {
    let options = CompareOptions {
        stronger,
        ..CompareOptions::default()
    };
    let found = compare(a, b, &options).expect("same band");
    found.judgement.map(|judgement| judgement.verdict)
}

#[test]
fn notch_and_peak_of_the_joint_are_the_tabled_ones() {
    // METHOD table: notch 5.0289 Hz, -95.0507 dB; peak 11.6211 Hz, -55.6669 dB
    for (points, slack_hz, slack_db) in [(2000, 1e-3, 1e-3), (150, 0.03, 0.2)] {
        let found = find_features(&joint(1.5e5, 0.0, points), 0, 0, 3.0);
        assert_eq!(found.len(), 2, "{found:?}");
        for (feature, kind, hz, db) in [
            (found[0], FeatureKind::Antiresonance, 5.0289, -95.0507),
            (found[1], FeatureKind::Resonance, 11.6211, -55.6669),
        ] {
            assert_eq!(feature.kind, kind);
            assert!((feature.frequency_hz - hz).abs() < slack_hz, "{feature:?}");
            assert!((feature.magnitude_db - db).abs() < slack_db, "{feature:?}");
            assert_eq!(
                (feature.frequency_std_hz, feature.damping_std),
                (None, None)
            );
        }
    }
}

/// zeta = d/2 sqrt(1/(k J)) with J the arm for the notch and both in series for the peak: 0.0422 and
/// 0.0974 - the half-power rule is exact only for small damping.
#[test]
fn damping_follows_from_the_half_power_bandwidth() {
    let found = find_features(&joint(1.5e5, 0.0, 2000), 0, 0, 3.0);
    let zeta = |inertia: f64| 0.5 * 400.0 / (1.5e5 * inertia).sqrt();
    let series: f64 = 35.0 * 150.0 / 185.0;
    for (feature, expected) in [(found[0], zeta(150.0)), (found[1], zeta(series))] {
        let damping = feature.damping.expect("falls by 3 dB on both sides");
        assert!(
            (damping / expected - 1.0).abs() < 0.15,
            "{damping} for {expected}"
        );
    }
}

#[test]
fn short_and_flat_curves_have_no_features() {
    for points in [1, 2, 3, 10] {
        let hz = (1..=points).map(f64::from).collect();
        let ones = Array3::from_elem((points as usize, 1, 1), Complex64::from(1.0));
        let flat = Frf::new(hz, ones).expect("shapes agree");
        assert_eq!(find_features(&flat, 0, 0, 0.0), []);
    }
}

#[test]
fn notch_and_peak_above_with_the_stronger_excitation_mean_growing_stiffness() {
    let (soft, stiff) = (joint(1.5e5, 0.0, 76), joint(2.3e5, 0.0, 150));
    for (a, b, side) in [(&soft, &stiff, Side::B), (&stiff, &soft, Side::A)] {
        let found = verdict_of(a, b, Some(side));
        let Some(Verdict::StiffnessGrowsWithDeflection { weaker, stronger }) = found else {
            panic!("{found:?}")
        };
        assert!((weaker.hz - 11.62).abs() < 0.15 && (stronger.hz - 14.39).abs() < 0.15);
        assert_eq!(weaker.std_hz, None);
    }
    let falls = verdict_of(&stiff, &soft, Some(Side::B));
    assert!(
        matches!(falls, Some(Verdict::StiffnessFallsWithDeflection { .. })),
        "{falls:?}"
    );
    let unknown = verdict_of(&soft, &stiff, None);
    assert!(
        matches!(unknown, Some(Verdict::StiffnessDiffers { .. })),
        "{unknown:?}"
    );
}

#[test]
fn another_payload_and_another_motor_are_no_stiffness() {
    let hz = log_spaced(1.0, 60.0, 150).expect("a band");
    let joint = Arm::joint();
    let (mut loaded, mut motor) = (joint.clone(), joint.clone());
    loaded.payload *= 2.0;
    motor.motor[0] *= 1.3;
    let said = |arm: &Arm| verdict_of(&joint.frf(&hz), &arm.frf(&hz), Some(Side::B));
    let (loaded, motor) = (said(&loaded), said(&motor));
    let Some(Verdict::PayloadOrPose {
        notch_percent,
        peak_percent,
    }) = loaded
    else {
        panic!("{loaded:?}")
    };
    // sqrt(1/2); sqrt((1/35 + 1/300) / (1/35 + 1/150))
    assert!((notch_percent + 29.3).abs() < 0.5 && (peak_percent + 4.9).abs() < 0.5);
    assert!(
        matches!(motor, Some(Verdict::MotorInertia { .. })),
        "{motor:?}"
    );
    assert!(motor.is_some_and(|said| said.to_string().starts_with("another inertia of the motor")));
}

#[test]
fn a_damped_resonance_with_pushed_phase_means_damping_and_friction_if_the_weaker_has_it() {
    let (clean, rough) = (joint(1.5e5, 0.0, 150), joint(1.5e5, 300.0, 150));
    for (a, b, side, other) in [
        (&clean, &rough, Side::B, Side::A),
        (&rough, &clean, Side::A, Side::B),
    ] {
        let is_it = |marks: DampingMarks| marks.side == side && marks.resonance_down_db > 3.0;
        let unknown = verdict_of(a, b, None);
        assert!(
            matches!(unknown, Some(Verdict::DampingDiffers(marks)) if is_it(marks)),
            "{unknown:?}"
        );
        let of_stronger = verdict_of(a, b, Some(side));
        assert!(
            matches!(of_stronger, Some(Verdict::DampingDiffers(_))),
            "{of_stronger:?}"
        );
        let of_weaker = verdict_of(a, b, Some(other));
        assert!(
            matches!(of_weaker, Some(Verdict::FrictionIn(marks)) if is_it(marks)),
            "{of_weaker:?}"
        );
    }
    let said = verdict_of(&clean, &rough, Some(Side::A)).map(|verdict| verdict.to_string());
    assert!(said.is_some_and(|said| said.starts_with("friction in B: its resonance is")));
}

#[test]
fn the_same_machine_on_two_grids_gives_no_verdict() {
    let (coarse, fine) = (joint(1.5e5, 0.0, 76), joint(1.5e5, 0.0, 500));
    let options = CompareOptions {
        stronger: Some(Side::A),
        ..CompareOptions::default()
    };
    let found = compare(&coarse, &fine, &options).expect("same band");
    assert_eq!(found.judgement, None);
    let reason = UnknownAgreement::NoCovariance;
    assert_eq!(found.agreement, Agreement::Unknown { reason });
    let entry = &found.entries[0];
    assert!(entry.changes.len() == 2 && entry.only_in_b.is_empty() && entry.difference_db < 0.05);
}

/// An estimate that blurs a third of its frequency, as a sweep of 5 s over six octaves says of itself, whose
/// peak of a linear joint that sweep moved by a fifth and lowered.
#[test]
fn what_a_chirp_blurs_is_no_stiffness() {
    let truth = joint(1.5e5, 0.0, 400);
    let mut chirp = joint(1.5e5, 0.0, 400);
    chirp.relative_resolution = Some(0.33);
    let blurred = |peak_hz: f64| Frf {
        response: Array3::from_shape_fn((400, 1, 1), |(k, ..)| {
            let hz = truth.frequency_hz[k];
            let stretched =
                1.0 + (peak_hz / 11.62 - 1.0) * (-(hz / 11.62).ln().powi(2) / 0.08).exp();
            let moved = Arm::joint().frf(&[hz / stretched]);
            moved.response[[0, 0, 0]] / stretched
        }),
        ..chirp.clone()
    };
    let linear = verdict_of(&truth, &blurred(13.9), Some(Side::B));
    assert!(
        !matches!(linear, Some(Verdict::StiffnessGrowsWithDeflection { .. })),
        "{linear:?}"
    );
    let agreement = compare(&truth, &chirp, &CompareOptions::default())
        .expect("same band")
        .agreement;
    assert_eq!(
        agreement,
        Agreement::Unknown {
            reason: UnknownAgreement::Blurred
        }
    );
}

#[test]
fn frfs_that_cannot_be_compared_are_refused() {
    let (a, mut b) = (joint(1.5e5, 0.0, 50), joint(1.5e5, 0.0, 50));
    let wide = Frf::new(vec![1.0], Array3::zeros((1, 2, 1))).expect("shapes agree");
    let compared = |b: &Frf| compare(&a, b, &CompareOptions::default());
    assert!(matches!(compared(&wide), Err(EstimateError::Signal(_))));
    b.frequency_hz.iter_mut().for_each(|hz| *hz += 100.0);
    assert!(matches!(
        compared(&b),
        Err(EstimateError::NoCommonBand { found: 0, .. })
    ));
}
