//! Matrices line by line, and the array `(frequency, output, input)` that holds them in an FRF.

use std::borrow::Borrow;

use frfid_signals::room::room_for;
use frfid_signals::{Frf, SignalError};
use nalgebra::{DMatrix, DVector};
use ndarray::{Array3, ArrayView1, ArrayView2};
use num_complex::Complex64;

/// A complex matrix: channels of one line, or entries of an FRF.
pub(crate) type Matrix = DMatrix<Complex64>;

/// Refuses FRFs whose covariances, of all entries with each other, cannot be held.
pub(crate) fn room_for_covariances(
    n_lines: usize,
    n_outputs: usize,
    n_inputs: usize,
) -> Result<(), SignalError> {
    let n_entries = n_outputs.saturating_mul(n_inputs);
    let quantity = "number of values of the covariances of all outputs and inputs on all lines";
    room_for("channels", quantity, &[2, n_lines, n_entries, n_entries])
}

/// Matrices of one shape, at least one, as an array `(line, row, column)`.
pub(crate) fn stacked(matrices: &[impl Borrow<Matrix>]) -> Array3<Complex64> {
    let (n_rows, n_columns) = matrices[0].borrow().shape();
    let shape = (matrices.len(), n_rows, n_columns);
    Array3::from_shape_fn(shape, |(line, row, column)| {
        matrices[line].borrow()[(row, column)]
    })
}

/// The matrices of an FRF.
pub(crate) fn matrices(frf: &Frf) -> Vec<Matrix> {
    frf.response.outer_iter().map(matrix).collect()
}

/// An array as a matrix.
pub(crate) fn matrix(array: ArrayView2<Complex64>) -> Matrix {
    DMatrix::from_fn(array.nrows(), array.ncols(), |row, column| {
        array[[row, column]]
    })
}

/// An array as a vector.
pub(crate) fn vector(array: ArrayView1<Complex64>) -> DVector<Complex64> {
    DVector::from_iterator(array.len(), array.into_iter().copied())
}
