//! Phases between the channels of the experiments, which make U invertible: SK15 (9) and (26).

use std::f64::consts::{PI, TAU};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::SignalError;

/// Phases between channels and experiments; every choice but [`Phasing::AllAtOnce`] and [`Phasing::Zippered`] has as
/// many experiments as inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Phasing {
    /// `phi = 2 pi (l-1)(m-1) / n_u`, SK15 (9): condition number 1 for equal amplitudes.
    #[default]
    Orthogonal,
    /// Experiment 1 all in phase, then channel k turned by pi in experiment k, SK15 (26) with "and"
    /// read as "or": the better choice for chirps; condition number 1, 2, 3.73, 9.90 for 2, 3, 4, 6
    /// inputs.
    SignFlip,
    /// [`Phasing::Orthogonal`] on top of random phases drawn for each channel by itself, so that
    /// the channels' common nonlinear distortion averages out too (Dobrowiecki, Schoukens,
    /// Automatica 43 (2007) 1593). Multisines only.
    Independent,
    /// One experiment for all inputs, random phases drawn for each channel by itself: a third of the robot time of
    /// three inputs. Estimated from the lines around each frequency, which is why there should be many: local
    /// models. Multisines only.
    AllAtOnce,
    /// The same, but the lines are dealt out: line j is excited in channel j modulo the number of inputs alone, with more
    /// power there. Multisines only.
    Zippered,
    /// Experiment k excites channel k alone: condition number 1, but the other axes stand.
    OneAtATime,
}

impl Phasing {
    /// Refuses phases that `excitation`, a single sine at each instant, cannot have.
    pub(crate) fn check_for_one_sine(
        self,
        excitation: &str,
        choices: &str,
    ) -> Result<(), SignalError> {
        if !self.draws_each_channel() {
            return Ok(());
        }
        let what = format!(
            "independent phases need many lines, a multisine; for {excitation} take {choices}"
        );
        Err(SignalError::unfit("mimo", what))
    }

    /// Whether every channel has random phases of its own.
    pub(crate) fn draws_each_channel(self) -> bool {
        matches!(self, Self::Independent | Self::AllAtOnce | Self::Zippered)
    }

    /// Experiments of a realization.
    #[must_use]
    pub fn n_experiments(self, n_inputs: usize) -> usize {
        match self {
            Self::AllAtOnce | Self::Zippered => 1,
            _ => n_inputs,
        }
    }

    /// Phase in rad of `channel` in `experiment`, both from 0, with `n_inputs` channels.
    #[must_use]
    pub fn phase_rad(self, channel: usize, experiment: usize, n_inputs: usize) -> f64 {
        match self {
            // the product is reduced before the division, so that whole turns are exactly zero
            Self::Orthogonal | Self::Independent => {
                TAU * ((channel * experiment) % n_inputs) as f64 / n_inputs as f64
            }
            Self::SignFlip if channel == experiment && channel > 0 => PI,
            _ => 0.0,
        }
    }

    /// Whether `channel` is excited on the excited line of this place, both from 0.
    #[must_use]
    pub(crate) fn excites(self, channel: usize, place: usize, n_inputs: usize) -> bool {
        self != Self::Zippered || place % n_inputs == channel
    }

    /// Factor on the amplitude of `channel` in `experiment`: 1, or 0 for a channel that stands.
    #[must_use]
    pub fn weight(self, channel: usize, experiment: usize) -> f64 {
        let stands = self == Self::OneAtATime && channel != experiment;
        f64::from(u8::from(!stands))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;
    use num_complex::Complex64;

    fn condition(phasing: Phasing, n: usize) -> f64 {
        let matrix = DMatrix::from_fn(n, n, |l, m| Complex64::cis(phasing.phase_rad(l, m, n)));
        let gram = (matrix.adjoint() * matrix).map(|z| z.re); // real for both phasings: singular values are roots of its eigenvalues
        let eigenvalues = gram.symmetric_eigenvalues();
        (eigenvalues.max() / eigenvalues.min()).sqrt()
    }

    #[test]
    fn condition_numbers_are_the_published_ones() {
        for n in 1..=6 {
            assert!((condition(Phasing::Orthogonal, n) - 1.0).abs() < 1e-12);
        }
        assert_eq!(Phasing::AllAtOnce.n_experiments(3), 1);
        assert_eq!(Phasing::Zippered.n_experiments(3), 1);
        for (n, expected) in [(2, 1.0), (3, 2.0), (4, 3.732), (6, 9.899)] {
            assert!((condition(Phasing::SignFlip, n) - expected).abs() < 1e-3);
        }
    }
}
