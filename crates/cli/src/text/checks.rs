//! Checks of a measurement, as a table and as warnings.

use frfid_files::Check;

use crate::console::Console;
use crate::text::table::{row, table};

/// What was checked and whether it holds, a row for each check.
pub(crate) fn checks_as_text(checks: &[Check]) -> String {
    let rows = checks.iter().map(|check| {
        let verdict = if check.passed { "passed" } else { "FAILED" };
        row([&format!("{}: {}", check.name, check.found), verdict])
    });
    table(&rows.collect::<Vec<_>>())
}

/// Warns of every check that failed, with what to do.
pub(crate) fn warn_of_failed(checks: &[Check], console: &mut Console) {
    for Check {
        name,
        found,
        needed,
        advice,
        ..
    } in checks.iter().filter(|check| !check.passed)
    {
        console.warning(format_args!("{name}: {found}, needed {needed}; {advice}"));
    }
}
