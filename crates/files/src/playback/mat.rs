//! MAT file of playbacks, level 5: for Simulink, MATLAB and Octave.

use std::io::{self, Write};
use std::path::Path;

use ndarray::{Array1, Array2, Axis};

use crate::atomic_write::{Overwrite, write_file};
use crate::error::FileError;
use crate::mat_write::{header, number, reals, row_of, texts};
use crate::playback::PlaybackFile;

/// Writes `from_file` first, which has time in row 1 and a row for each column of the CSV behind `plan_id`, as
/// Simulink's From File wants it; then `table`, the same with time in the first column, as From Workspace does;
/// `time`, and `position`, `velocity`, `acceleration` or `effort`, each `(sample, joint)`; what the columns are, `k`,
/// `plan_id`, `run` and `rate_hz`.
///
/// # Errors
/// [`FileError::Shape`] for what does not fit together; those of writing (see [`Overwrite`]); an array of 2 GiB or
/// more, which the format cannot hold.
pub(crate) fn write_playback_mat(
    path: &Path,
    overwrite: Overwrite,
    file: &PlaybackFile,
) -> Result<(), FileError> {
    file.check()?;
    write_file(path, overwrite, |to| {
        Ok(to.write_all(&file.elements()?.concat())?)
    })
}

impl PlaybackFile {
    fn elements(&self) -> io::Result<Vec<Vec<u8>>> {
        let table = self.table();
        let time = table.column(0);
        let mut elements = vec![
            header(),
            reals("from_file", table.t().into_dyn())?,
            reals("table", table.view().into_dyn())?,
            reals("time", time.into_dyn())?,
        ];
        elements.extend(self.signals_of(&table)?);
        let k = Array1::from_iter((0..table.nrows()).map(|k| k as f64));
        elements.extend([
            texts("columns", &self.names())?,
            reals("k", k.view().into_dyn())?,
            number("plan_id", self.plan_id.into())?,
            row_of("run", &self.name)?,
            number("rate_hz", self.rate_hz())?,
        ]);
        Ok(elements)
    }

    /// Names of the columns of the table.
    fn names(&self) -> Vec<String> {
        let columns = self.columns().into_iter().map(|column| column.name);
        ["time_s".to_owned()].into_iter().chain(columns).collect()
    }

    /// Time and every column, `(sample, column)`.
    fn table(&self) -> Array2<f64> {
        let columns = self.columns();
        let mut table = Array2::zeros((self.n_samples(), 1 + columns.len()));
        let rows = table.rows_mut().into_iter().zip(self.samples());
        for (k, (mut row, (playback, sample))) in rows.enumerate() {
            row[0] = k as f64 / self.rate_hz();
            for (cell, column) in row.iter_mut().skip(1).zip(&columns) {
                *cell = column.value(playback, sample);
            }
        }
        table
    }

    /// Each quantity on its own, `(sample, joint)`.
    fn signals_of(&self, table: &Array2<f64>) -> io::Result<Vec<Vec<u8>>> {
        let names: &[&str] = if self.is_torque() {
            &["effort"]
        } else {
            &["position", "velocity", "acceleration"]
        };
        let signal = |(place, name): (usize, &&str)| {
            let joints = (0..self.joint_names.len()).map(|joint| 1 + joint * names.len() + place);
            reals(
                name,
                table
                    .select(Axis(1), &joints.collect::<Vec<_>>())
                    .view()
                    .into_dyn(),
            )
        };
        names.iter().enumerate().map(signal).collect()
    }
}
