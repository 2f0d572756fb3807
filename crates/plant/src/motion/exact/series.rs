//! Taylor series of a motion within a mode, whose equations are linear: exact but for rounding.

use crate::joint::flexible_joint::Regime;
use crate::motion::equations::{Equations, State};
use crate::motion::links::Links;

/// Most terms of a series.
const MOST_TERMS: usize = 20;

/// How many terms of the exponential series leave less than a rounding for a matrix of this norm.
pub(crate) fn n_terms(norm: f64) -> usize {
    let (mut n_terms, mut term) = (1, norm);
    while term > 0.25 * f64::EPSILON && n_terms < MOST_TERMS {
        n_terms += 1;
        term *= norm / n_terms as f64;
    }
    n_terms
}

/// What a motion adds to its start over a share theta of a duration: sum of c_k theta^k, k = 1, 2, ...
#[derive(Debug, Clone)]
pub(crate) struct Series<const A: usize> {
    terms: [State<f64, A>; MOST_TERMS],
    n_terms: usize,
}

impl<const A: usize> Series<A> {
    /// From the derivative at the start, and the torques' change in N m over the duration in s:
    /// c_1 = T x', (k + 1) c_(k + 1) = T (A c_k + B u_k), as x' = A x + B u + constant.
    pub(crate) fn of<K: Links<A>>(
        equations: &Equations<f64, K, A>,
        regimes: &[Regime<f64>; A],
        derivative: &State<f64, A>,
        mut torque: [f64; A],
        duration_s: f64,
        n_terms: usize,
    ) -> Self {
        let linear = regimes.map(|regime| regime.linear());
        let zero = State::zero();
        let mut terms = [zero; MOST_TERMS];
        terms[0] = zero.along(derivative, duration_s);
        for k in 1..n_terms {
            let rate = equations.derivative(&linear, &torque, &terms[k - 1]);
            terms[k] = zero.along(&rate, duration_s / (k + 1) as f64);
            torque = [0.0; A];
        }
        Self { terms, n_terms }
    }

    /// The state after a share of the duration.
    pub(crate) fn after(&self, theta: f64, start: &State<f64, A>) -> State<f64, A> {
        let mut sum = State::zero();
        for term in self.terms[..self.n_terms].iter().rev() {
            sum = term.along(&sum, theta);
        }
        start.along(&sum, theta)
    }
}
