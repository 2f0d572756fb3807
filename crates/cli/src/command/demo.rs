//! `frfid demo`: the paper, end to end, with figures, a report and the table of claims.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use frfid_experiment::{Claim, Section6, Section7};
use frfid_files::{Overwrite, ResultFile, create_folder, write_bytes, write_result};
use frfid_report::{
    Named, paper_report, section6_figures, section6_part, section7_figures, section7_part,
};
use frfid_signals::Frf;
use serde_json::json;

use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::Options;
use crate::progress::watched;
use crate::table::significant;

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
    let (folder, overwrite) = (arguments.output.as_path(), options.overwrite());
    let page = folder.join("report.html");
    options.check_free(&page)?;
    create_folder(folder)?;
    let started = Instant::now();
    let section6 = watched(console, "simulating section 6", "%", |progress| {
        Section6::run(arguments.jobs, &|done, total| {
            progress(100 * done / total.max(1), 100)
        })
    })?;
    let section7 = watched(console, "simulating section 7", "%", |progress| {
        Section7::run(arguments.jobs, progress)
    })?;
    let (figures6, figures7) = (section6_figures(&section6)?, section7_figures(&section7)?);
    for named in figures6.iter().chain(&figures7) {
        write_figure(folder, named, overwrite)?;
    }
    let results = [section6_results(&section6), section7_results(&section7)].concat();
    for (name, result) in &results {
        write_result(&folder.join(format!("{name}.json")), overwrite, result)?;
    }
    let claims = [section6.claims(), section7.claims()].concat();
    let parts = vec![
        section6_part(&section6, &figures6),
        section7_part(&section7, &figures7),
    ];
    let report = paper_report(parts, claims.clone());
    write_bytes(&page, overwrite, report.html()?.as_bytes())?;
    if options.json {
        console.json(&json!({ "report": page, "claims": claims }))?;
    } else {
        console.data(&in_words(&claims))?;
    }
    let n_figures = figures6.len() + figures7.len();
    let files = format!(
        "{n_figures} figures (SVG and PNG), {} results and {}",
        results.len(),
        page.display()
    );
    console.note(format_args!(
        "{files}, in {} s",
        significant(started.elapsed().as_secs_f64(), 2)
    ));
    console.hint(format_args!(
        "frfid compare {0}/figure_5_multisine.json {0}/figure_5_chirp.json --stronger b",
        folder.display()
    ));
    Ok(if claims.iter().all(|claim| claim.holds) {
        Exit::Done
    } else {
        Exit::Flawed
    })
}

fn write_figure(folder: &Path, named: &Named, overwrite: Overwrite) -> Result<(), Failure> {
    write_bytes(
        &folder.join(format!("{}.svg", named.name)),
        overwrite,
        named.figure.svg().as_bytes(),
    )?;
    Ok(write_bytes(
        &folder.join(format!("{}.png", named.name)),
        overwrite,
        &named.figure.png(PNG_SCALE)?,
    )?)
}

/// The FRFs of figures 4 and 5 as results, for `frfid compare` and `frfid export`.
fn section6_results(section6: &Section6) -> Vec<(&'static str, ResultFile)> {
    let joint = ["motor".to_owned()];
    vec![
        (
            "figure_4_multisine",
            result(&section6.friction.multisine.frf, &joint),
        ),
        (
            "figure_4_chirp",
            result(&section6.friction.chirp.frf, &joint),
        ),
        (
            "figure_5_multisine",
            result(&section6.stiffening.multisine.frf, &joint),
        ),
        (
            "figure_5_chirp",
            result(&section6.stiffening.chirp.frf, &joint),
        ),
    ]
}

/// The FRF matrices of figure 10 as results.
fn section7_results(section7: &Section7) -> Vec<(&'static str, ResultFile)> {
    let joints = &section7.joint_names;
    vec![
        (
            "figure_10_multisine",
            result(&section7.multisine.by_position, joints),
        ),
        ("figure_10_chirp", result(&section7.sign_flip.frf, joints)),
    ]
}

fn result(frf: &Frf, joints: &[String]) -> ResultFile {
    ResultFile {
        frf: frf.clone(),
        input_names: joints
            .iter()
            .map(|joint| format!("{joint} torque"))
            .collect(),
        output_names: joints
            .iter()
            .map(|joint| format!("{joint} velocity"))
            .collect(),
        input_units: vec!["N m".into(); joints.len()],
        output_units: vec!["rad/s".into(); joints.len()],
        checks: Vec::new(),
        provenance: [(
            "frfid_version".to_owned(),
            env!("CARGO_PKG_VERSION").to_owned(),
        )]
        .into(),
    }
}

/// The claims one below the other: what is claimed, what the paper says, what we find.
fn in_words(claims: &[Claim]) -> String {
    let line = |claim: &Claim| {
        let verdict = if claim.holds {
            "holds"
        } else {
            "DOES NOT HOLD"
        };
        let Claim {
            id,
            statement,
            expected,
            found,
            ..
        } = claim;
        format!(
            "{id:3} {statement}\n    expected  {expected}\n    found     {found}\n    {verdict}\n"
        )
    };
    claims.iter().map(line).collect()
}
