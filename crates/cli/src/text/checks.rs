//! Checks of a measurement, as a table and as warnings.

use frfid_files::Check;

use crate::console::Console;
use crate::text::table::table;

/// What was checked and whether it holds, a row for each check.
pub(crate) fn checks_as_text(checks: &[Check]) -> String {
    let verdict = |passed: bool| if passed { "passed" } else { "FAILED" };
    let row = |check: &Check| {
        vec![
            format!("{}: {}", check.name, check.found),
            verdict(check.passed).to_owned(),
        ]
    };
    table(&checks.iter().map(row).collect::<Vec<_>>())
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
