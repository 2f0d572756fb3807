//! Words for people on whether two FRFs agree.

use std::fmt;

use frfid_signals::format::{count, significant};

use crate::compare::agreement::{Agreement, NoiseTest, UnknownAgreement};
use crate::compare::measured::Spread;

/// The sentence for people.
impl fmt::Display for Agreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tested(test) => write!(f, "{test}"),
            Self::Unknown { reason } => {
                write!(
                    f,
                    "whether they agree within their noise is not known: {reason}"
                )
            }
        }
    }
}

impl fmt::Display for UnknownAgreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoCovariance => "no covariance was measured of one of them",
            Self::NotOnTheSameLines => "they are not on the same lines",
            Self::Blurred => "excerpts of a chirp blur, by how much in level is not known",
        })
    }
}

/// `they agree within their noise: 68.2 on 71 lines, 71 by chance`.
impl fmt::Display for NoiseTest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let how = if self.agrees {
            "agree within"
        } else {
            "differ by more than"
        };
        let noise = match self.spread {
            Spread::Total => "noise and distortion",
            Spread::Noise => "noise",
        };
        let (statistic, lines) = (significant(self.statistic, 3), count(self.n_lines, "line"));
        write!(
            f,
            "they {how} their {noise}: {statistic} on {lines}, {} by chance",
            self.n_lines
        )?;
        match self.worst.filter(|_| !self.agrees) {
            Some(worst) => write!(
                f,
                "; most between {} and {} Hz, by {} %",
                significant(worst.low_hz, 4),
                significant(worst.high_hz, 4),
                significant(worst.difference_percent, 2)
            ),
            None => Ok(()),
        }
    }
}
