//! `frfid report`: results as a page, at any time.

use std::path::{Path, PathBuf};

use clap::Args;
use frfid_files::{ResultFile, path_text, read_result, write_bytes};
use frfid_report::{ReportError, results_page};
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check_all};
use crate::options::{Options, existing_path};

/// Make a page for the browser of a result, or of several in one picture; what the estimate warned of
/// is not part of a result: say it with --note
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid report frf.json -o frf.html                     the page of estimate --report
  frfid report before.json after.json -o both.html --title \"New gear\" --note \"Gear 7, 20 h of use\"")]
pub(crate) struct Arguments {
    /// Results of frfid estimate, of the same channels
    #[arg(value_name = "RESULT.json", required = true, value_parser = existing_path())]
    results: Vec<PathBuf>,
    /// The page to write
    #[arg(long, short, value_name = "PAGE.html")]
    output: PathBuf,
    /// Title of the page, in place of the names of the results
    #[arg(long)]
    title: Option<String>,
    /// What a careful reader should know: a paragraph above the diagram; once for each
    #[arg(long, value_name = "TEXT")]
    note: Vec<String>,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let (paths, output) = (&arguments.results, &arguments.output);
    options.check_output(output, paths)?;
    check_all(paths, Needed::Result)?;
    let results: Vec<ResultFile> = paths
        .iter()
        .map(|path| read_result(path))
        .collect::<Result<_, _>>()?;
    let names = names(paths);
    let named = names.iter().map(String::as_str).zip(&results);
    let title = arguments.title.clone();
    let title = title.unwrap_or_else(|| names.join(", "));
    let page = results_page(&title, &named.collect::<Vec<_>>(), arguments.note.clone());
    let page = page.map_err(|error| failure(&error))?;
    write_bytes(output, options.overwrite(), page.as_bytes())?;
    if options.json {
        console.json(&json!({ "output": path_text(output), "results": paths.iter().map(path_text).collect::<Vec<_>>(), "title": title }))?;
    }
    console.wrote(output);
    Ok(Exit::Done)
}

/// Results that do not go together are answered by another command line.
fn failure(error: &ReportError) -> Failure {
    match error {
        ReportError::Channels { .. } => Failure::of(Exit::Usage, error),
        _ => Failure::failed(error),
    }
}

/// The name of each result on its page: its file's without the ending, the whole path where two
/// share it.
fn names(paths: &[PathBuf]) -> Vec<String> {
    let stems: Vec<String> = paths.iter().map(|path| name(path)).collect();
    let is_alone = |name: &String| stems.iter().filter(|stem| *stem == name).count() == 1;
    let names = paths.iter().zip(&stems).map(|(path, stem)| {
        let whole = || path.display().to_string();
        if is_alone(stem) {
            stem.clone()
        } else {
            whole()
        }
    });
    names.collect()
}

/// The name of a result on its page.
pub(crate) fn name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}
