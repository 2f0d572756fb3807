//! Faults of a description: what is wrong in a table, and where.

use frfid_signals::SignalError;

use crate::description::text::ConfigError;

/// What is wrong in a table, and where: keys from that table inwards, in lists the number from 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Fault {
    pub(crate) path: Vec<String>,
    pub(crate) message: String,
}

impl Fault {
    pub(crate) fn new(path: &[&str], message: impl Into<String>) -> Self {
        let path = path.iter().map(|&key| key.to_owned()).collect();
        Self {
            path,
            message: message.into(),
        }
    }

    /// A numeric crate's complaint about the table of this key.
    pub(crate) fn in_table(key: &str) -> impl Fn(SignalError) -> Self {
        move |error| Self::from(error).within(&[key])
    }

    /// The same fault seen from farther out: the table lies at `path`.
    pub(crate) fn within(mut self, path: &[&str]) -> Self {
        self.path
            .splice(0..0, path.iter().map(|&key| key.to_owned()));
        self
    }

    /// The same fault at another place.
    pub(crate) fn at(self, path: &[&str]) -> Self {
        Self::new(path, self.message)
    }

    /// The same fault seen from the table of this key, or as it is where it does not lie in it.
    pub(crate) fn inside(mut self, key: &str) -> Result<Self, Self> {
        if self.path.first().is_none_or(|first| first != key) {
            return Err(self);
        }
        self.path.remove(0);
        Ok(self)
    }

    /// The fault as an error, where no text shows its place.
    pub(crate) fn without_text(self, name: &str) -> ConfigError {
        let file = name.to_owned();
        ConfigError {
            file,
            place: None,
            message: self.message,
        }
    }

    /// The same fault, the message saying of which part it is.
    pub(crate) fn of(self, part: &str) -> Self {
        let message = format!("{part}: {}", self.message);
        Self { message, ..self }
    }
}

/// The names of the fields are the keys of the tables.
impl From<SignalError> for Fault {
    fn from(error: SignalError) -> Self {
        Self::new(&error.path(), error.to_string())
    }
}

/// Refuses a list that has not one entry for each axis.
pub(crate) fn check_entries(
    key: &str,
    found: usize,
    needed: usize,
    axes: &str,
) -> Result<(), String> {
    if found == needed {
        return Ok(());
    }
    Err(format!(
        "{key} has {found} entries, needed: one for each of the {needed} {axes}"
    ))
}
