//! Arrays in JSON: flat, last axis first to change, with their shape beside them; complex ones as
//! `re` and `im`.

use ndarray::{Array, Array1, Dimension, IntoDimension};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::result::float::Number;

/// What is wrong with an array: its name, found, needed.
pub(crate) type Flaw = (&'static str, String, String);

#[derive(Serialize, Deserialize)]
pub(crate) struct Reals {
    shape: Vec<usize>,
    data: Vec<Number>,
}

#[derive(Serialize, Deserialize)]
pub(crate) struct Complexes {
    shape: Vec<usize>,
    re: Vec<Number>,
    im: Vec<Number>,
}

impl Reals {
    pub(crate) fn of(values: &[f64]) -> Self {
        Self {
            shape: vec![values.len()],
            data: values.iter().map(|&value| Number(value)).collect(),
        }
    }

    pub(crate) fn of_array<D: Dimension>(values: &Array<f64, D>) -> Self {
        Self {
            shape: values.shape().to_vec(),
            data: values.iter().map(|&value| Number(value)).collect(),
        }
    }

    pub(crate) fn into_array<D: Dimension>(
        self,
        what: &'static str,
    ) -> Result<Array<f64, D>, Flaw> {
        let data = self.data.into_iter().map(|number| number.0);
        shaped(what, &self.shape, data.collect())
    }

    pub(crate) fn into_list(self, what: &'static str) -> Result<Vec<f64>, Flaw> {
        self.into_array(what)
            .map(|array: Array1<f64>| array.to_vec())
    }
}

impl Complexes {
    pub(crate) fn of<D: Dimension>(values: &Array<Complex64, D>) -> Self {
        Self {
            shape: values.shape().to_vec(),
            re: values.iter().map(|value| Number(value.re)).collect(),
            im: values.iter().map(|value| Number(value.im)).collect(),
        }
    }

    pub(crate) fn into_array<D: Dimension>(
        self,
        what: &'static str,
    ) -> Result<Array<Complex64, D>, Flaw> {
        let (n_re, n_im) = (self.re.len(), self.im.len());
        if n_re != n_im {
            let found = format!("{n_re} real and {n_im} imaginary parts");
            return Err((what, found, "as many of each".into()));
        }
        let parts = self.re.into_iter().zip(self.im);
        let data = parts.map(|(re, im)| Complex64::new(re.0, im.0));
        shaped(what, &self.shape, data.collect())
    }
}

/// The array of this shape, if the numbers are as many and the axes as many as the array must have.
fn shaped<T, D: Dimension>(
    what: &'static str,
    shape: &[usize],
    data: Vec<T>,
) -> Result<Array<T, D>, Flaw> {
    let found = format!("shape {shape:?} for {} numbers", data.len());
    let array = Array::from_shape_vec(shape.into_dimension(), data);
    let array = array.and_then(Array::into_dimensionality);
    array.map_err(|_| (what, found, "a shape that fits".into()))
}
