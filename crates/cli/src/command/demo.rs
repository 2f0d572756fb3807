//! `frfid demo`: the paper, end to end, with figures, a report and the table of claims.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use frfid_files::{Overwrite, create_folder, path_text, write_bytes, write_result};
use frfid_paper::{Named, Paper, Section6, Section7};
use frfid_report::Claim;
use frfid_signals::format::significant;
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::Options;
use crate::progress::watched;

/// Pixels of the PNGs for each unit of the drawing.
const PNG_SCALE: f64 = 2.0;

/// Do the paper in simulation: sections 6 and 7, figures 3 to 10, a report and the table of claims
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid demo                 figures and report.html into the folder frfid-demo
  frfid demo -o somewhere --force")]
pub(crate) struct Arguments {
    /// The folder for figures and report
    #[arg(long, short, value_name = "DIR", default_value = "frfid-demo")]
    output: PathBuf,
    /// Runs to simulate at once; 0: one for each core
    #[arg(long, env = "FRFID_JOBS", default_value_t = 0)]
    jobs: usize,
}

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let folder = arguments.output.as_path();
    let page = folder.join("report.html");
    options.check_free(&page)?;
    create_folder(folder)?;
    let started = Instant::now();
    let paper = simulate(arguments.jobs, console)?;
    let files = write(&paper, folder, &page, options.overwrite())?;
    let claims = paper.claims();
    if options.json {
        console.json(&json!({ "report": path_text(&page), "claims": claims }))?;
    } else {
        console.data(&claims.iter().map(in_words).collect::<String>())?;
    }
    let seconds = significant(started.elapsed().as_secs_f64(), 2);
    console.note(format_args!("{files}, in {seconds} s"));
    console.hint(format_args!(
        "frfid compare {0}/figure_5_multisine.json {0}/figure_5_chirp.json --stronger b",
        folder.display()
    ));
    let holds = claims.iter().all(|claim| claim.holds);
    Ok(Exit::flawed_unless(holds))
}

/// Does every experiment of the paper.
fn simulate(jobs: usize, console: &mut Console) -> Result<Paper, Failure> {
    let section6 = watched(console, "simulating section 6", "%", |progress| {
        let in_percent = |done: usize, total: usize| progress(100 * done / total.max(1), 100);
        Section6::run(jobs, &in_percent)
    })?;
    let section7 = watched(console, "simulating section 7", "%", |progress| {
        Section7::run(jobs, progress)
    })?;
    Ok(Paper { section6, section7 })
}

/// Writes figures, results and the page; returns what was written, in words.
fn write(
    paper: &Paper,
    folder: &Path,
    page: &Path,
    overwrite: Overwrite,
) -> Result<String, Failure> {
    let (figures, results) = (paper.figures()?, paper.results());
    for named in figures.all() {
        write_figure(folder, named, overwrite)?;
    }
    for (name, result) in &results {
        write_result(&folder.join(format!("{name}.json")), overwrite, result)?;
    }
    write_bytes(page, overwrite, paper.page(&figures).html()?.as_bytes())?;
    Ok(format!(
        "{} figures (SVG and PNG), {} results and {}",
        figures.all().count(),
        results.len(),
        page.display()
    ))
}

fn write_figure(folder: &Path, named: &Named, overwrite: Overwrite) -> Result<(), Failure> {
    let Named { name, figure, .. } = named;
    let [svg, png] = ["svg", "png"].map(|ending| folder.join(format!("{name}.{ending}")));
    write_bytes(&svg, overwrite, figure.svg().as_bytes())?;
    Ok(write_bytes(&png, overwrite, &figure.png(PNG_SCALE)?)?)
}

/// A claim: what is claimed, what the paper says, what we find.
fn in_words(claim: &Claim) -> String {
    let Claim {
        id,
        statement,
        expected,
        found,
        ..
    } = claim;
    let verdict = if claim.holds {
        "holds"
    } else {
        "DOES NOT HOLD"
    };
    format!("{id:3} {statement}\n    expected  {expected}\n    found     {found}\n    {verdict}\n")
}
