//! `frfid demo`: the example of the paper, end to end, with figures, a report and the table of claims.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use frfid_experiment::{Claim, Section6};
use frfid_files::{FileError, Overwrite, ResultFile, create_folder, write_bytes, write_result};
use frfid_report::{Named, paper_report, section6_figures, section6_part};
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::Options;
use crate::progress::watched;
use crate::table::significant;

/// Pixels of the PNGs for each unit of the drawing.
const PNG_SCALE: f64 = 2.0;

/// Do the example of the paper (section 6) in simulation: figures 4 and 5, a report and the table of claims
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

pub(crate) fn run(arguments: &Arguments, options: &Options, console: &mut Console) -> Result<Exit, Failure> {
    let (folder, overwrite) = (arguments.output.as_path(), options.overwrite());
    let page = folder.join("report.html");
    options.check_free(&page)?;
    create_folder(folder)?;
    let started = Instant::now();
    let section6 = watched(console, "simulating section 6", "%", |progress| {
        Section6::run(arguments.jobs, &|done, total| progress(100 * done / total.max(1), 100))
    })?;
    let figures = section6_figures(&section6)?;
    for named in &figures {
        write_figure(folder, named, overwrite)?;
    }
    write_results(folder, &section6, overwrite)?;
    let claims = section6.claims();
    let report = paper_report(vec![section6_part(&section6, &figures)], claims.clone());
    write_bytes(&page, overwrite, report.html()?.as_bytes())?;
    if options.json {
        console.json(&json!({ "report": page, "claims": claims }))?;
    } else {
        console.data(&in_words(&claims))?;
    }
    let files = format!("{} figures (SVG and PNG), 4 results and {}", figures.len(), page.display());
    console.note(format_args!("{files}, in {} s", significant(started.elapsed().as_secs_f64(), 2)));
    console.hint(format_args!(
        "frfid compare {0}/figure_5_multisine.json {0}/figure_5_chirp.json --stronger b",
        folder.display()
    ));
    Ok(if claims.iter().all(|claim| claim.holds) { Exit::Done } else { Exit::Flawed })
}

fn write_figure(folder: &Path, named: &Named, overwrite: Overwrite) -> Result<(), Failure> {
    write_bytes(&folder.join(format!("{}.svg", named.name)), overwrite, named.figure.svg().as_bytes())?;
    Ok(write_bytes(&folder.join(format!("{}.png", named.name)), overwrite, &named.figure.png(PNG_SCALE)?)?)
}

/// The FRFs of figures 4 and 5 as results, for `frfid compare` and `frfid export`.
fn write_results(folder: &Path, section6: &Section6, overwrite: Overwrite) -> Result<(), FileError> {
    let results = [
        ("figure_4_multisine", &section6.friction.multisine),
        ("figure_4_chirp", &section6.friction.chirp),
        ("figure_5_multisine", &section6.stiffening.multisine),
        ("figure_5_chirp", &section6.stiffening.chirp),
    ];
    for (name, measured) in results {
        let result = ResultFile {
            frf: measured.frf.clone(),
            input_names: vec!["motor torque".into()],
            output_names: vec!["motor velocity".into()],
            input_units: vec!["N m".into()],
            output_units: vec!["rad/s".into()],
            checks: Vec::new(),
            provenance: [("frfid_version".to_owned(), env!("CARGO_PKG_VERSION").to_owned())].into(),
        };
        write_result(&folder.join(format!("{name}.json")), overwrite, &result)?;
    }
    Ok(())
}

/// The claims one below the other: what is claimed, what the paper says, what we find.
fn in_words(claims: &[Claim]) -> String {
    let line = |claim: &Claim| {
        let verdict = if claim.holds { "holds" } else { "DOES NOT HOLD" };
        let Claim { id, statement, expected, found, .. } = claim;
        format!("{id:3} {statement}\n    expected  {expected}\n    found     {found}\n    {verdict}\n")
    };
    claims.iter().map(line).collect()
}
