//! Options of every command: JSON, quiet, colours, force; and paths that must exist.

use std::path::{Path, PathBuf};

use anstream::ColorChoice;
use clap::builder::{
    FalseyValueParser, PathBufValueParser, PossibleValue, PossibleValuesParser, TypedValueParser,
};
use clap::{Args, ValueEnum};
use frfid_files::{FileError, Overwrite, check_free, check_not_read};
use schemars::{JsonSchema, SchemaGenerator};
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Options of every command.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = "Options of every command")]
pub(crate) struct Options {
    /// Write what there is to say to stdout as JSON
    #[arg(long, global = true)]
    pub json: bool,
    /// No progress and no notes; results, warnings and errors are always printed
    #[arg(long, short, global = true, env = "FRFID_QUIET", value_parser = FalseyValueParser::new())]
    pub quiet: bool,
    /// When to use colours; `auto`: on a terminal, unless NO_COLOR is set
    #[arg(
        long,
        global = true,
        env = "FRFID_COLOR",
        value_name = "WHEN",
        default_value = "auto"
    )]
    color: When,
    /// Replace output that exists
    #[arg(long, global = true)]
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum When {
    Auto,
    Always,
    Never,
}

impl Options {
    /// What to do when the output exists. What an unfinished command left is replaced: every
    /// command can be done again.
    pub(crate) fn overwrite(&self) -> Overwrite {
        if self.force {
            Overwrite::Replace
        } else {
            Overwrite::Resume
        }
    }

    /// Refuses an output that exists, before any work is done for it.
    pub(crate) fn check_free(&self, path: &Path) -> Result<(), FileError> {
        check_free(path, self.overwrite())
    }

    /// The same, and one that is made of itself.
    pub(crate) fn check_output<'a>(
        &self,
        path: &Path,
        inputs: impl IntoIterator<Item = &'a PathBuf>,
    ) -> Result<(), FileError> {
        self.check_free(path)?;
        check_not_read(path, inputs.into_iter().map(PathBuf::as_path))
    }

    /// When to use colours.
    pub(crate) fn colour(&self) -> ColorChoice {
        match self.color {
            When::Auto => ColorChoice::Auto,
            When::Always => ColorChoice::Always,
            When::Never => ColorChoice::Never,
        }
    }
}

/// A path that must exist: a misspelt name is reported before any work is done.
pub(crate) fn existing_path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match path.symlink_metadata() {
        Ok(_) => Ok(path),
        Err(error) => Err(format!("{error}; check the name")),
    })
}

/// A value by the name that files give it, described in the help as in the schema.
pub(crate) fn named<T>() -> impl TypedValueParser<Value = T>
where
    T: DeserializeOwned + JsonSchema + Clone + Send + Sync + 'static,
{
    let schema = SchemaGenerator::default().into_root_schema_for::<T>();
    let variants = schema
        .get("oneOf")
        .and_then(Value::as_array)
        .into_iter()
        .flatten();
    let text = |variant: &Value, key: &str| variant[key].as_str().unwrap_or_default().to_owned();
    let names = variants.map(|variant| {
        let help = text(variant, "description");
        PossibleValue::new(text(variant, "const")).help(help.trim_end_matches('.').to_owned())
    });
    let names = PossibleValuesParser::new(names.collect::<Vec<_>>());
    names.try_map(|name| serde_json::from_value::<T>(name.into()))
}
