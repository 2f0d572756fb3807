//! F. Saupe, A. Knoblach, MSSP 52-53 (2015) 60-72, end to end: the experiments of its sections 6
//! and 7 in simulation, its claims beside our numbers, and its figures.

mod against_truth;
mod error;
mod named_figure;
mod paper;
mod section6;
mod section7;

pub use against_truth::{Measured, largest_relative_difference};
pub use error::PaperError;
pub use named_figure::Named;
pub use paper::{Paper, PaperFigures};
pub use section6::{Pair, Section6};
pub use section7::Section7;
pub use section7::chirps::{Conditions, ShapedChirps};
pub use section7::multisine::MultisineCampaign;
