//! Random matrices and words of errors for the tests of this crate.

use std::fmt::Display;

use frfid_signals::random::{normal, stream};
use nalgebra::DMatrix;
use num_complex::Complex64;

/// Matrix of standard normal real and imaginary parts.
pub(crate) fn complex(n_rows: usize, n_columns: usize, seed: u64) -> DMatrix<Complex64> {
    let mut rng = stream(seed, "matrix", &[]);
    DMatrix::from_fn(n_rows, n_columns, |_, _| {
        Complex64::new(normal(&mut rng), normal(&mut rng))
    })
}

/// Random unitary matrix.
pub(crate) fn unitary(n: usize, seed: u64) -> DMatrix<Complex64> {
    complex(n, n, seed).qr().q()
}

/// The sentence with which a result refuses.
pub(crate) fn refusal<T, E: Display>(result: Result<T, E>) -> String {
    result.err().expect("refused").to_string()
}
