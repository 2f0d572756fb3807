//! Closed loop from one campaign: what the reference does to input and output, and what follows from it
//! for the plant and the loop, each with its covariance.
//!
//! The reference is known without noise, so that the joint FRF J from r to (u, y) is the direct estimate
//! (mean of spectra) with r as the input. With `J_u` (r to u) and `J_y` (r to y):
//!
//! ```text
//! plant                 G = J_y J_u^-1
//! r is a set point of y, u = C (r - y):
//!   sensitivity         S = (I + G C)^-1 = I - J_y          complementary  T = J_y
//!   open loop           L = G C = (I - J_y)^-1 - I
//! r is added to u, u = r - C y:
//!   sensitivity         S = (I + C G)^-1 = J_u              complementary  T = I - J_u
//!   open loop           L = C G = J_u^-1 - I
//! ```
//!
//! (R. Pintelon, J. Schoukens, System Identification, 2nd ed., section 2.6.4; S. Skogestad, I.
//! Postlethwaite, Multivariable Feedback Control, section 2.2.) Covariances to first order.

mod propagation;

use frfid_signals::{Frf, SignalError};
use nalgebra::DMatrix;
use ndarray::{Axis, concatenate};
use num_complex::Complex64;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::closed_loop::propagation::{Equation, propagated};
use crate::error::EstimateError;
use crate::frf::matrices::Matrix;
use crate::frf::{FrfOptions, Method};
use crate::spectra::campaign::Campaign;
use crate::spectra::run_spectra::RunSpectra;

/// Where the reference enters the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Entry {
    /// A set point of the output, as many references as outputs.
    SetPoint,
    /// Added to the input.
    Input,
}

/// What of a closed loop is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Response {
    /// G, from input to output.
    Plant,
    /// From reference to input.
    RToU,
    /// From reference to output.
    RToY,
    /// S.
    Sensitivity,
    /// T.
    ComplementarySensitivity,
    /// L.
    OpenLoop,
}

/// A place in a loop, where a response begins or ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Port {
    /// The reference r.
    Reference,
    /// The input u.
    Input,
    /// The output y.
    Output,
    /// The control error r - y.
    Error,
    /// What the controller gives, in the unit of the input.
    Controller,
}

impl Response {
    /// Where it begins and ends.
    #[must_use]
    pub fn ports(self, entry: Option<Entry>) -> [Port; 2] {
        let is_set_point = entry != Some(Entry::Input);
        match self {
            Self::Plant => [Port::Input, Port::Output],
            Self::RToU => [Port::Reference, Port::Input],
            Self::RToY => [Port::Reference, Port::Output],
            Self::Sensitivity if is_set_point => [Port::Reference, Port::Error],
            Self::Sensitivity => [Port::Reference, Port::Input],
            Self::ComplementarySensitivity if is_set_point => [Port::Reference, Port::Output],
            Self::ComplementarySensitivity => [Port::Reference, Port::Controller],
            Self::OpenLoop if is_set_point => [Port::Error, Port::Output],
            Self::OpenLoop => [Port::Input, Port::Controller],
        }
    }
}

/// The joint FRF from the reference to input and output.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedLoop {
    joint: Frf,
}

impl Campaign {
    /// The closed loop of the runs given so far; NaN on lines on which a reference is not excited.
    ///
    /// # Errors
    /// As [`Campaign::estimate_lines`]; [`SignalError::Unfit`] if a run lacks the reference.
    pub fn closed_loop(&self, max_condition: f64) -> Result<ClosedLoop, EstimateError> {
        let joint = self.with_reference_as_input()?;
        let options = FrfOptions {
            max_condition,
            ..Method::MeanOfSpectra.into()
        };
        let joint = joint.estimate(&options)?;
        Ok(ClosedLoop { joint })
    }
}

impl Campaign {
    /// The same runs with the reference in the input's place, and input and output as the output.
    fn with_reference_as_input(&self) -> Result<Self, EstimateError> {
        let mut joint = Self::new(self.frequency_hz().to_vec())?;
        for (place, run) in self.clone().into_runs() {
            let Some(r) = run.r else {
                return Err(SignalError::unfit("r", "give the reference for every run").into());
            };
            let y = concatenate![Axis(0), run.u, run.y];
            joint.insert(place, RunSpectra { u: r, y, r: None })?;
        }
        Ok(joint)
    }
}

impl ClosedLoop {
    /// A response of the loop.
    ///
    /// # Errors
    /// [`SignalError::Unfit`] for a response that takes the place of the reference where that is not
    /// known, or a set point with other channels than the output.
    pub fn response(&self, what: Response, entry: Option<Entry>) -> Result<Frf, SignalError> {
        Ok(match what {
            Response::Plant => self.of(plant),
            Response::RToU => self.of(|j, n| selected(j, n, Complex64::ONE, Rows::Input)),
            Response::RToY => self.of(|j, n| selected(j, n, Complex64::ONE, Rows::Output)),
            Response::Sensitivity => match self.entry(entry)? {
                Entry::SetPoint => self.of(|j, n| rest(j, n, Rows::Output)),
                Entry::Input => self.response(Response::RToU, None)?,
            },
            Response::ComplementarySensitivity => match self.entry(entry)? {
                Entry::SetPoint => self.response(Response::RToY, None)?,
                Entry::Input => self.of(|j, n| rest(j, n, Rows::Input)),
            },
            Response::OpenLoop => match self.entry(entry)? {
                Entry::SetPoint => self.of(loop_of_set_point),
                Entry::Input => self.of(loop_of_input),
            },
        })
    }

    fn of(&self, equation: impl Fn(&Matrix, usize) -> Equation) -> Frf {
        propagated(&self.joint, |joint| equation(joint, self.joint.n_inputs()))
    }

    /// Where the reference enters, if that can be.
    fn entry(&self, entry: Option<Entry>) -> Result<Entry, SignalError> {
        let n_inputs = self.joint.n_inputs();
        let n_outputs = self.joint.n_outputs() - n_inputs;
        match entry {
            None => Err(SignalError::unfit(
                "loop",
                "whether the reference is a set point of the output or added to the input is not known: say it",
            )),
            Some(Entry::SetPoint) if n_outputs != n_inputs => Err(SignalError::unfit(
                "loop",
                "a set point takes as many references as outputs",
            )),
            Some(entry) => Ok(entry),
        }
    }
}

/// Rows of the joint matrix.
#[derive(Clone, Copy)]
enum Rows {
    Input,
    Output,
}

impl Rows {
    /// The matrix that selects them.
    fn selector(self, n_rows: usize, n_inputs: usize) -> Matrix {
        let (from, count) = match self {
            Self::Input => (0, n_inputs),
            Self::Output => (n_inputs, n_rows - n_inputs),
        };
        DMatrix::from_fn(count, n_rows, |row, column| {
            Complex64::from(f64::from(u8::from(row + from == column)))
        })
    }
}

fn identity(size: usize) -> Matrix {
    DMatrix::identity(size, size)
}

/// The inverse, not a number of a singular matrix.
fn inverse(matrix: Matrix) -> Matrix {
    let size = matrix.nrows();
    let unknown = || DMatrix::from_element(size, size, Complex64::new(f64::NAN, f64::NAN));
    matrix.try_inverse().unwrap_or_else(unknown)
}

/// `factor J` of some rows.
fn selected(joint: &Matrix, n_inputs: usize, factor: Complex64, rows: Rows) -> Equation {
    let left = rows.selector(joint.nrows(), n_inputs) * factor;
    Equation {
        value: &left * joint,
        left,
        right: identity(n_inputs),
    }
}

/// `I - J` of some rows.
fn rest(joint: &Matrix, n_inputs: usize, rows: Rows) -> Equation {
    let negative = selected(joint, n_inputs, -Complex64::ONE, rows);
    Equation {
        value: identity(n_inputs) + &negative.value,
        ..negative
    }
}

/// `G = J_y J_u^-1`, `dG = [-G, I] dJ J_u^-1`.
fn plant(joint: &Matrix, n_inputs: usize) -> Equation {
    let [select_u, select_y] =
        [Rows::Input, Rows::Output].map(|rows| rows.selector(joint.nrows(), n_inputs));
    let right = inverse(&select_u * joint);
    let value = &select_y * joint * &right;
    Equation {
        left: &select_y - &value * &select_u,
        value,
        right,
    }
}

/// `L = (I - J_y)^-1 - I`, `dL = (I - J_y)^-1 dJ_y (I - J_y)^-1`.
fn loop_of_set_point(joint: &Matrix, n_inputs: usize) -> Equation {
    let inverse = inverse(rest(joint, n_inputs, Rows::Output).value);
    Equation {
        value: &inverse - identity(n_inputs),
        left: &inverse * Rows::Output.selector(joint.nrows(), n_inputs),
        right: inverse,
    }
}

/// `L = J_u^-1 - I`, `dL = -J_u^-1 dJ_u J_u^-1`.
fn loop_of_input(joint: &Matrix, n_inputs: usize) -> Equation {
    let select = Rows::Input.selector(joint.nrows(), n_inputs);
    let inverse = inverse(&select * joint);
    Equation {
        value: &inverse - identity(n_inputs),
        left: -&inverse * select,
        right: inverse,
    }
}
