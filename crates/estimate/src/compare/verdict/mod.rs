//! Verdicts on a machine from the difference of two FRFs, with the reason.

pub(crate) mod damping;
pub(crate) mod inertia;
pub(crate) mod judgement;
pub(crate) mod mass_lines;
pub(crate) mod stiffness;

use std::fmt;

use frfid_signals::format::{plus_minus, significant};
use serde::{Serialize, Serializer};

use crate::compare::agreement::WorstBand;
use crate::compare::change::Side;
use crate::compare::entry::EntryComparison;
use crate::compare::feature::resonance::{Feature, FeatureKind};
use crate::compare::verdict::damping::DampingMarks;

/// A verdict, and the entry whose numbers it gives.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Judgement {
    /// What it says about the machine.
    pub verdict: Verdict,
    /// Entry `(output, input)`; `None` where it speaks of all.
    pub entry: Option<(usize, usize)>,
}

impl Judgement {
    pub(crate) fn of(verdict: Verdict, entry: &EntryComparison) -> Self {
        Self {
            verdict,
            entry: Some((entry.output, entry.input)),
        }
    }
}

/// A frequency with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Frequency in Hz.
    pub hz: f64,
    /// Its standard deviation in Hz; `None` where it is not known.
    pub std_hz: Option<f64>,
}

impl Peak {
    pub(crate) fn of(feature: &Feature) -> Self {
        Self {
            hz: feature.frequency_hz,
            std_hz: feature.frequency_std_hz,
        }
    }
}

/// `11.62 ± 0.02 Hz`.
impl fmt::Display for Peak {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.std_hz {
            Some(std_hz) => write!(f, "{} Hz", plus_minus(self.hz, std_hz)),
            None => write!(f, "{:.2} Hz", self.hz),
        }
    }
}

/// A statement about the machine and the numbers that support it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// Notch and peak of the stronger excitation lie above by one ratio, or its peak alone while
    /// every inertia stayed: a spring that gets stiffer as it deflects (SK15 section 6.3).
    StiffnessGrowsWithDeflection {
        /// Resonance with the weaker excitation.
        weaker: Peak,
        /// Resonance with the stronger excitation.
        stronger: Peak,
    },
    /// They lie below: a spring, or a joint with play or slip, that gets softer.
    StiffnessFallsWithDeflection {
        /// Resonance with the weaker excitation.
        weaker: Peak,
        /// Resonance with the stronger excitation.
        stronger: Peak,
    },
    /// Notch and peak moved by one ratio, and which excitation was stronger is not known.
    StiffnessDiffers {
        /// Resonance in A.
        a: Peak,
        /// Resonance in B.
        b: Peak,
    },
    /// The notch moved more than the peak, and the level below with them: another inertia of what
    /// the joint carries.
    PayloadOrPose {
        /// Shift of the notch in percent.
        notch_percent: f64,
        /// Shift of the peak in percent.
        peak_percent: f64,
    },
    /// The peak moved and the notch did not, and the level above with it.
    MotorInertia {
        /// Shift of the notch in percent.
        notch_percent: f64,
        /// Shift of the peak in percent.
        peak_percent: f64,
    },
    /// The weaker excitation shows the marks of Coulomb friction against the stronger: its resonance
    /// is damped, and its antiresonance is shallower or its phase pushed together (SK15 section
    /// 6.2).
    FrictionIn(DampingMarks),
    /// The same marks, but of the stronger excitation, or of one of which that is not known.
    DampingDiffers(DampingMarks),
    /// They differ, and the differences do not tell why.
    Differs {
        /// The most prominent feature that moved, in A and in B.
        moved: Option<(FeatureKind, Peak, Peak)>,
        /// Where the difference stands out of the noise most.
        worst: Option<WorstBand>,
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
            Self::StiffnessGrowsWithDeflection { weaker, stronger } => {
                write_deflection(f, "grows", weaker, stronger)
            }
            Self::StiffnessFallsWithDeflection { weaker, stronger } => {
                write_deflection(f, "falls", weaker, stronger)
            }
            Self::StiffnessDiffers { a, b } => write!(
                f,
                "stiffness differs: notch and resonance moved by one ratio, the resonance from {a} to {b}; say which excitation was stronger to learn whether it grows or falls with deflection"
            ),
            Self::PayloadOrPose {
                notch_percent,
                peak_percent,
            } => write!(
                f,
                "another payload or pose: the antiresonance moved by {notch_percent:+.1} %, the resonance by {peak_percent:+.1} %, and the level below them as the inertia asks"
            ),
            Self::MotorInertia {
                notch_percent,
                peak_percent,
            } => write!(
                f,
                "another inertia of the motor: the resonance moved by {peak_percent:+.1} %, the antiresonance by {notch_percent:+.1} %, and the level above them as the inertia asks"
            ),
            Self::FrictionIn(marks) => write_damping(f, "friction in", marks),
            Self::DampingDiffers(marks) => write_damping(f, "more damping in", marks),
            Self::Differs { moved, worst } => write_difference(f, *moved, *worst),
        }
    }
}

fn write_deflection(
    f: &mut fmt::Formatter<'_>,
    how: &str,
    weaker: &Peak,
    stronger: &Peak,
) -> fmt::Result {
    write!(
        f,
        "stiffness {how} with deflection: the stronger excitation finds the resonance at {stronger}, the weaker at {weaker}"
    )
}

fn write_damping(f: &mut fmt::Formatter<'_>, what: &str, marks: &DampingMarks) -> fmt::Result {
    let DampingMarks {
        resonance_down_db,
        antiresonance_up_db,
        phase_range_smaller_deg,
        ..
    } = marks;
    let name = if marks.side == Side::A { "A" } else { "B" };
    let down = marks.resonance_down_std_db.map_or_else(
        || format!("{resonance_down_db:.1}"),
        |std| plus_minus(*resonance_down_db, std),
    );
    write!(f, "{what} {name}: its resonance is {down} dB lower, ")?;
    if let Some(up) = antiresonance_up_db.filter(|up| *up > 0.0) {
        write!(f, "its antiresonance {up:.1} dB shallower, ")?;
    }
    if *phase_range_smaller_deg > 0.0 {
        write!(
            f,
            "its phase pushed together by {phase_range_smaller_deg:.0} deg, "
        )?;
    }
    write!(f, "as by a damper")
}

fn write_difference(
    f: &mut fmt::Formatter<'_>,
    moved: Option<(FeatureKind, Peak, Peak)>,
    worst: Option<WorstBand>,
) -> fmt::Result {
    write!(f, "they differ, and it cannot be told why")?;
    if let Some((kind, a, b)) = moved {
        write!(f, ": the {} moved from {a} to {b}", kind.name())?;
    }
    if let Some(worst) = worst {
        let (low, high) = (significant(worst.low_hz, 4), significant(worst.high_hz, 4));
        let percent = significant(worst.difference_percent, 2);
        write!(f, "; most between {low} and {high} Hz, by {percent} %")?;
    }
    Ok(())
}
