//! One description, the whole workflow: `experiment.toml` to plan, runs and FRF.

mod description;
mod design;
mod error;
mod estimate;
mod experiment;
mod run;
mod shape;

pub use description::config::{AveragingTable, Config, ConstantVelocityTable};
pub use description::estimate::{Average, EstimateTable, GlideSubtraction};
pub use description::excitation::{Amplitude, ChirpTable, MultisineTable};
pub use description::robot::RobotTable;
pub use description::robot::body::BodyTable;
pub use description::robot::controller::ControllerTable;
pub use description::robot::joint::{JointTable, MotorRippleTable, SingleJointTable};
pub use description::robot::urdf::UrdfTable;
pub use description::schema::schema;
pub use description::shape::{ShapeTable, StepName};
pub use description::templates::{TEMPLATES, Template};
pub use description::text::{ConfigError, TextSpan, TomlText};
pub use design::cost::Cost;
pub use design::predict::{Prediction, predict};
pub use error::ExperimentError;
pub use estimate::estimator::{Estimator, Spectra, log_spaced};
pub use estimate::outcome::Outcome;
pub use estimate::strength::Strength;
pub use estimate::{EstimateOptions, estimate_logs};
pub use experiment::Experiment;
pub use run::folder::{RunOptions, RunReport, RunSummary, run_to_folder};
pub use run::load::Load;
pub use run::parallel::{Progress, Steps, for_each, silent};
pub use run::planned_runs::Order;
pub use shape::folder::{ShapeFolderOptions, shape_to_folder};
pub use shape::report::{IterationReport, ShapeReport};
