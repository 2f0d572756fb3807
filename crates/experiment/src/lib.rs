//! One description, the whole workflow: `experiment.toml` to plan, runs and FRF.

pub mod campaign;
mod claim;
pub mod config;
mod cost;
mod design;
mod error;
mod estimator;
mod experiment;
mod in_memory;
pub mod init;
mod measured;
mod predict;
mod robot;
mod schema;
mod section6;
mod section6_claims;
mod source;
mod testbed;

pub use campaign::{Progress, silent};
pub use claim::Claim;
pub use config::Config;
pub use cost::Cost;
pub use error::ExperimentError;
pub use estimator::{Estimator, PeriodSpectra, log_spaced};
pub use experiment::Experiment;
pub use in_memory::Estimated;
pub use measured::{Measured, largest_relative_difference};
pub use predict::{Excess, Peaks, Prediction, predict};
pub use robot::{ControllerTable, RippleTable, RobotTable, SensorTable, SingleJointTable};
pub use schema::schema;
pub use section6::{Pair, Section6};
pub use source::{ConfigError, Place, Source};
