//! Distortion levels from detection lines: noise, odd and even nonlinear distortion at input and output, from periodic
//! multisines, in open and closed loop.
//!
//! Where odd lines alone are excited, a nonlinearity of odd degree reaches odd lines alone, one of even degree even
//! lines. On lines that are not excited, with the means over n_q periods U and Y of a realization, the levels are
//!
//! ```text
//! at u:  |U|^2 - noise / n_q            at y:  |Y - G U|^2 - noise / n_q
//! ```
//!
//! the noise of one period from the spread of the same around its mean, averaged over realizations, experiments and
//! groups of lines. What an input has on these lines, by feedback or an imperfect generator, the plant answers: G U is
//! that answer to first order, linear interpolation between the excited lines gives G, and the distortion of the plant
//! itself is left. Source: R. Pintelon, J. Schoukens, System Identification, 2nd ed., ch. 4 (fast and robust methods).

mod answer;
mod bursts;
pub(crate) mod detection_lines;
mod groups;
mod interval;
mod line_powers;
#[cfg(test)]
mod tests;
pub(crate) mod time_series;

use frfid_signals::{Distortion, Frf};
use ndarray::Array2;
use num_complex::Complex64;

use crate::distortion::answer::unexplained;
use crate::distortion::detection_lines::DetectionLines;
use crate::distortion::groups::OnLines;
use crate::distortion::line_powers::{Draws, LinePowers};
use crate::error::EstimateError;
use crate::spectra::campaign::{Block, Campaign};
use crate::spectra::equal_draws::EqualDraws;
use crate::spectra::run_spectra::RunSpectra;

/// The same complete periods on excited lines and on detection lines.
pub struct OnBoth<'a> {
    /// On the excited lines.
    pub excited: &'a Campaign,
    /// On the detection lines: of all realizations or the first of them.
    pub free: &'a Campaign,
    /// Realizations whose phases are those of another.
    pub equal_draws: &'a [EqualDraws],
    /// Number of glides whose mean was taken off all runs.
    pub n_glides: usize,
}

/// A signal of a run.
type Signal = fn(&RunSpectra) -> &Array2<Complex64>;

impl OnBoth<'_> {
    /// Levels of distortion, with the FRF on the excited lines.
    ///
    /// # Errors
    /// [`frfid_signals::SignalError::Shape`] for an FRF of other lines or channels, [`EstimateError::EmptyList`]
    /// without runs or a line that is known.
    pub fn levels(&self, lines: &DetectionLines, plant: &Frf) -> Result<Distortion, EstimateError> {
        let rest = unexplained(lines, self.free, plant)?;
        let (excited, free) = (self.excited.blocks(), rest.blocks());
        if excited.is_empty() || free.is_empty() {
            return Err(EstimateError::EmptyList("runs"));
        }
        let draws = self.draws(free.len());
        let levels_of = |signal: Signal| {
            let on_lines = OnLines {
                lines,
                frequency_hz: self.free.frequency_hz(),
                excited: power_of(&excited, signal),
                free: LinePowers::of(&free, draws, signal),
            };
            on_lines.levels()
        };
        Ok(Distortion {
            inputs: levels_of(|run| &run.u),
            outputs: levels_of(|run| &run.y),
        })
    }

    fn draws(&self, n_realizations: usize) -> Draws {
        let n_equal: usize = self.equal_draws.iter().map(n_copies).sum();
        Draws {
            n_glides: self.n_glides,
            n_draws: n_realizations.saturating_sub(n_equal).max(1),
        }
    }
}

/// Number of the realizations looked at that are copies of another.
fn n_copies(draws: &EqualDraws) -> usize {
    let among = draws.realizations.iter();
    let n_among = among
        .filter(|place| DetectionLines::look_at(**place))
        .count();
    n_among.saturating_sub(1)
}

/// Mean power, `(channel, line)`.
fn power_of(blocks: &[Vec<Block>], signal: Signal) -> Array2<f64> {
    let draws = Draws {
        n_glides: 0,
        n_draws: blocks.len(),
    };
    LinePowers::of(blocks, draws, signal).power
}
