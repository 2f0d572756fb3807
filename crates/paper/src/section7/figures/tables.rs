//! The numbers of section 7 beside the paper's.

use frfid_estimate::Summary;
use frfid_report::Table;
use frfid_signals::{Limit, Peaks, median};

use crate::section7::Section7;
use crate::section7::chirps::ShapedChirps;

/// What the paper says of its own robot (SK15 (23) to (25), section 7.2).
const PAPER_TORQUES: &str = "200, 136, 62";
const NONE: &str = "–";

/// Peak torques and durations beside the paper's, and what shaping reached per axis.
pub(crate) fn tables(section7: &Section7) -> Vec<Table> {
    vec![torques_and_durations(section7), shaping(section7)]
}

fn torques_and_durations(section7: &Section7) -> Table {
    let Section7 {
        multisine,
        orthogonal,
        sign_flip,
        coulomb_nm,
        ..
    } = section7;
    let mut rows = vec![
        row("Coulomb friction in N m", list(coulomb_nm, 0), NONE),
        row(
            "Multisine: peak torque in N m",
            list(torque(&multisine.load.peaks), 0),
            PAPER_TORQUES,
        ),
        row(
            "Multisine: constant velocity in rad/s",
            list(&multisine.velocity_rad_s, 4),
            NONE,
        ),
        row(
            "Multisine: runs",
            multisine.n_runs.to_string(),
            "10 realizations, 5 repetitions",
        ),
        row(
            "Multisine: time on the robot",
            duration(multisine.robot_time_s),
            NONE,
        ),
    ];
    for (name, chirps) in [
        ("Chirp, orthogonal", orthogonal),
        ("Chirp, sign flip", sign_flip),
    ] {
        let ShapedChirps {
            peaks,
            n_runs,
            robot_time_s,
            iterations,
            ..
        } = chirps;
        let said = |what: &str| format!("{name}: {what}");
        rows.extend([
            row(
                said("peak torque in N m"),
                list(torque(peaks), 0),
                "100, 150, 120 desired (table 1)",
            ),
            row(said("iterations"), iterations.len().to_string(), "6"),
            row(said("runs"), n_runs.to_string(), NONE),
            row(
                said("time on the robot"),
                duration(*robot_time_s),
                "20 s for each sweep",
            ),
        ]);
    }
    let columns = ["", "Here", "Paper (another robot)"]
        .map(str::to_owned)
        .to_vec();
    Table {
        title: "Peak torques (holding torque included) and durations".into(),
        columns,
        rows,
    }
}

fn shaping(section7: &Section7) -> Table {
    let Section7 {
        orthogonal,
        sign_flip,
        paper_step,
        ..
    } = section7;
    let best = |chirps: &ShapedChirps| {
        chirps
            .iterations
            .iter()
            .find(|summary| summary.number == chirps.best)
            .cloned()
    };
    let reached = |summary: Option<Summary>| -> Vec<String> {
        let error = summary
            .as_ref()
            .and_then(|summary| summary.channel_error.as_deref())
            .map_or(NONE.into(), percents);
        let stuck = summary
            .as_ref()
            .map_or(NONE.into(), |summary| percents(&summary.stuck_share));
        vec![
            summary.map_or(NONE.into(), |summary| summary.number.to_string()),
            error,
            stuck,
        ]
    };
    let with_condition = |chirps: &ShapedChirps| {
        let conditions = [
            middle(&chirps.conditions.at_torque),
            middle(&chirps.conditions.at_reference),
        ];
        [reached(best(chirps)), conditions.to_vec()].concat()
    };
    let last = [
        reached(paper_step.last().cloned()),
        vec![NONE.into(), NONE.into()],
    ]
    .concat();
    let rows = vec![
        (
            "Damped step, orthogonal, best".into(),
            with_condition(orthogonal),
        ),
        (
            "Damped step, sign flip, best".into(),
            with_condition(sign_flip),
        ),
        ("The paper's step, sign flip, last".into(), last),
    ];
    let columns = [
        "Procedure",
        "Iteration",
        "Error of the torques in %",
        "Stuck in %",
        "cond(U), made at u (median)",
        "cond(U), made at r (median)",
    ];
    Table {
        title: "Shaping".into(),
        columns: columns.map(str::to_owned).to_vec(),
        rows,
    }
}

fn row(name: impl Into<String>, here: String, paper: &str) -> (String, Vec<String>) {
    (name.into(), vec![here, paper.into()])
}

fn list(values: &[f64], decimals: usize) -> String {
    values
        .iter()
        .map(|value| format!("{value:.decimals$}"))
        .collect::<Vec<_>>()
        .join(", ")
}

fn percents(shares: &[f64]) -> String {
    list(
        &shares.iter().map(|share| 100.0 * share).collect::<Vec<_>>(),
        1,
    )
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

fn middle(values: &[f64]) -> String {
    median(values.to_vec()).map_or(NONE.into(), |value| format!("{value:.2}"))
}

/// Peak torque of every axis in N m.
fn torque(peaks: &Peaks) -> &[f64] {
    peaks.get(Limit::Torque).unwrap_or_default()
}
