//! TOML texts, and errors that point into them: file, line, caret, reason and remedy.

use std::fmt;
use std::ops::Range;
use std::path::Path;

use frfid_files::FileKind;
use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::description::fault::Fault;
use crate::description::misspelt::with_suggestion;

/// A configuration text and the name it goes by in messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TomlText {
    /// File name, or another name for texts that are no file.
    pub name: String,
    /// The TOML text.
    pub text: String,
}

/// What is wrong in a configuration, with the place if one can be named.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigError {
    /// File name.
    pub file: String,
    /// Where: line and column from 1, the line's text, and how many columns to underline.
    pub place: Option<TextSpan>,
    /// What was found, what was needed, what to do.
    pub message: String,
}

/// A place in a configuration text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextSpan {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Text of that line.
    pub text: String,
    /// Number of characters to underline, at least 1.
    pub width: usize,
}

impl std::error::Error for ConfigError {}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(TextSpan {
            line,
            column,
            text,
            width,
        }) = &self.place
        else {
            return write!(f, "{}: {}", self.file, self.message);
        };
        let margin = " ".repeat(line.to_string().len());
        let indent = blanked(text, column - 1);
        writeln!(f, "{}:{line}:{column}: {}", self.file, self.message)?;
        writeln!(f, "{margin} |\n{line} | {text}")?;
        write!(f, "{margin} | {indent}{}", "^".repeat(*width))
    }
}

/// What is said of a folder or of a file of bytes where a text is needed; `None` of any other.
fn not_a_text(path: &Path) -> Option<String> {
    let (found, advice) = match FileKind::of(path).ok()? {
        FileKind::Empty | FileKind::Text => return None,
        FileKind::Folder => ("a folder", "name a file in it"),
        kind => (kind.name(), "give another file"),
    };
    Some(format!("found {found}, needed a text; {advice}"))
}

/// Blanks in the place of the first characters; tabs are kept, so that a caret behind them stands
/// under its column whatever their width.
fn blanked(text: &str, n_characters: usize) -> String {
    let first = text.chars().take(n_characters);
    first.map(|c| if c == '\t' { '\t' } else { ' ' }).collect()
}

impl TomlText {
    /// A text and the name it goes by.
    #[must_use]
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let (name, text) = (name.into(), text.into());
        Self { name, text }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`ConfigError`] with the operating system's reason, or that the file is not UTF-8.
    pub fn read(path: &Path) -> Result<Self, ConfigError> {
        let name = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| {
            let message = not_a_text(path).unwrap_or_else(|| format!("cannot read: {error}"));
            Fault::new(&[], message).without_text(&name)
        })?;
        Ok(Self { name, text })
    }

    /// The description that travelled in the file at `path`.
    pub(crate) fn travelled_in(path: &Path, text: String) -> Self {
        Self::new(format!("experiment.toml in {}", path.display()), text)
    }

    /// Reads the text into `T`: unknown keys, missing keys and wrong types are errors with their
    /// place.
    ///
    /// # Errors
    /// [`ConfigError`].
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, ConfigError> {
        toml::from_str(&self.text).map_err(|error| self.not_read(&error))
    }

    /// The reader's complaint.
    fn not_read(&self, error: &toml::de::Error) -> ConfigError {
        self.error_at(error.span(), with_suggestion(error.message().trim()))
    }

    /// As [`TomlText::parse`]; the tables of these names are enums, of which their key `kind` names
    /// the variant, or the second name where there is none.
    ///
    /// Serde's own internally tagged enums read a table into a buffer and lose where its values
    /// stand. So the kind is taken out, and the rest put behind it, as an externally tagged enum
    /// has it.
    pub(crate) fn parse_kinds<T: DeserializeOwned>(
        &self,
        tables: &[(&str, &'static str)],
    ) -> Result<T, ConfigError> {
        let mut root = DeTable::parse(&self.text).map_err(|error| self.not_read(&error))?;
        for &(table, default) in tables {
            if let Some(value) = root.get_mut().get_mut(table) {
                put_behind_kind(value, default).map_err(|span| {
                    let needed = "needed: the name of a kind, in quotes";
                    self.error_at(Some(span), needed.to_owned())
                })?;
            }
        }
        T::deserialize(toml::Deserializer::from(root)).map_err(|error| self.not_read(&error))
    }

    /// An error at the value of `path` (keys from the outermost table inwards, in lists the number
    /// from 0), or at the innermost of its tables that exists.
    #[must_use]
    pub fn error(&self, path: &[&str], message: impl Into<String>) -> ConfigError {
        self.error_at(self.span_of(path), message.into())
    }

    /// The fault of a table at `table`, with its place.
    pub(crate) fn locate(&self, table: &[&str], fault: impl Into<Fault>) -> ConfigError {
        let Fault { path, message } = fault.into().within(table);
        self.error_at(self.span_of(&path), message)
    }

    fn error_at(&self, span: Option<Range<usize>>, message: String) -> ConfigError {
        ConfigError {
            file: self.name.clone(),
            place: span
                .filter(|span| !span.is_empty())
                .map(|span| self.place(&span)),
            message,
        }
    }

    fn span_of(&self, path: &[impl AsRef<str>]) -> Option<Range<usize>> {
        self.walk(path).pop()
    }

    /// Spans along `path` as far as it exists: of the name for a table, of the value otherwise.
    fn walk(&self, path: &[impl AsRef<str>]) -> Vec<Range<usize>> {
        let Ok(root) = DeTable::parse(&self.text) else {
            return Vec::new();
        };
        let root = DeValue::Table(root.into_inner());
        let (mut outer, mut spans) = (&root, Vec::new());
        for key in path {
            let Some((name, value)) = entry(outer, key.as_ref()) else {
                break;
            };
            outer = value.get_ref();
            spans.push(if outer.is_table() { name } else { value.span() });
        }
        spans
    }

    /// Where the line at an index of the text begins, and its text.
    fn line_at(&self, index: usize) -> (usize, &str) {
        let start = self.text[..index]
            .rfind('\n')
            .map_or(0, |newline| newline + 1);
        (start, self.text[start..].lines().next().unwrap_or_default())
    }

    fn place(&self, span: &Range<usize>) -> TextSpan {
        let (start, text) = self.line_at(span.start);
        let marked = self.text.get(span.start..span.end.min(start + text.len()));
        TextSpan {
            line: 1 + self.text[..start].matches('\n').count(),
            column: 1 + self.text[start..span.start].chars().count(),
            width: marked.map_or(1, |marked| marked.chars().count().max(1)),
            text: text.to_owned(),
        }
    }
}

/// The value of a key, in a list of a number, and the place of its name. A table of a list has no
/// name of its own: the place of its header, or of its brace.
fn entry<'a, 'v>(
    outer: &'v DeValue<'a>,
    key: &str,
) -> Option<(Range<usize>, &'v Spanned<DeValue<'a>>)> {
    match outer {
        DeValue::Table(table) => {
            let (name, value) = table.iter().find(|(name, _)| name.get_ref() == key)?;
            Some((name.span(), value))
        }
        DeValue::Array(list) => {
            let value = list.get(key.parse::<usize>().ok()?)?;
            Some((value.span(), value))
        }
        _ => None,
    }
}

/// Makes { kind = "a", x = 1 } to { a = { x = 1 } }, or returns the place of a kind that is no
/// text. Anything but a table is left to whoever reads it.
fn put_behind_kind(
    value: &mut Spanned<DeValue>,
    default: &'static str,
) -> Result<(), Range<usize>> {
    let span = value.span();
    let DeValue::Table(table) = value.get_mut() else {
        return Ok(());
    };
    let name = match table.get("kind").map(|kind| (kind.span(), kind.get_ref())) {
        Some((span, DeValue::String(kind))) => Spanned::new(span, kind.clone()),
        Some((span, _)) => return Err(span),
        None => Spanned::new(span.clone(), default.into()),
    };
    table.remove("kind");
    let rest = Spanned::new(span, DeValue::Table(std::mem::take(table)));
    table.insert(name, rest);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code)]
    struct Table {
        peak_nm: f64,
    }

    fn toml(text: &str) -> TomlText {
        TomlText {
            name: "x.toml".into(),
            text: text.into(),
        }
    }

    #[test]
    fn an_unknown_key_is_underlined_and_the_known_ones_are_named() {
        let error = toml("# comment\npeak_Nm = 3.0\n")
            .parse::<Table>()
            .expect_err("misspelt")
            .to_string();
        assert!(
            error.starts_with("x.toml:2:1: unknown field `peak_Nm`, expected `peak_nm`"),
            "{error}"
        );
        assert!(error.ends_with("2 | peak_Nm = 3.0\n  | ^^^^^^^"), "{error}");
    }

    #[test]
    fn an_error_of_our_own_points_at_the_value() {
        let text = toml("seed = 1\n[multisine]\nlow_hz = 1.0\n\thigh_hz = 600.0 # too high\n");
        let place = text
            .error(&["multisine", "high_hz"], "above Nyquist")
            .place
            .expect("the key exists");
        assert_eq!((place.line, place.column, place.width), (4, 12, 5));
        let missing = text
            .error(&["multisine", "peak_nm"], "missing")
            .place
            .expect("its table exists");
        assert_eq!((missing.line, missing.column), (2, 2));
        assert_eq!(text.error(&["averaging"], "missing").place, None);
    }

    #[test]
    fn broken_text_never_panics() {
        for text in [
            "",
            "=",
            "[",
            "é = \"",
            "a = 1\r\nb = [[",
            "\u{feff}peak_nm = 1",
            "peak_nm = nan\npeak_nm = 2",
        ] {
            let _ = toml(text)
                .parse::<Table>()
                .map_err(|error| error.to_string());
            let _ = toml(text).error(&["a", "b"], "x").to_string();
        }
    }
}
