//! State space models, the linear truth, and their exact FRFs under every hold.
//!
//! x' = A x + B u, y = C x + D u. With a sample-and-hold in front the sampled response is that of
//! `x[k+1] = Phi x[k] + Gamma_1 u[k] + Gamma_2 (u[k+1] - u[k])` (Gamma_2 = 0 for zoh), whose
//! matrices are blocks of one matrix exponential (Van Loan, IEEE Trans. Autom. Control 23 (1978)
//! 395).

use std::f64::consts::TAU;

use frfid_signals::checks::{positive, require_shape};
use frfid_signals::{Frf, SignalError};
use nalgebra::DMatrix;
use ndarray::{Array3, Axis};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

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
        for (line, &f) in hz.iter().enumerate() {
            positive("hz", f)?;
            let s = Complex64::new(0.0, TAU * f);
            let p = if hold == Hold::Continuous {
                s
            } else {
                (s * sample_time_s).exp()
            };
            let needed = "a frequency at which the model has no pole";
            let states = states_at(p, &phi, [&gamma, &lead])
                .ok_or(SignalError::parameter("hz", f, needed))?;
            let matrix = self.c.map(Complex64::from) * states + self.d.map(Complex64::from);
            put_line(&mut response, line, &matrix);
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

/// States per input in the frequency domain: (p I - Phi)^-1 (Gamma_1 + (p - 1) Gamma_2); `None` at
/// a pole.
fn states_at(
    p: Complex64,
    phi: &DMatrix<f64>,
    [gamma, lead]: [&DMatrix<f64>; 2],
) -> Option<DMatrix<Complex64>> {
    let n = phi.nrows();
    let pencil = DMatrix::from_diagonal_element(n, n, p) - phi.map(Complex64::from);
    let drive = gamma.zip_map(lead, |gamma, lead| gamma + (p - 1.0) * lead);
    pencil.lu().solve(&drive)
}

/// Puts a matrix into a response `(frequency, output, input)` at one of its frequencies.
pub(crate) fn put_line(response: &mut Array3<Complex64>, line: usize, matrix: &DMatrix<Complex64>) {
    let mut there = response.index_axis_mut(Axis(0), line);
    for ((output, input), value) in there.indexed_iter_mut() {
        *value = matrix[(output, input)];
    }
}
