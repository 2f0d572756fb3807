//! Coverage of the 95 % regions by Monte Carlo, entry by entry and as a matrix: every line of a campaign
//! is an experiment of its own. `FRFID_COVERAGE_LINES` sets their number.

mod glides;
mod matrix;
mod phases;
mod realizations;
mod region;
mod simulated;
