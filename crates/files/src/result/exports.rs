//! Formats of an exported result: the table that the command line and its help go by. A format is a
//! file of this folder and a row here.

use std::path::Path;

use crate::atomic_write::Overwrite;
use crate::error::FileError;
use crate::result::csv::write_frf_csv;
use crate::result::mat::write_frf_mat;
use crate::result::npz::write_frf_npz;
use crate::result::result_file::ResultFile;
use crate::result::uff::write_frf_uff;

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

impl Export {
    /// The format that a file's ending names, in capitals or not.
    #[must_use]
    pub fn of_suffix(path: &Path) -> Option<&'static Self> {
        let suffix = path.extension()?;
        EXPORTS
            .iter()
            .find(|export| suffix.eq_ignore_ascii_case(export.name))
    }
}

/// The formats that results are exported to.
pub const EXPORTS: [Export; 4] = [
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
    Export {
        name: "uff",
        describes: "Universal file, dataset 58, for programs of modal analysis, with variances",
        write: write_frf_uff,
    },
];
