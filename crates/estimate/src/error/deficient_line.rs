//! Lines on which an FRF cannot be had, and why.

use std::fmt;

/// A line on which U cannot be inverted, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct DeficientLine {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// 2-norm condition number of U with rows scaled to equal norm; infinite where an input is not
    /// excited.
    pub condition: f64,
    /// The largest condition allowed.
    pub limit: f64,
    /// What makes it so.
    pub cause: Deficiency,
}

/// Why the inputs cannot be separated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Deficiency {
    /// An input without any power on the line beyond rounding.
    InputSilent {
        /// Input channel.
        input: usize,
    },
    /// An input far below what stands on the lines beside it.
    InputWeak {
        /// Input channel.
        input: usize,
        /// Its power over that of the strongest line nearby in dB.
        level_db: f64,
    },
    /// An input that cannot be told from its own noise.
    InputNoisy {
        /// Input channel.
        input: usize,
        /// Power of its excitation over that of its noise in one period in dB; `-inf` if nothing
        /// is left of it.
        snr_db: f64,
    },
    /// Inputs that are alike on all lines around the frequency, or hardly moved by the reference.
    InputsAlike,
    /// The two most similar experiments; correlation 1 means they differ by a factor only.
    ExperimentsAlike {
        /// The two experiments.
        pair: (usize, usize),
        /// |u_m^H u_n| / (|u_m| |u_n|).
        correlation: f64,
    },
}

impl fmt::Display for DeficientLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} Hz: ", self.frequency_hz)?;
        if let Deficiency::ExperimentsAlike { .. } | Deficiency::InputsAlike = self.cause {
            let Self {
                condition, limit, ..
            } = self;
            write!(
                f,
                "condition number {condition:.1e}, at most {limit:.1e} is allowed; "
            )?;
        }
        write!(f, "{}", self.cause)
    }
}

impl fmt::Display for Deficiency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InputSilent { input } => write!(f, "input {input} is not excited there"),
            Self::InputWeak { input, level_db } => write!(
                f,
                "input {input} is not excited there: {:.0} dB below the strongest line nearby",
                -level_db
            ),
            Self::InputNoisy { input, snr_db } => write!(
                f,
                "input {input} cannot be told from its noise there (signal to noise {snr_db:.0} dB): it does \
                 not repeat from period to period; excite the line more strongly or record more periods"
            ),
            Self::InputsAlike => f.write_str(
                "the inputs are alike on all lines around it, or the reference hardly moves them; excite them independently, or in as many experiments as inputs",
            ),
            Self::ExperimentsAlike {
                pair: (m, n),
                correlation,
            } => write!(
                f,
                "experiments {m} and {n} are the most alike (correlation {correlation:.6})"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::EstimateError;

    #[test]
    fn a_deficient_line_names_frequency_condition_and_experiments() {
        let cause = Deficiency::ExperimentsAlike {
            pair: (0, 2),
            correlation: 1.0,
        };
        let line = DeficientLine {
            frequency_hz: 5.0,
            condition: f64::INFINITY,
            limit: 1e10,
            cause,
        };
        let text = EstimateError::RankDeficient(vec![line]).to_string();
        for part in [
            "1 of the lines",
            "5 Hz",
            "inf",
            "1.0e10",
            "experiments 0 and 2",
        ] {
            assert!(text.contains(part), "{text}");
        }
    }
}
