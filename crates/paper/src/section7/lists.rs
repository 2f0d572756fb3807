//! Lists of numbers in texts and tables.

use std::borrow::Borrow;

/// Numbers separated by commas.
pub(crate) fn list(values: impl IntoIterator<Item = impl Borrow<f64>>, decimals: usize) -> String {
    let values = values.into_iter();
    joined(values.map(|value| format!("{:.decimals$}", value.borrow())))
}

/// Texts separated by commas.
pub(crate) fn joined(texts: impl Iterator<Item = String>) -> String {
    texts.collect::<Vec<_>>().join(", ")
}
