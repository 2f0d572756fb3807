//! Recording as a reader of one format delivers it: series of samples with their stamps, not yet on
//! one clock.

use crate::error::FileError;

/// The samples of the signals of one topic, or of columns of one table, as they were recorded, with
/// their stamps.
#[derive(Debug, Default)]
pub(crate) struct Series {
    pub(crate) topic: String,
    /// Whether the stamps are the recorder's, as the messages have none of their own.
    pub(crate) is_recorders: bool,
    pub(crate) stamps_ns: Vec<i64>,
    /// Which signals, by their place among all signals of the map.
    pub(crate) signals: Vec<usize>,
    /// The values of each signal, one for each stamp; NaN where a row does not have it.
    pub(crate) columns: Vec<Vec<f64>>,
}

impl Series {
    /// Takes in a row.
    pub(crate) fn push(&mut self, stamp_ns: i64, row: &Cells) {
        self.stamps_ns.push(stamp_ns);
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.push(value.unwrap_or(f64::NAN));
        }
    }

    /// Whether the row before this one has the same stamp and values.
    pub(crate) fn is_copy(&self, row: usize) -> bool {
        let repeats = |column: &Vec<f64>| column[row].to_bits() == column[row - 1].to_bits();
        repeats_stamp(&self.stamps_ns, row) && self.columns.iter().all(repeats)
    }

    /// Puts the rows of these places, in this order, in place of all.
    pub(crate) fn rearrange(&mut self, places: &[usize]) {
        self.stamps_ns = picked(&self.stamps_ns, places);
        for column in &mut self.columns {
            *column = picked(column, places);
        }
    }
}

/// Whether there is such a row and the one before it has the same stamp.
pub(crate) fn repeats_stamp(stamps_ns: &[i64], row: usize) -> bool {
    row > 0 && stamps_ns.get(row) == stamps_ns.get(row - 1)
}

/// The entries of these places.
pub(crate) fn picked<T: Copy>(list: &[T], places: &[usize]) -> Vec<T> {
    places.iter().map(|place| list[*place]).collect()
}

/// A row: the number of each signal, none where the row does not have it.
pub(crate) type Cells = [Option<f64>];

/// Damage to a file, with its time in ns where that is known.
pub(crate) type TimedDamage = (Option<i64>, String);

/// What a reader of one format delivers.
#[derive(Debug, Default)]
pub(crate) struct Recording {
    pub(crate) series: Vec<Series>,
    pub(crate) damages: Vec<TimedDamage>,
    pub(crate) warnings: Vec<String>,
}

/// The error of a file, with the first damage to it: that may be the reason.
pub(crate) fn of_damaged(error: FileError, damages: &[TimedDamage]) -> FileError {
    error.beside(damages.first().map(|(_, reason)| reason.as_str()))
}
