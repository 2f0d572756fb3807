//! From recordings to FRFs: direct, best linear approximation, excerpts, comparison; and the
//! shaping of excitations in closed loop, which rests on such estimates.
//!
//! Equation numbers are those of Saupe and Knoblach, MSSP 52-53 (2015) 60-72, cited SK15. Shapes,
//! units and the DFT follow `frfid_signals`. Nothing here knows files, clocks or chance.

mod bla;
mod bode;
mod campaign;
mod chirp;
mod compare;
mod error;
mod excerpt;
mod glide;
mod harmonics;
mod indirect;
mod line_dft;
mod lines;
mod median;
mod period;
mod residual;
mod resonance;
mod right_division;
mod ripple_torque;
mod shape;
mod singular;
mod spectrogram;
mod strength;
#[cfg(test)]
mod strength_tests;
mod strength_warning;
#[cfg(test)]
mod testing;
mod torque_table;
mod transient;
mod verdict;

pub use bla::{Averaging, BlaOptions, estimate_bla};
pub use campaign::{Campaign, Place, RunSpectra, Transform};
pub use chirp::estimate_chirp;
pub use compare::{Change, CompareOptions, Comparison, EntryComparison, Side, compare};
pub use error::{Deficiency, DeficientLine, EstimateError};
pub use excerpt::{ExcerptOptions, Excerpts};
pub use glide::subtract_glide;
pub use harmonics::harmonic_levels;
pub use line_dft::LineDft;
pub use lines::{find_lines, lines_at};
pub use median::median;
pub use period::find_period;
pub use residual::{FreeLines, ResidualLevel};
pub use resonance::{Feature, FeatureKind, find_features};
pub use ripple_torque::RippleTorque;
pub use shape::{
    BandMotion, Estimate, Iteration, Note, Peaks, Quantity, ShapeError, ShapeLimits, ShapeOptions,
    Shaped, Shaper, Step, Sticking, Stop, Summary, Target, Watcher, shape,
};
pub use singular::{condition_number, scaled_condition_number, singular_values};
pub use spectrogram::{Spectrogram, SpectrogramOptions, spectrogram};
pub use strength::{AxisStrength, BandStrength, pooled_strength, strength};
pub use strength_warning::strength_warnings;
pub use transient::count_transient_periods;
pub use verdict::Verdict;
