//! Formats of an exported result: the table that the command line and its help go by. A format is a
//! file of this folder and a row here.

use std::path::Path;

use crate::atomic_write::Overwrite;
use crate::error::FileError;
use crate::result::csv::write_frf_csv;
use crate::result::mat::write_frf_mat;
use crate::result::npz::write_frf_npz;
use crate::result::result_file::ResultFile;

/// A format that results are exported to.
#[derive(Debug)]
pub struct Export {
    /// Its name, which is the usual ending of its files, too.
    pub name: &'static str,
    /// What it holds, and for whom.
    pub describes: &'static str,
    /// Writes a result.
    pub write: fn(&Path, Overwrite, &ResultFile) -> Result<(), FileError>,
}

/// The formats that results are exported to.
pub const EXPORTS: [Export; 3] = [
    Export {
        name: "csv",
        describes: "A row for each frequency, a column for each part of each entry",
        write: write_frf_csv,
    },
    Export {
        name: "npz",
        describes: "Arrays for numpy, with covariances",
        write: write_frf_npz,
    },
    Export {
        name: "mat",
        describes: "Arrays for MATLAB and Octave, with covariances",
        write: write_frf_mat,
    },
];
