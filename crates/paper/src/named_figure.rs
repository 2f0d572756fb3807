//! Figure with its file name and its caption.

use frfid_report::Figure;

/// A figure with its file name (without ending) and its caption.
#[derive(Debug, Clone)]
pub struct Named {
    /// File name without ending.
    pub name: &'static str,
    /// Caption.
    pub caption: String,
    /// The figure.
    pub figure: Figure,
}

impl Named {
    pub(crate) fn new(name: &'static str, caption: impl Into<String>, figure: Figure) -> Self {
        Self {
            name,
            caption: caption.into(),
            figure,
        }
    }

    /// The figure as a section of the page has it.
    pub(crate) fn captioned(&self) -> (String, Figure) {
        (self.caption.clone(), self.figure.clone())
    }
}
