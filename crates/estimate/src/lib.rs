//! Estimation of FRFs from recordings: direct, best linear approximation, excerpts, comparison; and
//! the shaping of excitations in closed loop, which rests on such estimates.
//!
//! Equation numbers are those of Saupe and Knoblach, MSSP 52-53 (2015) 60-72, cited SK15. Shapes,
//! units and the DFT follow `frfid_signals`. Nothing here knows files, clocks or chance.

mod alignment;
mod closed_loop;
mod compare;
/// Correlation of a signal with itself: power that repeats after a lag, over holes and rests.
mod correlation {
    pub(crate) mod autocorrelation;
    pub(crate) mod channel;
    pub(crate) mod lag;
    pub(crate) mod likeness;
    pub(crate) mod local_power;
    pub(crate) mod long_lags;
    pub(crate) mod pair_sums;
}
mod distortion;
mod error;
mod excitation_strength;
mod frf;
mod friction;
/// Subtraction of glides: what a constant velocity alone leaves in a record is taken off.
mod glide {
    pub(crate) mod apparent_inertia;
    pub(crate) mod by_position;
    pub(crate) mod in_time;
    pub(crate) mod residual_level;
    pub(crate) mod ripple_lines;
    pub(crate) mod ripple_residual;
    pub(crate) mod torque_table;
}
mod harmonics;
/// Spectra of input and output together: coherence, covariances.
mod joint_spectra {
    pub(crate) mod coherence;
    pub(crate) mod covariance;
}
mod lines;
mod look;
mod period_index;
/// Runs of a recording: the spectra of their periods, the clock of who played them.
mod recording {
    pub(crate) mod clock_ratio;
    pub(crate) mod run_periods;
}
mod repetition;
mod settling;
mod shape;
mod spectra;
mod spectrogram;
#[cfg(test)]
mod testing;
mod trend;

pub use alignment::{Alignment, Logged, Occurrence, Template, find_occurrences, resampled};
pub use closed_loop::{ClosedLoop, Entry, Port, Response};
pub use compare::agreement::{Agreement, NoiseTest, UnknownAgreement, WorstBand};
pub use compare::change::{Change, Side, Sides};
pub use compare::entry::EntryComparison;
pub use compare::feature::resonance::{Feature, FeatureKind, find_features};
pub use compare::measured::Spread;
pub use compare::verdict::damping::DampingMarks;
pub use compare::verdict::mass_lines::{LevelChange, MassLines};
pub use compare::verdict::{Judgement, Peak, Verdict};
pub use compare::{CompareOptions, Comparison, compare};
pub use distortion::OnBoth;
pub use distortion::detection_lines::DetectionLines;
pub use distortion::time_series::estimate_with_distortion;
pub use error::EstimateError;
pub use error::aperiodic::Aperiodic;
pub use error::deficient_line::{Deficiency, DeficientLine};
pub use error::unlined::Unlined;
pub use excitation_strength::pooling::pooled_strength;
pub use excitation_strength::stuck::standing_share;
pub use excitation_strength::warnings::{MOST_STUCK, strength_warnings};
pub use excitation_strength::{AxisStrength, BandStrength, strength};
pub use frf::direct_difference::DirectDifference;
pub use frf::estimate::FrfEstimate;
pub use frf::excerpts::bias::add_excerpt_bias;
pub use frf::excerpts::{estimate_chirp, estimate_repeats};
pub use frf::local::{LocalEstimate, LocalModel, LocalOptions, Piece, estimate_local};
pub use frf::noise_bias::NoiseBias;
pub use frf::roughness::{Roughness, roughness};
pub use frf::singular::{condition_number, scaled_condition_number, singular_values};
pub use frf::time_series::{campaign_of_periods, estimate_bla, estimate_periods};
pub use frf::{FrfOptions, Method};
pub use friction::{
    AxisFriction, Friction, FrictionOfAxes, FrictionSpectra, find_friction, find_friction_of_axes,
    mean_signs,
};
pub use glide::by_position::RippleTorque;
pub use glide::in_time::subtract_glide;
pub use glide::residual_level::ResidualLevel;
pub use glide::ripple_lines::has_ripple_lines;
pub use glide::ripple_residual::FreeLines;
pub use harmonics::{ChirpHarmonics, SweepSpectra, harmonic_levels};
pub use joint_spectra::coherence::Coherence;
pub use joint_spectra::covariance::SpectraCovariance;
pub use lines::unexcited_lines::unexcited_lines;
pub use lines::{find_lines, lines_at};
pub use look::look;
pub use look::oddity::{Consequence, Level, MUCH_CLIPPED, Oddity};
pub use look::wrapped::unwrapped;
pub use period_index::PeriodIndex;
pub use recording::clock_ratio::{ClockRatio, find_clock_ratio};
pub use recording::run_periods::RunPeriods;
pub use repetition::period::find_period;
pub use repetition::{Repetition, find_repetition};
pub use settling::input_changes::without_input_changes;
pub use settling::transient::count_transient_periods;
pub use settling::{Settling, UnsettledLine, judge_settling};
pub use shape::error::ShapeError;
pub use shape::iteration::{Estimate, Iteration};
pub use shape::measure::octave_error::OctaveError;
pub use shape::note::Note;
pub use shape::options::{ShapeOptions, Step, Target};
pub use shape::shaper::Shaper;
pub use shape::sticking::{BandMotion, Sticking};
pub use shape::summary::{ShapePeaks, Shaped, Stop, Summary};
pub use shape::{Driver, Watcher, shape};
pub use spectra::campaign::Campaign;
pub use spectra::equal_draws::EqualDraws;
pub use spectra::excerpt::{ExcerptOptions, Excerpts};
pub use spectra::harmonic_fit::HarmonicFit;
pub use spectra::line_dft::LineDft;
pub use spectra::run_spectra::RunSpectra;
pub use spectra::whole_record::WholeRecord;
pub use spectra::{Evaluation, Transform};
pub use spectrogram::{Spectrogram, SpectrogramOptions, spectrogram};
pub use trend::trend_model::Decay;
pub use trend::{Trend, find_trend};
