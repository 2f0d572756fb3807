//! One description, the whole workflow: `experiment.toml` to plan, runs and FRF.

mod baseline;
pub mod campaign;
mod claim;
pub mod config;
mod cost;
mod design;
mod error;
mod estimator;
mod experiment;
mod feasible;
mod foreign;
mod in_memory;
pub mod init;
mod measured;
mod order;
mod own_logs;
mod predict;
mod provenance;
mod result;
mod ripple_residual;
mod robot;
mod run_folder;
mod schema;
mod section6;
mod section6_claims;
mod section7;
mod shape;
mod shape_folder;
mod shape_iteration;
mod shape_report;
mod source;
mod strength;
mod testbed;

pub use campaign::{Progress, silent};
pub use claim::Claim;
pub use config::Config;
pub use cost::Cost;
pub use error::ExperimentError;
pub use estimator::{Estimated, Estimator, Spectra, log_spaced};
pub use experiment::Experiment;
pub use foreign::{Foreign, Names, estimate_foreign};
pub use in_memory::estimate_records;
pub use measured::{Measured, largest_relative_difference};
pub use order::Order;
pub use own_logs::{OwnLogs, estimate_own, find_logs};
pub use predict::{Excess, Peaks, Prediction, predict};
pub use result::{Estimate, EstimateOptions, estimate_logs};
pub use robot::{
    BodyTable, ChallengesTable, ControllerTable, InertiaTable, JointTable, MotorRippleTable,
    PayloadTable, RippleTable, RobotTable, SensorTable, SingleJointTable, UrdfTable,
};
pub use run_folder::{RunOptions, RunReport, RunSummary, run_to_folder};
pub use schema::schema;
pub use section6::{Pair, Section6};
pub use section7::{Conditions, MultisineCampaign, Section7, ShapedChirps};
pub use shape_folder::{ShapeFolderOptions, shape_to_folder};
pub use shape_report::{IterationReport, ShapePeaks, ShapeReport};
pub use source::{ConfigError, Place, Source};
pub use strength::{AxisReport, BandReport, Strength};
