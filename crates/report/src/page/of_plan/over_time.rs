//! Run of an exported plan over time, as a picture.

use frfid_files::Exported;
use frfid_signals::{Limit, Played};
use ndarray::{Array2, ArrayView1};

use crate::diagrams::time_series::{TimePanel, Trace, time_series};
use crate::error::ReportError;
use crate::figure::Figure;
use crate::page::of_plan::peaks::finite;
use crate::page::section::Part;

/// A limit is drawn where the signals reach this share of it: beside a larger one they would be flat.
const DRAWN: f64 = 0.3;

/// What the other runs are.
const OTHERS: &str = "The other runs differ in their phases, or in which joint is driven how.";

/// A run as a picture.
pub(super) fn run_over_time(exported: &Exported) -> Result<Part<'_>, ReportError> {
    let (caption, figure) = (caption(exported), figure(exported)?);
    Ok(Part {
        title: format!("Run {} over time", exported.shown.id),
        notes: vec![OTHERS.into()],
        figures: vec![(caption, figure)],
        ..Part::default()
    })
}

/// What the figure shows.
fn caption(exported: &Exported) -> String {
    let shown = exported.shown.id;
    format!("What is commanded in run {shown}, from rest to rest")
}

/// The commands of a run over time.
fn figure(exported: &Exported) -> Result<Figure, ReportError> {
    let ways;
    let panels = match &exported.shown.played {
        Played::Torque(torque) => vec![panel(exported, "Torque in N m", torque, Limit::Torque)],
        Played::Motion(motion) => {
            ways = from_pose(&motion.position_rad, &exported.player.pose_rad);
            vec![
                panel(exported, "From the pose in rad", &ways, Limit::Travel),
                panel(
                    exported,
                    "Velocity in rad/s",
                    &motion.velocity_rad_s,
                    Limit::Velocity,
                ),
                panel(
                    exported,
                    "Acceleration in rad/s\u{b2}",
                    &motion.acceleration_rad_s2,
                    Limit::Acceleration,
                ),
            ]
        }
    };
    time_series(exported.shown.sample_time_s, &panels)
}

fn from_pose(position_rad: &Array2<f64>, pose_rad: &[f64]) -> Array2<f64> {
    let mut ways = position_rad.clone();
    for (mut row, pose) in ways.rows_mut().into_iter().zip(pose_rad) {
        row -= *pose;
    }
    ways
}

fn panel<'a>(
    exported: &'a Exported,
    label: &str,
    signal: &'a Array2<f64>,
    limit: Limit,
) -> TimePanel<'a> {
    let rows = signal.rows().into_iter().zip(&exported.joint_names);
    let traces = rows.map(|(samples, name)| Trace {
        label: name.clone(),
        samples,
    });
    TimePanel {
        label: label.into(),
        traces: traces.collect(),
        limit: common_limit(exported, signal, limit),
        envelope: None,
    }
}

/// The limit, where it is that of every joint and the signals come near it.
fn common_limit(exported: &Exported, signal: &Array2<f64>, limit: Limit) -> Option<f64> {
    let allowed = exported.player.limits.get(limit)?;
    let first = finite(*allowed.first()?)?;
    let peak = |row: ArrayView1<f64>| row.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let largest = signal.rows().into_iter().map(peak).fold(0.0, f64::max);
    let is_common = allowed.iter().all(|value| *value == first);
    (is_common && largest > DRAWN * first).then_some(first)
}
