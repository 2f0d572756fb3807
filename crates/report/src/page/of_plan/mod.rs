//! Page of an exported plan: what one reads before the robot moves.

mod over_time;
mod peaks;

use frfid_files::Exported;
use frfid_signals::format::{count, significant};
use frfid_signals::{Limit, Peaks};

use crate::error::ReportError;
use crate::page::Report;
use crate::page::of_plan::over_time::run_over_time;
use crate::page::of_plan::peaks::{checks, closest, peaks, reached, unlimited, value};
use crate::page::section::Part;
use crate::page::table::Table;

/// Name of the page beside the files of an export.
pub const PLAN_PAGE: &str = "plan.html";

/// The page of a plan: what moves where, how fast and for how long, every peak beside its limit, a run over time, and
/// the order of play.
///
/// # Errors
/// [`ReportError`] for a run that cannot be drawn.
pub fn plan_page(exported: &Exported) -> Result<String, ReportError> {
    let report = Report {
        title: format!("Before plan {} is played", exported.plan_id),
        lead: Some(before(exported)),
        checks: checks(exported),
        parts: vec![peaks(exported), run_over_time(exported)?, order(exported)],
        ..Report::default()
    };
    report.html()
}

/// What happens, in words, and where the joints go.
fn before(exported: &Exported) -> Part<'_> {
    let notes = [
        course(exported),
        CARE.into(),
        closest(exported),
        unlimited(exported),
    ];
    Part {
        title: "What moves where".into(),
        notes: notes.into_iter().filter(|note| !note.is_empty()).collect(),
        tables: vec![places(exported)],
        ..Part::default()
    }
}

/// What is to be done before.
const CARE: &str = "Move the robot to the pose first, slowly. Play the first run at a tenth of the amplitudes, with a hand on the \
                    stop; clear the space that the table says and what the joints carry through it.";

/// How many runs in which time, and what each of them is.
fn course(exported: &Exported) -> String {
    let runs = count(exported.n_runs(), "run");
    let rate = significant(exported.player.rate_hz, 6);
    let time = duration(exported.duration_s());
    format!(
        "{runs}, {time} in all, at {rate} samples a second. Every run begins at rest at the pose, moves to its start, \
         is ramped up and down, and returns: between two runs the robot stands still at the pose."
    )
}

/// Pose, lowest and highest position of every joint.
fn places(exported: &Exported) -> Table {
    let columns = [
        "Joint",
        "Pose",
        "Lowest",
        "Highest",
        "Farthest from the pose",
    ];
    let peaks = reached(exported);
    let names = exported.joint_names.iter().enumerate();
    let rows = names.map(|(joint, name)| (name.clone(), place(exported, &peaks, joint)));
    table("Positions of the joints", &columns, rows.collect())
}

fn place(exported: &Exported, peaks: &Peaks, joint: usize) -> Vec<String> {
    let pose = exported.player.pose_rad.get(joint).copied();
    let ways = [Limit::LowestPosition, Limit::HighestPosition, Limit::Travel];
    let ways = ways.map(|limit| value(peaks, limit, joint));
    [pose].into_iter().chain(ways).map(angle).collect()
}

/// The runs in the order in which they are played.
fn order(exported: &Exported) -> Part<'_> {
    let columns = ["Run", "Begins after", "Times", "Each", "File"];
    Part {
        title: "Order of play".into(),
        tables: vec![table(
            "Without waiting between the runs",
            &columns,
            played(exported),
        )],
        ..Part::default()
    }
}

/// A row for each reference.
fn played(exported: &Exported) -> Vec<Row> {
    let mut begins_s = 0.0;
    let runs = exported.runs.iter().zip(exported.files.iter().cycle());
    let rows = runs.map(|(run, file)| {
        let file = file.file_name().unwrap_or_default().to_string_lossy();
        let (begins, each) = (duration(begins_s), duration(run.duration_s));
        begins_s += run.n_repetitions as f64 * run.duration_s;
        let times = run.n_repetitions.to_string();
        (
            run.id.to_string(),
            vec![begins, times, each, file.into_owned()],
        )
    });
    rows.collect()
}

/// A row of a table: its name and its cells.
pub(super) type Row = (String, Vec<String>);

pub(super) fn table(title: &str, columns: &[&str], rows: Vec<Row>) -> Table {
    let columns = columns.iter().map(ToString::to_string);
    Table {
        title: title.into(),
        columns: columns.collect(),
        rows,
    }
}

/// An angle in rad and degrees.
fn angle(rad: Option<f64>) -> String {
    let text = |rad: f64| {
        format!(
            "{} rad ({}\u{b0})",
            significant(rad, 4),
            significant(rad.to_degrees(), 3)
        )
    };
    rad.map_or("-".into(), text)
}

/// A duration, in minutes and seconds where it is long.
fn duration(seconds: f64) -> String {
    if seconds < 120.0 {
        return format!("{} s", significant(seconds, 4));
    }
    let whole = seconds.round();
    format!("{} min {} s", (whole / 60.0).floor(), whole % 60.0)
}
