//! `frfid check`: whether a description is sound, and what its experiment will cost.

use std::path::PathBuf;

use clap::Args;
use frfid_experiment::Experiment;

use crate::command::design::warn;
use crate::console::Console;
use crate::exit::{Exit, Failure};
use crate::input::{Needed, check};
use crate::options::Options;
use crate::text::plan::{plan_as_json, plan_as_text};
use crate::text::signal::NO_MODEL;

/// Check a description, and tell what its experiment will cost
#[derive(Debug, Args)]
#[command(before_help = "\
Examples:
  frfid check experiment.toml
  frfid check experiment.toml --json")]
pub(crate) struct Arguments {
    /// The description
    #[arg(value_name = "X.toml")]
    experiment: PathBuf,
}

const SOUND: &str = "is sound";
const UNSTABLE: &str = "is not sound: the loop of the robot's model is not stable";

pub(crate) fn run(
    arguments: &Arguments,
    options: &Options,
    console: &mut Console,
) -> Result<Exit, Failure> {
    check(&arguments.experiment, Needed::Description)?;
    let experiment = Experiment::load(&arguments.experiment)?;
    let is_shaped = experiment.config().shape.is_some();
    if is_shaped {
        experiment.shaper()?; // refuses what cannot be shaped
    }
    warn(&experiment, console);
    if experiment.robot().is_none() {
        console.note(NO_MODEL);
    }
    let is_sound = experiment.instability().is_none();
    if options.json {
        let mut value = plan_as_json(experiment.plan())?;
        value["is_sound"] = is_sound.into();
        console.json(&value)?;
    } else {
        let verdict = if is_sound { SOUND } else { UNSTABLE };
        console.data(&format!(
            "{} {verdict}\n{}",
            experiment.text().name,
            plan_as_text(experiment.plan())?
        ))?;
    }
    if is_sound && !options.json {
        let path = arguments.experiment.display();
        console.hint(if is_shaped {
            format!("frfid shape {path} -o shaped")
        } else {
            format!("frfid design {path} -o plan.mcap")
        });
    }
    Ok(Exit::flawed_unless(is_sound))
}
