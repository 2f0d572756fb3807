//! One description, the whole workflow: `experiment.toml` to plan, runs and FRF.

/// `experiment.toml`: the description of an experiment, its text and its tables.
mod description {
    pub(crate) mod channels;
    pub(crate) mod config;
    pub(crate) mod controller;
    pub(crate) mod estimate;
    pub(crate) mod fault;
    pub(crate) mod joint_limits;
    pub(crate) mod limits;
    pub(crate) mod machine;
    pub(crate) mod misspelt;
    pub(crate) mod plan;
    pub(crate) mod radians;
    pub(crate) mod robot;
    pub(crate) mod schema;
    pub(crate) mod shape;
    pub(crate) mod templates;
    pub(crate) mod text;
}
/// Design: what a plan costs, and what it will ask of the robot.
mod design {
    pub(crate) mod cost;
    pub(crate) mod plausible;
    pub(crate) mod predict;
    pub(crate) mod preflight;
    pub(crate) mod signal;
}
mod error;
mod estimate;
mod experiment;
mod inspect;
/// Plays of runs on machines of others: out to their players, back from their recorders.
mod play {
    pub(crate) mod by_files;
    pub(crate) mod command;
    pub(crate) mod export;
    pub(crate) mod import;
    pub(crate) mod layout;
    pub(crate) mod playing;
    pub(crate) mod process;
    pub(crate) mod rehearsal;
}
/// Runs: done on a testbed, several at once, and kept.
mod run {
    pub(crate) mod fading;
    pub(crate) mod folder;
    pub(crate) mod guard;
    pub(crate) mod kept;
    pub(crate) mod load;
    pub(crate) mod parallel;
    pub(crate) mod planned_runs;
    pub(crate) mod provenance;
    pub(crate) mod run_file;
    pub(crate) mod signal;
    pub(crate) mod simulated;
    pub(crate) mod strength;
}
/// Iterative shaping of a chirp in closed loop, with everything on disk.
mod shape {
    pub(crate) mod begin;
    pub(crate) mod earlier;
    pub(crate) mod folder;
    pub(crate) mod in_memory;
    pub(crate) mod in_words;
    pub(crate) mod iteration_files;
    pub(crate) mod kept_references;
    pub(crate) mod report;
    pub(crate) mod trail;
}

pub use description::channels::{ChannelsTable, Units};
pub use description::config::{AveragingTable, Config, ConstantVelocityTable};
pub use description::controller::ControllerTable;
pub use description::estimate::{Average, EstimateTable, GlideSubtraction};
pub use description::limits::LimitsTable;
pub use description::robot::RobotTable;
pub use description::robot::body::BodyTable;
pub use description::robot::joint::{JointTable, MotorRippleTable, SingleJointTable};
pub use description::robot::urdf::UrdfTable;
pub use description::robot::urdf_start::description_of_urdf;
pub use description::schema::{map_schema, robot_schema, schema};
pub use description::shape::{ShapeTable, StepName};
pub use description::templates::{TEMPLATES, Template};
pub use description::text::{ConfigError, TextSpan, TomlText};
pub use design::cost::Cost;
pub use design::predict::{Prediction, predict};
pub use error::ExperimentError;
pub use estimate::estimator::{Estimator, Spectra};
pub use estimate::find_logs::recordings_among;
pub use estimate::outcome::Outcome;
pub use estimate::verdicts::{Evidence, judge};
pub use estimate::{EstimateOptions, estimate_logs};
pub use experiment::Experiment;
pub use inspect::guess::GuessedMap;
pub use inspect::{GroupLook, Inspection, SignalLook, inspect_recording};
pub use play::by_files::{Awaited, FilesTestbed};
pub use play::command::{CommandTestbed, PlayerCommand};
pub use play::export::PlayOptions;
pub use play::import::{ImportOptions, ImportSummary, ImportedRun, import_recordings};
pub use play::process::end_player;
pub use run::fading::fading_advice;
pub use run::folder::{RunOptions, RunReport, RunSummary, run_path, run_to_folder};
pub use run::guard::Guarded;
pub use run::kept::KeptRuns;
pub use run::load::Load;
pub use run::parallel::{Progress, Steps, for_each, for_each_group, in_pool, on_threads, silent};
pub use run::planned_runs::PlannedRuns;
pub use run::signal::SignalPeaks;
pub use run::strength::Strength;
pub use shape::folder::{ShapeFolderOptions, shape_to_folder};
pub use shape::kept_references::KeptReferences;
pub use shape::report::{IterationReport, ShapeReport};
