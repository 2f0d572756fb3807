//! Verdicts on a machine from the difference of two FRFs, with the reason.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::compare::change::{Change, Side, Sides};

/// A level difference of a resonance or antiresonance that counts, in dB.
const LEVEL_DB: f64 = 2.0;
/// A resonance that friction lowers by this much, in dB, is buried.
const BURIED_DB: f64 = 10.0;
/// A difference of phase ranges that counts, in degrees.
const PHASE_DEG: f64 = 5.0;

/// A statement about the machine and the numbers that support it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// The resonance of the stronger excitation lies above: a spring that gets stiffer as it
    /// deflects (SK15 section 6.3).
    StiffnessGrowsWithDeflection {
        /// Resonance with the weaker excitation in Hz.
        weaker_hz: f64,
        /// Resonance with the stronger excitation in Hz.
        stronger_hz: f64,
    },
    /// The resonance of the stronger excitation lies below: a spring, or a joint with play or slip,
    /// that gets softer.
    StiffnessFallsWithDeflection {
        /// Resonance with the weaker excitation in Hz.
        weaker_hz: f64,
        /// Resonance with the stronger excitation in Hz.
        stronger_hz: f64,
    },
    /// The resonance moved, and which excitation was stronger is not known.
    ResonanceMoved {
        /// Resonance in A in Hz.
        a_hz: f64,
        /// Resonance in B in Hz.
        b_hz: f64,
    },
    /// One FRF shows the marks of Coulomb friction against the other: its resonance is damped, and
    /// its antiresonance is shallower or its phase pushed together (SK15 section 6.2).
    FrictionIn {
        /// The FRF that shows them.
        side: Side,
        /// How far its resonance lies below in dB.
        resonance_down_db: f64,
        /// How much its antiresonance is filled up in dB, where there is one.
        antiresonance_up_db: Option<f64>,
        /// How much smaller its range of phase is in degrees.
        phase_range_smaller_deg: f64,
    },
}

/// As the sentence for people.
impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The sentence for people.
impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::StiffnessGrowsWithDeflection {
                weaker_hz,
                stronger_hz,
            } => write!(
                f,
                "stiffness grows with deflection: the stronger excitation finds the resonance at {stronger_hz:.2} Hz, the weaker at {weaker_hz:.2} Hz"
            ),
            Self::StiffnessFallsWithDeflection {
                weaker_hz,
                stronger_hz,
            } => write!(
                f,
                "stiffness falls with deflection: the stronger excitation finds the resonance at {stronger_hz:.2} Hz, the weaker at {weaker_hz:.2} Hz"
            ),
            Self::ResonanceMoved { a_hz, b_hz } => write!(
                f,
                "the resonance moved from {a_hz:.2} Hz to {b_hz:.2} Hz; say which excitation was stronger to learn what that means for the stiffness"
            ),
            Self::FrictionIn {
                side,
                resonance_down_db,
                antiresonance_up_db,
                phase_range_smaller_deg,
            } => write_friction(
                f,
                *side,
                *resonance_down_db,
                *antiresonance_up_db,
                *phase_range_smaller_deg,
            ),
        }
    }
}

fn write_friction(
    f: &mut fmt::Formatter<'_>,
    side: Side,
    resonance_down_db: f64,
    antiresonance_up_db: Option<f64>,
    phase_range_smaller_deg: f64,
) -> fmt::Result {
    let name = if side == Side::A { "A" } else { "B" };
    write!(
        f,
        "friction in {name}: its resonance is {resonance_down_db:.1} dB lower, "
    )?;
    if let Some(up) = antiresonance_up_db.filter(|up| *up > 0.0) {
        write!(f, "its antiresonance {up:.1} dB shallower, ")?;
    }
    if phase_range_smaller_deg > 0.0 {
        write!(
            f,
            "its phase pushed together by {phase_range_smaller_deg:.0} deg, "
        )?;
    }
    write!(f, "as by a damper")
}

/// The verdicts on one entry. Where friction buries a resonance, what is left in its place says
/// nothing about the spring.
pub(crate) fn verdicts(
    changes: &[Change],
    phase_range_deg: Sides<f64>,
    stronger: Option<Side>,
) -> Vec<Verdict> {
    let friction = friction(changes, phase_range_deg);
    let is_buried = friction.is_some_and(Verdict::buries_resonance);
    let stiffness = stiffness(changes, stronger).filter(|_| !is_buried);
    stiffness.into_iter().chain(friction).collect()
}

impl Verdict {
    fn buries_resonance(self) -> bool {
        matches!(self, Self::FrictionIn { resonance_down_db, .. } if resonance_down_db >= BURIED_DB)
    }
}

/// Judges by the most prominent resonance that moved.
fn stiffness(changes: &[Change], stronger: Option<Side>) -> Option<Verdict> {
    let (a_hz, b_hz) = moved_resonance_hz(changes)?;
    let (weaker_hz, stronger_hz) = match stronger {
        None => return Some(Verdict::ResonanceMoved { a_hz, b_hz }),
        Some(Side::A) => (b_hz, a_hz),
        Some(Side::B) => (a_hz, b_hz),
    };
    Some(if stronger_hz > weaker_hz {
        Verdict::StiffnessGrowsWithDeflection {
            weaker_hz,
            stronger_hz,
        }
    } else {
        Verdict::StiffnessFallsWithDeflection {
            weaker_hz,
            stronger_hz,
        }
    })
}

/// Frequency in A and in B of the most prominent resonance that moved.
fn moved_resonance_hz(changes: &[Change]) -> Option<(f64, f64)> {
    let resonances = changes.iter().filter(|change| change.is_resonance());
    let change = most_prominent(resonances.filter(|change| change.has_moved()))?;
    Some((change.a.frequency_hz, change.b?.frequency_hz))
}

/// Judges by the most prominent resonance and antiresonance of A.
fn friction(changes: &[Change], phase_range_deg: Sides<f64>) -> Option<Verdict> {
    let resonances = changes.iter().filter(|change| change.is_resonance());
    let antiresonances = changes.iter().filter(|change| !change.is_resonance());
    let resonance_db = most_prominent(resonances)?.level_db?;
    let antiresonance_db = most_prominent(antiresonances).and_then(|change| change.level_db);
    let (side, sign) = if resonance_db < 0.0 {
        (Side::B, 1.0)
    } else {
        (Side::A, -1.0)
    };
    let resonance_down_db = -sign * resonance_db;
    let antiresonance_up_db = antiresonance_db.map(|level| sign * level);
    let phase_range_smaller_deg = sign * (phase_range_deg.a - phase_range_deg.b);
    let second_mark = antiresonance_up_db.is_some_and(|up| up >= LEVEL_DB)
        || phase_range_smaller_deg >= PHASE_DEG;
    (resonance_down_db >= LEVEL_DB && second_mark).then_some(Verdict::FrictionIn {
        side,
        resonance_down_db,
        antiresonance_up_db,
        phase_range_smaller_deg,
    })
}

fn most_prominent<'a>(changes: impl Iterator<Item = &'a Change>) -> Option<&'a Change> {
    changes.max_by(|x, y| x.a.prominence_db.total_cmp(&y.a.prominence_db))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare;
    use crate::compare::CompareOptions;
    use crate::error::EstimateError;
    use frfid_signals::Frf;
    use ndarray::Array3;
    use num_complex::Complex64;
    use std::f64::consts::TAU;

    /// The paper's joint with another stiffness or damping, and a friction that acts like a damper
    /// on the motor.
    fn joint(stiffness: f64, friction: f64, points: usize) -> Frf {
        let (motor, arm, damping) = (35.0, 150.0, 400.0);
        let hz: Vec<f64> = (0..points)
            .map(|k| 60f64.powf(k as f64 / (points - 1) as f64))
            .collect();
        let at = |hz: f64| {
            let s = Complex64::new(0.0, TAU * hz);
            let plant = (s * s * arm + s * damping + stiffness)
                / (s * (s * s * motor * arm + (s * damping + stiffness) * (motor + arm)));
            plant / (1.0 + plant * friction)
        };
        Frf::new(
            hz.clone(),
            Array3::from_shape_fn((points, 1, 1), |(k, _, _)| at(hz[k])),
        )
        .expect("shapes agree")
    }

    fn verdicts_of(a: &Frf, b: &Frf, stronger: Option<Side>) -> Vec<Verdict> {
        let options = CompareOptions {
            stronger,
            ..Default::default()
        };
        compare(a, b, &options).expect("same band").entries[0]
            .verdicts
            .clone()
    }

    #[test]
    fn a_resonance_above_with_the_stronger_excitation_means_growing_stiffness() {
        // multisine grid against chirp grid; the chirp deflects more (claim 5: 11.6 Hz to between
        // 11.8 and 15.3 Hz)
        let (multisine, chirp) = (joint(1.5e5, 0.0, 76), joint(2.3e5, 0.0, 150));
        for (a, b, stronger) in [(&multisine, &chirp, Side::B), (&chirp, &multisine, Side::A)] {
            let found = verdicts_of(a, b, Some(stronger));
            let [
                Verdict::StiffnessGrowsWithDeflection {
                    weaker_hz,
                    stronger_hz,
                },
            ] = found[..]
            else {
                panic!("{found:?}")
            };
            assert!(
                (weaker_hz - 11.62).abs() < 0.15 && (stronger_hz - 14.39).abs() < 0.15,
                "{found:?}"
            );
        }
        assert!(matches!(
            verdicts_of(&chirp, &multisine, Some(Side::B))[..],
            [Verdict::StiffnessFallsWithDeflection { .. }]
        ));
        assert!(matches!(
            verdicts_of(&multisine, &chirp, None)[..],
            [Verdict::ResonanceMoved { .. }]
        ));
    }

    #[test]
    fn a_damped_resonance_with_pushed_phase_means_friction() {
        let (clean, rough) = (joint(1.5e5, 0.0, 150), joint(1.5e5, 300.0, 150));
        for (a, b, expected) in [(&clean, &rough, Side::B), (&rough, &clean, Side::A)] {
            let found = verdicts_of(a, b, None);
            assert!(
                matches!(found[..], [Verdict::FrictionIn { side, resonance_down_db, .. }] if side == expected && resonance_down_db > 3.0),
                "{found:?}"
            );
        }
        assert!(
            verdicts_of(&clean, &rough, None)[0]
                .to_string()
                .starts_with("friction in B: its resonance is")
        );
    }

    #[test]
    fn the_same_machine_on_two_grids_gives_no_verdict() {
        let (coarse, fine) = (joint(1.5e5, 0.0, 76), joint(1.5e5, 0.0, 500));
        assert_eq!(verdicts_of(&coarse, &fine, Some(Side::A)), []);
        let entry = &compare(&coarse, &fine, &CompareOptions::default())
            .expect("same band")
            .entries[0];
        assert!(
            entry.changes.len() == 2 && entry.only_in_b.is_empty() && entry.difference_db < 0.05
        );
    }

    #[test]
    fn frfs_that_cannot_be_compared_are_refused() {
        let (a, mut b) = (joint(1.5e5, 0.0, 50), joint(1.5e5, 0.0, 50));
        let wide = Frf::new(vec![1.0], Array3::zeros((1, 2, 1))).expect("shapes agree");
        assert!(matches!(
            compare(&a, &wide, &CompareOptions::default()),
            Err(EstimateError::Signal(_))
        ));
        b.frequency_hz.iter_mut().for_each(|hz| *hz += 100.0);
        assert!(matches!(
            compare(&a, &b, &CompareOptions::default()),
            Err(EstimateError::NoCommonBand { found: 0, .. })
        ));
    }
}
