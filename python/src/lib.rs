//! The Python extension module `frfid._core`: the crates of the house, seen from numpy. No
//! arithmetic happens here.

/// Estimators on arrays, and what is looked at beside them.
mod estimate {
    pub(crate) mod campaign;
    pub(crate) mod compare;
    pub(crate) mod excerpt;
    pub(crate) mod glide;
    pub(crate) mod local;
    pub(crate) mod periods;
    pub(crate) mod spectrogram;
}
/// `Experiment` and `Plan`: the workflow of the command line.
mod experiment {
    pub(crate) mod description;
    mod export;
    mod import;
    pub(crate) mod one_run;
    mod pickle;
    pub(crate) mod plan;
    mod planned;
}
/// `Frf`: an FRF matrix with everything that belongs to it.
mod frf {
    pub(crate) mod channels;
    pub(crate) mod distortion;
    pub(crate) mod harmonics;
    pub(crate) mod load;
    pub(crate) mod matrix;
    pub(crate) mod other_packages;
    pub(crate) mod outputs;
    pub(crate) mod parts;
}
/// Logs: read, looked into, estimated from.
mod logs {
    pub(crate) mod estimate;
    pub(crate) mod map;
    pub(crate) mod read;
}
/// `Plant` and its controller: robots in software.
mod plant {
    pub(crate) mod arm;
    pub(crate) mod batch;
    pub(crate) mod controller;
    pub(crate) mod linear_truth;
    pub(crate) mod loop_frf;
    pub(crate) mod open_loop;
    pub(crate) mod robot;
    pub(crate) mod robots;
    pub(crate) mod states;
}
/// `shape`: iterative shaping, and what comes of it.
mod shape {
    mod kept;
    pub(crate) mod shaped;
    pub(crate) mod shaping;
}
/// Excitations, runs and records.
mod signals {
    mod channels;
    pub(crate) mod chirp;
    pub(crate) mod multisine;
    pub(crate) mod profile;
    pub(crate) mod record;
    mod recorded_runs;
    pub(crate) mod run;
}
/// Runs done on simulated machines and on those of Python.
mod testbed {
    pub(crate) mod python_testbed;
    pub(crate) mod runs;
}
mod array;
mod choice;
mod cli;
mod error;
mod interrupt;
mod load;
mod pickle;
mod size;
mod sources;
mod threads;
mod warnings;

/// Frequency response functions of flexible-joint robots, by experiment: the compiled part of the
/// package `frfid`.
#[pyo3::pymodule(gil_used = false)]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::cli::cli;
    #[pymodule_export]
    use crate::error::NumericalError;
    #[pymodule_export]
    use crate::estimate::campaign::{coherence, estimate_loop, spectra_covariance};
    #[pymodule_export]
    use crate::estimate::compare::{Comparison, compare};
    #[pymodule_export]
    use crate::estimate::excerpt::estimate_chirp;
    #[pymodule_export]
    use crate::estimate::glide::subtract_glide;
    #[pymodule_export]
    use crate::estimate::local::estimate_local;
    #[pymodule_export]
    use crate::estimate::periods::{estimate, estimate_bla};
    #[pymodule_export]
    use crate::estimate::spectrogram::spectrogram;
    #[pymodule_export]
    use crate::experiment::description::Experiment;
    #[pymodule_export]
    use crate::experiment::one_run::run_experiment;
    #[pymodule_export]
    use crate::experiment::plan::Plan;
    #[pymodule_export]
    use crate::frf::load::load;
    #[pymodule_export]
    use crate::frf::matrix::Frf;
    #[pymodule_export]
    use crate::logs::estimate::estimate_logs;
    #[pymodule_export]
    use crate::logs::read::{inspect, read};
    #[pymodule_export]
    use crate::plant::controller::{PiController, run_closed_loop};
    #[pymodule_export]
    use crate::plant::loop_frf::loop_frf;
    #[pymodule_export]
    use crate::plant::open_loop::simulate;
    #[pymodule_export]
    use crate::plant::robot::Plant;
    #[pymodule_export]
    use crate::shape::shaped::Shaped;
    #[pymodule_export]
    use crate::shape::shaping::shape;
    #[pymodule_export]
    use crate::signals::chirp::Chirp;
    #[pymodule_export]
    use crate::signals::multisine::Multisine;
    #[pymodule_export]
    use crate::signals::record::Record;
    #[pymodule_export]
    use crate::signals::run::Run;
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "its name in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::load::load(module.py())
    }
}
