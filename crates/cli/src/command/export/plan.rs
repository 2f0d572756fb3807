//! Export of a plan: its runs from rest to rest, for the players of robots.

use std::path::Path;

use clap::Args;
use frfid_experiment::{ExperimentError, PlannedRuns, PlayOptions};
use frfid_files::{
    AngleUnit, DecimalMark, Exported, PlayFormat, Separator, TableForm, path_text, write_bytes,
};
use frfid_report::{PLAN_PAGE, plan_page};
use frfid_signals::format::{count, significant};
use serde_json::{Value, json};

use crate::command::design::warn;
use crate::command::export::{Arguments, ending, unfit};
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::options::{Options, named};
use crate::progress::watched;

/// What goes with a plan alone.
#[derive(Debug, Args)]
#[command(next_help_heading = "For plans")]
pub(super) struct PlanArguments {
    /// Samples a second of the player, in place of the plan's own
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// One file with all runs in order, repetitions, moves and rests between them included
    #[arg(long)]
    campaign: bool,
    /// What stands between the columns of a CSV
    #[arg(long, value_parser = named::<Separator>())]
    separator: Option<Separator>,
    /// What stands before the decimals of a CSV
    #[arg(long, value_parser = named::<DecimalMark>())]
    decimal: Option<DecimalMark>,
    /// Unit of a table's angles
    #[arg(long, value_parser = named::<AngleUnit>())]
    angle: Option<AngleUnit>,
    /// Turns of the motor for a turn of the joint, one for each joint, of either sign: a table on the motor side
    #[arg(
        long,
        value_name = "RATIO,...",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    gear_ratio: Vec<f64>,
    /// Runs to simulate at once for the check of the limits; 0: one for each core
    #[arg(long, env = "FRFID_JOBS", default_value_t = 0)]
    jobs: usize,
}

impl PlanArguments {
    /// The first option that is given of those that say how a table is written.
    fn of_table(&self) -> Option<&'static str> {
        let given = [
            (self.separator.is_some(), "--separator"),
            (self.decimal.is_some(), "--decimal"),
            (self.angle.is_some(), "--angle"),
            (!self.gear_ratio.is_empty(), "--gear-ratio"),
        ];
        given
            .iter()
            .find(|(is_given, _)| *is_given)
            .map(|(_, name)| *name)
    }

    /// Refuses all of them beside a result.
    pub(super) fn refuse_with_result(&self) -> Result<(), Failure> {
        self.given().map_or(Ok(()), |option| {
            Err(Failure::usage(format!(
                "{option}: found a result, needed a plan; leave it out, or export the plan of the result"
            )))
        })
    }

    fn given(&self) -> Option<&'static str> {
        let rate = self.rate.map(|_| "--rate");
        let campaign = self.campaign.then_some("--campaign");
        rate.or(campaign).or(self.of_table())
    }

    fn form(&self) -> TableForm {
        TableForm {
            separator: self.separator.unwrap_or_default(),
            decimal: self.decimal.unwrap_or_default(),
            angle: self.angle.unwrap_or_default(),
            gear_ratio: self.gear_ratio.clone(),
        }
    }
}

/// The format of this name.
fn of_name(name: &str) -> Result<&'static PlayFormat, Failure> {
    PlayFormat::named(name).map_err(|_| unfit(name, "a plan", &PlayFormat::names()))
}

/// The format that is asked for, or that of the ending; both must not contradict each other.
fn format(to: Option<&str>, output: &Path) -> Result<&'static PlayFormat, Failure> {
    let of_ending = PlayFormat::of_suffix(output);
    match to.map(of_name).transpose()? {
        None => of_ending.ok_or_else(|| without_format(output)),
        Some(to) if of_ending.is_some() && !to.is_ending_of(output) => {
            Err(contradicted(to, output))
        }
        Some(to) => Ok(to),
    }
}

fn without_format(output: &Path) -> Failure {
    let (path, found, names) = (output.display(), ending(output), PlayFormat::names());
    Failure::usage(format!(
        "{path}: found {found}, needed the format of a plan's files; say --to, one of {names}"
    ))
}

fn contradicted(to: &PlayFormat, output: &Path) -> Failure {
    let (name, path, found) = (to.name, output.display(), ending(output));
    Failure::usage(format!(
        "--to {name} and {path} contradict each other: found {found}, that of another format; leave --to out, or choose another name"
    ))
}

pub(super) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let output = &arguments.output;
    let play = play_options(arguments, options)?;
    let page = (!play.format.is_ending_of(output)).then(|| output.join(PLAN_PAGE));
    page.iter().try_for_each(|page| options.check_free(page))?;
    let planned = PlannedRuns::load(&arguments.input)?;
    warn(&planned.experiment, console);
    let exported = watched(console, "rehearsing", "references", |progress| {
        planned.export(output, &play, progress)
    });
    let exported = exported.map_err(refused)?;
    if let Some(page) = &page {
        let html = plan_page(&exported)?;
        write_bytes(page, options.overwrite(), html.as_bytes())?;
    }
    tell(&exported, arguments, options, console)
}

fn play_options(arguments: &Arguments, options: &Options) -> Result<PlayOptions, Failure> {
    let plan = &arguments.plan;
    Ok(PlayOptions {
        format: format(arguments.to.as_deref(), &arguments.output)?,
        rate_hz: plan.rate,
        form: plan.form(),
        is_campaign: plan.campaign,
        jobs: plan.jobs,
        overwrite: options.overwrite(),
    })
}

/// A run that this player cannot play is a matter of the command line.
fn refused(error: ExperimentError) -> Failure {
    match error {
        ExperimentError::Signal(_) => Failure::of(Exit::Usage, &error),
        error => error.into(),
    }
}

fn tell(
    exported: &Exported,
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    let output = &arguments.output;
    if options.json {
        console.json(&as_json(exported, output))?;
    }
    console.wrote(output);
    console.note(in_words(exported));
    if exported.order.is_some() {
        let page = output.join(PLAN_PAGE);
        console.hint(format_args!(
            "read {} before anything moves",
            page.display()
        ));
    }
    Ok(Exit::Done)
}

fn in_words(exported: &Exported) -> String {
    let files = count(exported.files.len(), "file");
    let runs = count(exported.n_runs(), "run");
    let time_s = significant(exported.duration_s(), 4);
    format!(
        "{files}, {runs}, {time_s} s on the robot, plan_id {}",
        exported.plan_id
    )
}

fn as_json(exported: &Exported, output: &Path) -> Value {
    json!({
        "output": path_text(output),
        "files": exported.files.iter().map(path_text).collect::<Vec<_>>(),
        "plan_id": exported.plan_id,
        "rate_hz": exported.player.rate_hz,
        "n_runs": exported.n_runs(),
        "duration_s": exported.duration_s(),
    })
}
