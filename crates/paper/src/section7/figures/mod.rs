//! Figures 3 and 6 to 10 of the paper and its section 7 in the report.

pub(crate) mod matrices;
pub(crate) mod signals;
pub(crate) mod tables;

use frfid_estimate::Summary;
use frfid_report::{Band, Curve, Labels, Part, Procedure, Responses, Style, convergence};
use frfid_signals::Frf;
use ndarray::Array2;

use crate::error::PaperError;
use crate::paper::Named;
use crate::section7::Section7;

/// Errors that shaping must and aims to reach, and the stuck share it must stay below.
const ERROR_LIMITS: [f64; 2] = [0.05, 0.1];
const STUCK_LIMIT: f64 = 0.15;
impl Section7 {
    /// The figures of section 7: 3, 6 to 10, and the convergence that the paper states in words.
    ///
    /// # Errors
    /// [`PaperError`] would be a fault of this library.
    pub fn figures(&self) -> Result<Vec<Named>, PaperError> {
        Ok(vec![
            signals::figure_3(&self.sign_flip)?,
            signals::figure_6(&self.multisine)?,
            signals::figure_7(&self.sign_flip)?,
            convergence_figure(self)?,
            matrices::figure_8(self)?,
            matrices::figure_9(self)?,
            matrices::figure_10(self)?,
        ])
    }

    /// Section 7 as a part of the report: tables, figures and the responses to look into.
    #[must_use]
    pub(crate) fn part(&self, figures: &[Named]) -> Part<'_> {
        let Section7 {
            multisine,
            orthogonal,
            sign_flip,
            ..
        } = self;
        let curves = vec![
            curve("linear truth at the pose", &self.truth, Style::Reference),
            estimate(
                "multisine, glide subtracted by position",
                &multisine.by_position,
                Style::Markers,
            ),
            curve(
                "multisine, not compensated",
                &multisine.uncompensated,
                Style::Markers,
            ),
            curve("chirp, orthogonal", &orthogonal.frf, Style::Line),
            curve("chirp, sign flip", &sign_flip.frf, Style::Line),
        ];
        let mut notes: Vec<String> = vec![
        "Motor torque to motor velocity of the base axes of a simulated robot in closed loop, with Coulomb friction, torque ripple, \
         quantisation and sensor noise. Everything was simulated and estimated when this page was made."
            .into(),
        "Why the cross channels agree better with (26): its column 1 comes from two experiments in which the other axes move exactly \
         oppositely, so their friction, an odd function, cancels. With (9) phases and amplitudes of the axes, and with them the \
         friction, differ from experiment to experiment, and the difference is booked on the weak cross channel."
            .into(),
    ];
        notes.extend(
            sign_flip
                .warnings
                .iter()
                .map(|warning| format!("Desired torques of figure 7: {warning}")),
        );
        notes.extend(
            self.table1_warnings
                .iter()
                .map(|warning| format!("Desired torques of the paper's table 1: {warning}")),
        );
        Part {
            title: "Section 7: the base axes of an industrial robot".into(),
            notes,
            tables: tables::tables(self),
            responses: Some(Responses {
                title: "Frequency responses".into(),
                curves,
                labels: labels(self),
            }),
            figures: figures.iter().map(Named::captioned).collect(),
        }
    }
}

fn convergence_figure(section7: &Section7) -> Result<Named, PaperError> {
    let Section7 {
        joint_names,
        orthogonal,
        sign_flip,
        paper_step,
        ..
    } = section7;
    let procedures = [
        procedure(
            "damped step, sign flip",
            &sign_flip.iterations,
            joint_names.len(),
        ),
        procedure(
            "damped step, orthogonal",
            &orthogonal.iterations,
            joint_names.len(),
        ),
        procedure("the paper's step, sign flip", paper_step, joint_names.len()),
    ];
    Ok(Named {
        name: "figure_7b_convergence",
        caption: "Not depicted in the paper: how far the torques are from the desired ones at each iteration (rms over the band; 10 % must \
                  and 5 % should be reached), and the share of time each axis sticks (less than 15 %)."
            .into(),
        figure: convergence(&procedures, joint_names, &ERROR_LIMITS, Some(STUCK_LIMIT))?,
    })
}

/// Errors and stuck shares per axis; NaN where a run was stopped.
fn procedure(label: &str, iterations: &[Summary], axes: usize) -> Procedure {
    let error = |(k, axis): (usize, usize)| {
        iterations[k]
            .channel_error
            .as_ref()
            .and_then(|errors| errors.get(axis))
            .copied()
            .unwrap_or(f64::NAN)
    };
    let stuck = |(k, axis): (usize, usize)| {
        iterations[k]
            .stuck_share
            .get(axis)
            .copied()
            .unwrap_or(f64::NAN)
    };
    let shape = (iterations.len(), axes);
    Procedure {
        label: label.into(),
        error: Array2::from_shape_fn(shape, error),
        stuck: Some(Array2::from_shape_fn(shape, stuck)),
    }
}

fn labels(section7: &Section7) -> Labels {
    let axes = section7.joint_names.len();
    Labels::torque_to_velocity(axes, axes)
}

fn curve<'a>(label: &str, frf: &'a Frf, style: Style) -> Curve<'a> {
    Curve {
        label: label.into(),
        frf,
        style,
        band: Band::None,
        flagged: None,
    }
}

fn estimate<'a>(label: &str, frf: &'a Frf, style: Style) -> Curve<'a> {
    Curve {
        band: Band::Total,
        ..curve(label, frf, style)
    }
}
