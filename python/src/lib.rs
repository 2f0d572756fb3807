//! The Python extension module `frfid._core`: the crates of the house, seen from numpy. No
//! arithmetic happens here.

mod array;
mod batch;
mod bla;
mod chirp;
mod choice;
mod cli;
mod compare;
mod controller;
mod error;
mod excerpt;
mod experiment;
mod frf;
mod frf_parts;
mod glide;
mod interrupt;
mod loop_frf;
mod multisine;
mod pickle;
mod plan;
mod plant;
mod profile;
mod record;
mod result;
mod run;
mod runs;
mod shape;
mod shaped;
mod spectrogram;
mod states;
mod testbed;

/// Frequency response functions of flexible-joint robots, by experiment: the compiled part of the
/// package `frfid`.
#[pyo3::pymodule(gil_used = false)]
mod _core {
    #[pymodule_export]
    use crate::bla::{estimate, estimate_bla};
    #[pymodule_export]
    use crate::chirp::Chirp;
    #[pymodule_export]
    use crate::cli::cli;
    #[pymodule_export]
    use crate::compare::{Comparison, compare};
    #[pymodule_export]
    use crate::controller::{PiController, run_closed_loop};
    #[pymodule_export]
    use crate::error::NumericalError;
    #[pymodule_export]
    use crate::excerpt::estimate_chirp;
    #[pymodule_export]
    use crate::experiment::Experiment;
    #[pymodule_export]
    use crate::frf::Frf;
    #[pymodule_export]
    use crate::glide::subtract_glide;
    #[pymodule_export]
    use crate::loop_frf::loop_frf;
    #[pymodule_export]
    use crate::multisine::Multisine;
    #[pymodule_export]
    use crate::plan::Plan;
    #[pymodule_export]
    use crate::plant::Plant;
    #[pymodule_export]
    use crate::record::Record;
    #[pymodule_export]
    use crate::result::load;
    #[pymodule_export]
    use crate::run::Run;
    #[pymodule_export]
    use crate::shape::shape;
    #[pymodule_export]
    use crate::shaped::Shaped;
    #[pymodule_export]
    use crate::spectrogram::spectrogram;
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "its name in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
