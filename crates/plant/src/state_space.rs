//! State space models, the linear truth, and their exact FRFs under every hold.
//!
//! x' = A x + B u, y = C x + D u. With a sample-and-hold in front the sampled response is that of
//! `x[k+1] = Phi x[k] + Gamma_1 u[k] + Gamma_2 (u[k+1] - u[k])` (Gamma_2 = 0 for zoh), whose
//! matrices are blocks of one matrix exponential (Van Loan, IEEE Trans. Autom. Control 23 (1978)
//! 395).

use std::f64::consts::TAU;
use std::iter::zip;

use frfid_signals::checks::{positive, require_shape};
use frfid_signals::{Frf, SignalError};
use nalgebra::DMatrix;
use ndarray::Array3;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::elimination::Elimination;

/// What the plant's input does between samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hold {
    /// It is a continuous sinusoid: the FRF is that of the transfer function at s = j 2 pi f.
    Continuous,
    /// Zero-order hold: constant until the next sample.
    #[default]
    Zoh,
    /// First-order hold: a straight line to the next sample.
    Linear,
}

/// A continuous linear model x' = A x + B u, y = C x + D u.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// A, (state, state).
    pub a: DMatrix<f64>,
    /// B, (state, input).
    pub b: DMatrix<f64>,
    /// C, (output, state).
    pub c: DMatrix<f64>,
    /// D, (output, input).
    pub d: DMatrix<f64>,
}

impl StateSpace {
    /// The exact FRF at frequencies in Hz, seen through a hold of this sample time in s: C (p I -
    /// Phi)^-1 Gamma + D with p = s, Phi = A, Gamma = B when continuous, p = e^{s T}, Gamma =
    /// Gamma_1 + (p - 1) Gamma_2 behind a hold.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a frequency or sample time that is not finite and above 0, or
    /// a frequency at which the model has a pole; [`SignalError::Shape`] if the matrices do not
    /// fit.
    pub fn frf(&self, hz: &[f64], hold: Hold, sample_time_s: f64) -> Result<Frf, SignalError> {
        self.check()?;
        positive("sample_time_s", sample_time_s)?;
        let (phi, [gamma, lead]) = match hold {
            Hold::Continuous => (self.a.clone(), [self.b.clone(), self.b.map(|_| 0.0)]),
            Hold::Zoh | Hold::Linear => self.held(hold, sample_time_s),
        };
        let (outputs, inputs) = self.d.shape();
        let mut response = Array3::zeros((hz.len(), outputs, inputs));
        let mut states = Elimination::new(self.a.nrows(), inputs);
        for (&f, mut matrix) in zip(hz, response.outer_iter_mut()) {
            positive("hz", f)?;
            let s = Complex64::new(0.0, TAU * f);
            let p = if hold == Hold::Continuous {
                s
            } else {
                (s * sample_time_s).exp()
            };
            put_pencil(&mut states, p, &phi, [&gamma, &lead]);
            if !states.solve() {
                let needed = "a frequency at which the model has no pole";
                return Err(SignalError::parameter("hz", f, needed));
            }
            for ((output, input), value) in matrix.indexed_iter_mut() {
                let row = self.c.row(output);
                let seen = zip(row.iter(), 0..).map(|(c, state)| states.solution(state, input) * c);
                *value = seen.sum::<Complex64>() + self.d[(output, input)];
            }
        }
        Frf::new(hz.to_vec(), response)
    }

    /// The same model with some of its outputs, in the order given.
    pub(crate) fn of_outputs(self, outputs: &[usize]) -> Self {
        Self {
            c: self.c.select_rows(outputs),
            d: self.d.select_rows(outputs),
            ..self
        }
    }

    /// Phi and Gamma_1, Gamma_2 of the model sampled behind a hold.
    pub(crate) fn held(&self, hold: Hold, sample_time_s: f64) -> (DMatrix<f64>, [DMatrix<f64>; 2]) {
        let (n, m) = self.b.shape();
        let mut generator = DMatrix::zeros(n + 2 * m, n + 2 * m);
        generator
            .view_mut((0, 0), (n, n))
            .copy_from(&(&self.a * sample_time_s));
        generator
            .view_mut((0, n), (n, m))
            .copy_from(&(&self.b * sample_time_s));
        if hold == Hold::Linear {
            generator.view_mut((n, n + m), (m, m)).fill_with_identity();
        }
        let flow = generator.exp();
        let block = |column, width| flow.view((0, column), (n, width)).into_owned();
        (block(0, n), [block(n, m), block(n + m, m)])
    }

    fn check(&self) -> Result<(), SignalError> {
        let (n, (outputs, inputs)) = (self.a.nrows(), self.d.shape());
        let needed = [
            ("a", &self.a, (n, n)),
            ("b", &self.b, (n, inputs)),
            ("c", &self.c, (outputs, n)),
        ];
        needed.into_iter().try_for_each(|(name, matrix, shape)| {
            let (found, fits) = ([matrix.nrows(), matrix.ncols()], matrix.shape() == shape);
            require_shape(name, &found, fits, format_args!("{shape:?}"))
        })
    }
}

/// Puts [p I - Phi | Gamma_1 + (p - 1) Gamma_2] there, whose solution are the states per input in the
/// frequency domain.
fn put_pencil(
    there: &mut Elimination,
    p: Complex64,
    phi: &DMatrix<f64>,
    [gamma, lead]: [&DMatrix<f64>; 2],
) {
    let (n, inputs) = gamma.shape();
    for row in 0..n {
        for state in 0..n {
            let on_diagonal = if row == state { p } else { Complex64::ZERO };
            there.set(row, state, on_diagonal - phi[(row, state)]);
        }
        for input in 0..inputs {
            let held = gamma[(row, input)] + (p - 1.0) * lead[(row, input)];
            there.set(row, n + input, held);
        }
    }
}
