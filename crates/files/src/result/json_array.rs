//! Arrays in JSON: flat, last axis first to change, with their shape beside them; complex ones as
//! `re` and `im`, or packed.

use ndarray::{Array, Array1, Dimension, IntoDimension};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::result::float::Number;
use crate::result::packed_numbers::{is_packed, packed, unpacked};

/// What is wrong with an array: its name, found, needed.
pub(crate) type Flaw = (&'static str, String, String);

/// Real numbers.
#[derive(Serialize, Deserialize)]
pub(crate) struct Reals {
    shape: Vec<usize>,
    data: Vec<Number>,
}

/// Complex numbers: `re` and `im`, or all packed where they are many.
#[derive(Serialize, Deserialize)]
pub(crate) struct Complexes {
    shape: Vec<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    re: Option<Vec<Number>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    im: Option<Vec<Number>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    zlib: Option<String>,
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
        let is_packed = is_packed(values.len());
        let plain = |part: fn(&Complex64) -> f64| {
            let numbers = || values.iter().map(|value| Number(part(value))).collect();
            (!is_packed).then(numbers)
        };
        Self {
            shape: values.shape().to_vec(),
            re: plain(|value| value.re),
            im: plain(|value| value.im),
            zlib: is_packed.then(|| packed(values.iter().copied())),
        }
    }

    pub(crate) fn into_array<D: Dimension>(
        self,
        what: &'static str,
    ) -> Result<Array<Complex64, D>, Flaw> {
        let data = match (self.re, self.im, self.zlib) {
            (Some(re), Some(im), None) => joined(what, re, im)?,
            (None, None, Some(zlib)) => unpacked(&zlib).ok_or_else(|| damaged(what))?,
            _ => return Err(without_numbers(what)),
        };
        shaped(what, &self.shape, data)
    }
}

/// Complex numbers of their parts.
fn joined(what: &'static str, re: Vec<Number>, im: Vec<Number>) -> Result<Vec<Complex64>, Flaw> {
    let (n_re, n_im) = (re.len(), im.len());
    if n_re != n_im {
        let found = format!("{n_re} real and {n_im} imaginary parts");
        return Err((what, found, "as many of each".into()));
    }
    let parts = re.into_iter().zip(im);
    Ok(parts.map(|(re, im)| Complex64::new(re.0, im.0)).collect())
}

fn without_numbers(what: &'static str) -> Flaw {
    let needed = "either re and im, or zlib";
    (what, "other keys".to_owned(), needed.into())
}

fn damaged(what: &'static str) -> Flaw {
    let found = "numbers that cannot be unpacked".to_owned();
    (what, found, "base64 of zlib of complex128".into())
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
