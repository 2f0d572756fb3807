//! Figures 3 and 6 to 10 of the paper and its section 7 in the report.

pub(crate) mod matrices;
pub(crate) mod signals;
pub(crate) mod tables;

use frfid_estimate::Summary;
use frfid_report::{Band, Curve, Labels, Part, Procedure, Responses, Style, convergence};
use frfid_signals::Frf;
use ndarray::Array2;

use crate::error::PaperError;
use crate::named_figure::Named;
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
        Part {
            title: "Section 7: the base axes of an industrial robot".into(),
            notes: notes(self),
            tables: tables::tables(self),
            responses: Some(Responses {
                title: "Frequency responses".into(),
                curves: curves_to_look_into(self),
                labels: labels(self),
                still: None,
            }),
            figures: figures.iter().map(Named::captioned).collect(),
        }
    }
}

/// The paragraphs of section 7, what is reported of weak torques included.
fn notes(section7: &Section7) -> Vec<String> {
    let fixed = [
        "Motor torque to motor velocity of the base axes of a simulated robot in closed loop, with Coulomb friction, torque ripple, \
         quantisation and sensor noise. Everything was simulated and estimated when this page was made.",
        "Why the cross channels agree better with (26): its column 1 comes from two experiments in which the other axes move exactly \
         oppositely, so their friction, an odd function, cancels. With (9) phases and amplitudes of the axes, and with them the \
         friction, differ from experiment to experiment, and the difference is booked on the weak cross channel.",
    ];
    [
        fixed.map(String::from).to_vec(),
        torque_notes("figure 7", &section7.sign_flip.warnings),
        torque_notes("the paper's table 1", &section7.table1_warnings),
    ]
    .concat()
}

/// What is reported of torques that are too weak.
fn torque_notes(whose: &str, warnings: &[String]) -> Vec<String> {
    warnings
        .iter()
        .map(|warning| format!("Desired torques of {whose}: {warning}"))
        .collect()
}

/// The curves of the page's interactive diagram, in the colours of the figures.
fn curves_to_look_into(section7: &Section7) -> Vec<Curve<'_>> {
    let campaign = &section7.multisine;
    vec![
        truth(section7),
        estimate(
            "multisine, glide subtracted by position",
            &campaign.by_position,
            Style::Markers,
        )
        .with_swatch(0, 0),
        Curve::new(
            "multisine, not compensated",
            &campaign.uncompensated,
            Style::Line,
        )
        .with_swatch(1, 0),
        Curve::new("chirp, orthogonal", &section7.orthogonal.frf, Style::Line).with_swatch(2, 2),
        Curve::new("chirp, sign flip", &section7.sign_flip.frf, Style::Line).with_swatch(3, 1),
    ]
}

/// The convergence of the damped step and of the paper's own.
fn convergence_figure(section7: &Section7) -> Result<Named, PaperError> {
    let (orthogonal, sign_flip) = (&section7.orthogonal, &section7.sign_flip);
    let names = &section7.joint_names;
    let procedures = [
        ("damped step, sign flip", &sign_flip.iterations),
        ("damped step, orthogonal", &orthogonal.iterations),
        ("the paper's step, sign flip", &section7.paper_step),
    ]
    .map(|(label, iterations)| procedure(label, iterations, names.len()));
    Ok(Named::new(
        "figure_7b_convergence",
        "Not depicted in the paper: how far the torques are from the desired ones at each iteration (rms over the band; 10 % must \
         and 5 % should be reached), and the share of time each axis sticks (less than 15 %).",
        convergence(&procedures, names, &ERROR_LIMITS, Some(STUCK_LIMIT))?,
    ))
}

/// Errors and stuck shares per axis; NaN where a run was stopped.
fn procedure(label: &str, iterations: &[Summary], axes: usize) -> Procedure {
    let of_axes = |values: &dyn Fn(&Summary) -> &[f64]| {
        Array2::from_shape_fn((iterations.len(), axes), |(k, axis)| {
            let value = values(&iterations[k]).get(axis);
            value.copied().unwrap_or(f64::NAN)
        })
    };
    Procedure {
        label: label.into(),
        error: of_axes(&|iteration| iteration.channel_error.as_deref().unwrap_or_default()),
        stuck: Some(of_axes(&|iteration| &iteration.stuck_share)),
    }
}

/// Names of the axes' torques and velocities.
fn labels(section7: &Section7) -> Labels {
    let axes = section7.joint_names.len();
    Labels::torque_to_velocity(axes, axes)
}

/// The linear truth, which every matrix shows.
fn truth(section7: &Section7) -> Curve<'_> {
    Curve::new(
        "linear truth at the pose",
        &section7.truth,
        Style::Reference,
    )
}

/// An FRF with its 95 % region of noise and nonlinear distortion.
fn estimate<'a>(label: &str, frf: &'a Frf, style: Style) -> Curve<'a> {
    Curve {
        band: Band::Total,
        ..Curve::new(label, frf, style)
    }
}
