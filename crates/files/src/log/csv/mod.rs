//! CSV recordings as the world writes them: any separator, decimal mark, encoding, header; plain or gzipped.

mod cells;
pub(crate) mod dialect;
mod group;
mod header;
pub(crate) mod listing;
mod moment;
mod row;
mod rows;
mod scope;
mod squeezed;
#[cfg(test)]
mod tests;
mod text;

use std::path::Path;

use crate::error::FileError;
use crate::log::csv::dialect::Dialect;
use crate::log::csv::rows::Rows;
use crate::log::csv::text::{Text, check_length};
use crate::log::map::{LogMap, Signals};
use crate::log::recording::Recording;

/// Reads the mapped columns. A row that breaks off, and everything behind it, is reported as
/// damage.
pub(crate) fn read(path: &Path, map: &LogMap, signals: &Signals) -> Result<Recording, FileError> {
    let stated = map.csv.clone().unwrap_or_default();
    check_length(path)?;
    let text = Text::open(path, stated.encoding.as_deref())?;
    let mapped = signals.iter().copied().chain(&map.time);
    let mapped: Vec<&str> = mapped.map(|signal| signal.source.as_str()).collect();
    let dialect = Dialect::of(path, whole_lines(&text), &stated, &mapped)?;
    let told = dialect.told(text.encoding);
    let timed = dialect.is_scope.then(|| scope::with_times(map));
    let mut rows = Rows::of(path, &dialect, timed.as_ref().unwrap_or(map), signals)?;
    rows.take_all(text)?;
    let mut recording = rows.recording(signals)?;
    recording.warnings.extend(told);
    Ok(recording)
}

/// The head of a text without a line that its end cuts apart.
fn whole_lines(text: &Text) -> &str {
    let end = text.head.rfind('\n').map_or(0, |place| place + 1);
    if text.is_whole {
        &text.head
    } else {
        &text.head[..end]
    }
}
