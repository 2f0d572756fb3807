//! Table of a report.

/// A table of text: numbers beside numbers of the paper.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// Title above the table.
    pub title: String,
    /// Heads of the columns, that of the rows' names first.
    pub columns: Vec<String>,
    /// Rows: a name and the cells behind it.
    pub rows: Vec<(String, Vec<String>)>,
}
