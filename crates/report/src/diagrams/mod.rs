//! Diagrams: an FRF, a spectrogram, signals over time, the convergence of a shaping.

pub(crate) mod bode;
pub(crate) mod convergence;
pub(crate) mod curve;
pub(crate) mod phase;
pub(crate) mod spectrogram;
pub(crate) mod time_series;
