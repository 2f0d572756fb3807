//! Estimation of FRFs from recordings: direct, best linear approximation, excerpts, comparison; and
//! the shaping of excitations in closed loop, which rests on such estimates.
//!
//! Equation numbers are those of Saupe and Knoblach, MSSP 52-53 (2015) 60-72, cited SK15. Shapes,
//! units and the DFT follow `frfid_signals`. Nothing here knows files, clocks or chance.

mod compare;
mod error;
mod excitation_strength;
mod frf;
/// Subtraction of glides: what a constant velocity alone leaves in a record is taken off.
mod glide {
    pub(crate) mod apparent_inertia;
    pub(crate) mod by_position;
    pub(crate) mod in_time;
    pub(crate) mod ripple_residual;
    pub(crate) mod torque_table;
}
mod harmonics;
mod period_index;
/// Properties found in a recording that frfid did not make: its period, lines and transient.
mod recording {
    pub(crate) mod aperiodic;
    mod autocorrelation;
    mod candidate;
    mod channel;
    mod cycle;
    mod few_events;
    mod holes;
    mod lag;
    mod level_gap;
    mod likeness;
    mod line_levels;
    pub(crate) mod lines;
    mod local_power;
    mod long_lags;
    pub(crate) mod period;
    mod period_search;
    pub(crate) mod repetition;
    mod rests;
    mod run_ends;
    mod runs;
    pub(crate) mod single_sweep;
    mod slips;
    pub(crate) mod transient;
    mod two_states;
    pub(crate) mod unlined;
}
mod shape;
mod spectra;
mod spectrogram;
#[cfg(test)]
mod testing;

pub use compare::change::{Change, Side, Sides};
pub use compare::resonance::{Feature, FeatureKind, find_features};
pub use compare::verdict::Verdict;
pub use compare::{CompareOptions, Comparison, EntryComparison, compare};
pub use error::{Deficiency, DeficientLine, EstimateError};
pub use excitation_strength::pooling::pooled_strength;
pub use excitation_strength::warnings::strength_warnings;
pub use excitation_strength::{AxisStrength, BandStrength, strength};
pub use frf::excerpts::estimate_chirp;
pub use frf::singular::{condition_number, scaled_condition_number, singular_values};
pub use frf::time_series::estimate_bla;
pub use frf::{FrfOptions, Method};
pub use glide::by_position::RippleTorque;
pub use glide::in_time::subtract_glide;
pub use glide::ripple_residual::{FreeLines, ResidualLevel};
pub use harmonics::harmonic_levels;
pub use period_index::PeriodIndex;
pub use recording::aperiodic::Aperiodic;
pub use recording::lines::{find_lines, lines_at};
pub use recording::period::find_period;
pub use recording::repetition::{Repetition, find_repetition};
pub use recording::single_sweep::Sweep;
pub use recording::transient::count_transient_periods;
pub use recording::unlined::Unlined;
pub use shape::error::ShapeError;
pub use shape::iteration::{Estimate, Iteration};
pub use shape::note::Note;
pub use shape::options::{ShapeOptions, Step, Target};
pub use shape::shaper::Shaper;
pub use shape::sticking::{BandMotion, Sticking};
pub use shape::summary::{ShapePeaks, Shaped, Stop, Summary};
pub use shape::{Driver, Watcher, shape};
pub use spectra::campaign::{Campaign, RunSpectra};
pub use spectra::excerpt::{ExcerptOptions, Excerpts};
pub use spectra::line_dft::LineDft;
pub use spectra::{Evaluation, Transform};
pub use spectrogram::{Spectrogram, SpectrogramOptions, spectrogram};
