//! Tables of section 7: its numbers beside the paper's.

use frfid_estimate::{OctaveError, Summary};
use frfid_report::Table;
use frfid_signals::{Limit, Peaks, median};

use crate::section7::Section7;
use crate::section7::chirps::ShapedChirps;
use crate::section7::lists::list;
use crate::section7::multisine::MultisineCampaign;

/// What the paper says of its own robot (SK15 (23) to (25), section 7.2).
const PAPER_TORQUES: &str = "200, 136, 62";
const NONE: &str = "–";

/// Peak torques and durations beside the paper's, and what shaping reached per axis.
pub(crate) fn tables(section7: &Section7) -> Vec<Table> {
    vec![torques_and_durations(section7), shaping(section7)]
}

/// Peak torques, runs and durations.
fn torques_and_durations(section7: &Section7) -> Table {
    Table {
        title: "Peak torques (holding torque included) and durations".into(),
        columns: columns(&["", "Here", "Paper (another robot)"]),
        rows: [
            multisine_rows(&section7.coulomb_nm, &section7.multisine),
            chirp_rows("Chirp, orthogonal", &section7.orthogonal),
            chirp_rows("Chirp, sign flip", &section7.sign_flip),
        ]
        .concat(),
    }
}

fn multisine_rows(coulomb_nm: &[f64], campaign: &MultisineCampaign) -> Vec<Row> {
    vec![
        row("Coulomb friction in N m", list(coulomb_nm, 0), NONE),
        row(
            "Multisine: peak torque in N m",
            list(torque(&campaign.load.peaks), 0),
            PAPER_TORQUES,
        ),
        row(
            "Multisine: constant velocity in rad/s",
            list(&campaign.velocity_rad_s, 4),
            NONE,
        ),
        row(
            "Multisine: runs",
            campaign.n_runs.to_string(),
            "10 realizations, 5 repetitions",
        ),
        row(
            "Multisine: time on the robot",
            duration(campaign.robot_time_s),
            NONE,
        ),
    ]
}

fn chirp_rows(name: &str, chirps: &ShapedChirps) -> Vec<Row> {
    let of_name = |what, here, paper| row(format!("{name}: {what}"), here, paper);
    vec![
        of_name(
            "peak torque in N m",
            list(torque(&chirps.peaks), 0),
            "100, 150, 120 desired (table 1)",
        ),
        of_name("iterations", chirps.iterations.len().to_string(), "6"),
        of_name("runs", chirps.n_runs.to_string(), NONE),
        of_name(
            "time on the robot",
            duration(chirps.robot_time_s),
            "20 s for each sweep",
        ),
    ]
}

/// What shaping reached by every procedure.
fn shaping(section7: &Section7) -> Table {
    let paper_last = [reached(section7.paper_step.last()), vec![NONE.into(); 2]].concat();
    Table {
        title: "Shaping".into(),
        columns: columns(&[
            "Procedure",
            "Iteration",
            "Error of the torques in %",
            "In the worst octave in %",
            "Stuck in %",
            "cond(U), made at u (median)",
            "cond(U), made at r (median)",
        ]),
        rows: vec![
            (
                "Damped step, orthogonal, best".into(),
                reached_at_best(&section7.orthogonal),
            ),
            (
                "Damped step, sign flip, best".into(),
                reached_at_best(&section7.sign_flip),
            ),
            ("The paper's step, sign flip, last".into(), paper_last),
        ],
    }
}

/// Number, error over the band and in its worst octave, and stuck share of an iteration.
fn reached(iteration: Option<&Summary>) -> Vec<String> {
    let number = iteration.map(|summary| summary.number.to_string());
    let error = iteration.and_then(|summary| summary.channel_error.as_deref());
    let octaves = iteration.and_then(|summary| summary.octave_error.as_deref());
    let worst = octaves.map(|octaves| percents(&OctaveError::worst_of_axes(octaves)));
    let stuck = iteration.map(|summary| summary.stuck_share.as_slice());
    [number, error.map(percents), worst, stuck.map(percents)]
        .map(|cell| cell.unwrap_or(NONE.into()))
        .to_vec()
}

/// The same of the best iteration, and how well its spectra can be inverted.
fn reached_at_best(chirps: &ShapedChirps) -> Vec<String> {
    let conditions = &chirps.conditions;
    let conditions = [&conditions.at_torque, &conditions.at_reference].map(|of| middle(of));
    [&reached(Some(chirps.best_iteration()))[..], &conditions].concat()
}

/// Heads of the columns of a table.
fn columns(heads: &[&str]) -> Vec<String> {
    heads.iter().map(|&head| head.into()).collect()
}

/// A row of a table: its name and the cells behind it.
type Row = (String, Vec<String>);

fn row(name: impl Into<String>, here: String, paper: &str) -> Row {
    (name.into(), vec![here, paper.into()])
}

/// Shares in percent.
fn percents(shares: &[f64]) -> String {
    list(shares.iter().map(|share| 100.0 * share), 1)
}

/// A time as minutes and seconds.
fn duration(time_s: f64) -> String {
    let seconds = time_s.round() as u64;
    if seconds < 60 {
        format!("{seconds} s")
    } else {
        format!("{} min {} s", seconds / 60, seconds % 60)
    }
}

/// The median with two decimals.
fn middle(values: &[f64]) -> String {
    median(values.to_vec()).map_or(NONE.into(), |value| format!("{value:.2}"))
}

/// Peak torque of every axis in N m.
fn torque(peaks: &Peaks) -> &[f64] {
    peaks.get(Limit::Torque).unwrap_or_default()
}
