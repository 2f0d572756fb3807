//! Verdict: what one axis suffers from, as a share beside the largest that is good.

use serde::{Deserialize, Serialize};

/// What may spoil the FRF of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// Standard deviation by noise over the response; the median line.
    Noise,
    /// The same by nonlinear distortion: by the total variance less that of the noise.
    Distortion,
    /// Share of the time in which friction held the axis.
    Sticking,
    /// Share of the lines on which what remains of the torque ripple exceeds the noise.
    Ripple,
    /// Share of the runs in which a line had not settled.
    Transient,
    /// Share of the lines on which U can hardly be inverted.
    Condition,
    /// Share of the samples at the highest or lowest level of a signal.
    Clipping,
}

/// What one axis suffers from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The axis.
    pub axis: String,
    /// What is judged.
    pub cause: Cause,
    /// The share found, 0 to 1 or more; `None` where it was not measured.
    pub found: Option<f64>,
    /// The largest share that is good.
    pub limit: f64,
}

impl Cause {
    /// All of them, in the order of a table.
    pub const ALL: [Self; 7] = [
        Self::Noise,
        Self::Distortion,
        Self::Sticking,
        Self::Ripple,
        Self::Transient,
        Self::Condition,
        Self::Clipping,
    ];

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Noise => "noise",
            Self::Distortion => "distortion",
            Self::Sticking => "sticking",
            Self::Ripple => "ripple",
            Self::Transient => "transient",
            Self::Condition => "condition",
            Self::Clipping => "clipping",
        }
    }

    /// What it is a share of.
    #[must_use]
    pub fn share_of(self) -> &'static str {
        match self {
            Self::Noise | Self::Distortion => "of |G|",
            Self::Sticking => "of the time",
            Self::Ripple | Self::Condition => "of the lines",
            Self::Transient => "of the runs",
            Self::Clipping => "of the samples",
        }
    }

    /// What an axis is beyond the limit.
    #[must_use]
    pub fn adjective(self) -> &'static str {
        match self {
            Self::Noise => "noise-limited",
            Self::Distortion => "distorted",
            Self::Sticking => "friction-dominated",
            Self::Ripple => "ripple-limited",
            Self::Transient => "unsettled",
            Self::Condition => "badly conditioned",
            Self::Clipping => "clipped",
        }
    }
}

impl Verdict {
    /// Whether the share is known and beyond its limit.
    #[must_use]
    pub fn is_beyond(&self) -> bool {
        self.found.is_some_and(|found| found > self.limit)
    }
}
