//! What every command understands: JSON, quiet, colours, force; and paths that must exist.

use std::path::{Path, PathBuf};

use anstream::ColorChoice;
use clap::builder::{FalseyValueParser, PathBufValueParser, TypedValueParser};
use clap::{Args, ValueEnum};
use frfid_files::{FileError, Overwrite, check_free};

/// Options of every command.
#[derive(Debug, Clone, Copy, Args)]
#[command(next_help_heading = "Options of every command")]
pub(crate) struct Options {
    /// Write what there is to say to stdout as JSON
    #[arg(long, global = true)]
    pub json: bool,
    /// Neither messages nor progress; warnings and errors are always told
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
    pub fn overwrite(&self) -> Overwrite {
        if self.force {
            Overwrite::Replace
        } else {
            Overwrite::Resume
        }
    }

    /// Refuses an output that exists, before any work is done for it.
    pub fn check_free(&self, path: &Path) -> Result<(), FileError> {
        check_free(path, self.overwrite())
    }

    /// When to use colours.
    pub fn colour(&self) -> ColorChoice {
        match self.color {
            When::Auto => ColorChoice::Auto,
            When::Always => ColorChoice::Always,
            When::Never => ColorChoice::Never,
        }
    }
}

/// A path that must exist: a misspelt name is told before any work is done.
pub(crate) fn existing_path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match path.symlink_metadata() {
        Ok(_) => Ok(path),
        Err(error) => Err(format!("{error}; check the name")),
    })
}
