//! Provenance of a report: folded, as it is long and seldom read.

use crate::page::pieces::{Row, escaped, folded, table};

/// Longer values, or of more lines, are folded once more.
const LONG: usize = 200;

/// How the names of hashes of runs begin.
const HASH: &str = "sha256 of ";

/// The folded section, or nothing where nothing is known.
pub(crate) fn provenance_html(provenance: &[(String, String)]) -> String {
    let (hashes, others): (Vec<_>, Vec<_>) = provenance
        .iter()
        .partition(|(name, _)| name.starts_with(HASH));
    let (long, short): (Vec<_>, Vec<_>) = others
        .into_iter()
        .partition(|(_, value)| value.len() > LONG || value.lines().count() > 3);
    let short = short
        .iter()
        .map(|(name, value)| (name.clone(), vec![escaped(value)]));
    let long = long
        .iter()
        .map(|(name, value)| folded(name, &format!("<pre>{}</pre>\n", escaped(value))));
    let content = table(&[], short) + &long.collect::<String>() + &hashes_html(&hashes);
    folded("Provenance: where this comes from", &content)
}

/// Every file with its hash, folded.
fn hashes_html(hashes: &[&(String, String)]) -> String {
    let files = match hashes.len() {
        1 => "1 file".to_owned(),
        files => format!("{files} files"),
    };
    let rows = hashes.iter().map(|(name, hash)| -> Row {
        let file = name.strip_prefix(HASH).unwrap_or(name);
        (file.to_owned(), vec![escaped(hash)])
    });
    folded(
        &format!("SHA-256 of {files}"),
        &table(&["File", "SHA-256"], rows),
    )
}
