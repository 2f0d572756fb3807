//! The command line.

use std::ffi::OsString;
use std::io::{stderr, stdout};

use pyo3::prelude::*;

/// Runs the command ``frfid``; see ``frfid --help``.
///
/// Parameters
/// ----------
/// args : sequence of str
///     The arguments, the program's name first: ``sys.argv``.
///
/// Returns
/// -------
/// int
///     The exit code: 0 done, 1 failed, 2 usage or configuration, 3 done but data was lost or a
///     check failed, 130 interrupted.
#[pyfunction]
pub(crate) fn cli(py: Python<'_>, args: Vec<OsString>) -> i32 {
    py.detach(|| frfid_cli::main(args, &mut stdout(), &mut stderr()))
}
