//! Figures 4 and 5 of the paper and its section 6 in the report.

use frfid_experiment::{Measured, Section6};

use crate::paper::Named;
use crate::{Band, Curve, Labels, Part, ReportError, Responses, Style, bode};

/// The figures of section 6: 4, 5, and the one of which the paper says that it is not depicted.
///
/// # Errors
/// [`ReportError`] would be a fault of this library.
pub fn section6_figures(section6: &Section6) -> Result<Vec<Named>, ReportError> {
    let Section6 {
        linear,
        friction,
        gliding,
        stiffening,
        ..
    } = section6;
    let labels = Labels::torque_to_velocity(1, 1);
    let figure = |curves: &[Curve]| bode(curves, 0, 0, &labels);
    let truth = || curve("linear joint, exact", &section6.truth, Style::Reference);
    Ok(vec![
        Named {
            name: "figure_4_friction",
            caption: "Figure 4: influence of Coulomb friction. The multisine is too weak and loses the resonance, the chirp is only damped.".into(),
            figure: figure(&[
                truth(),
                estimate("multisine, no friction", &linear.multisine, Style::Markers),
                estimate("chirp, no friction", &linear.chirp, Style::Line),
                estimate("multisine, 50 N m", &friction.multisine, Style::Markers),
                estimate("chirp, 50 N m", &friction.chirp, Style::Line),
            ])?,
        },
        Named {
            name: "figure_4b_constant_velocity",
            caption: "Not depicted in the paper: the same friction, the excitation on a constant velocity of 0.25 rad/s. Friction drops out.".into(),
            figure: figure(&[
                truth(),
                estimate("multisine, 50 N m, 0.25 rad/s", &gliding.multisine, Style::Markers),
                estimate("chirp, 50 N m, 0.25 rad/s", &gliding.chirp, Style::Line),
            ])?,
        },
        Named {
            name: "figure_5_stiffness",
            caption: "Figure 5: influence of a stiffness that grows with deflection (k2 = 1.7 k1). Only the chirp reaches the stiffer part: its resonance is warped upwards.".into(),
            figure: figure(&[
                truth(),
                estimate("multisine, k2 = 1.7 k1", &stiffening.multisine, Style::Markers),
                estimate("chirp, k2 = 1.7 k1", &stiffening.chirp, Style::Line),
            ])?,
        },
    ])
}

/// Section 6 as a part of the report: the figures and the responses to look into.
#[must_use]
pub fn section6_part<'a>(section6: &'a Section6, figures: &[Named]) -> Part<'a> {
    let curves = vec![
        curve("linear joint, exact", &section6.truth, Style::Reference),
        estimate(
            "multisine, 50 N m",
            &section6.friction.multisine,
            Style::Markers,
        ),
        estimate("chirp, 50 N m", &section6.friction.chirp, Style::Line),
        estimate(
            "multisine, k2 = 1.7 k1",
            &section6.stiffening.multisine,
            Style::Markers,
        ),
        estimate(
            "chirp, k2 = 1.7 k1",
            &section6.stiffening.chirp,
            Style::Line,
        ),
    ];
    Part {
        title: "Section 6: an academic example".into(),
        notes: vec![
            "Motor torque to motor velocity of a single flexible joint in open loop: J_m = 35 kg m^2, J_o = 150 kg m^2, d = 400 N m s/rad, \
             k1 = 1.5e5 N m/rad, knee at 1e-3 rad. Multisine: 30 realizations of 12.288 s, peak 150 N m. Chirp: 20 s, 150 N m. \
             Everything was simulated and estimated when this page was made."
                .into(),
        ],
        tables: Vec::new(),
        responses: Some(Responses { title: "Frequency responses".into(), curves, labels: Labels::torque_to_velocity(1, 1) }),
        figures: figures.iter().map(Named::captioned).collect(),
    }
}

fn curve<'a>(label: &str, frf: &'a frfid_signals::Frf, style: Style) -> Curve<'a> {
    Curve {
        label: label.into(),
        frf,
        style,
        band: Band::None,
        flagged: None,
    }
}

fn estimate<'a>(label: &str, measured: &'a Measured, style: Style) -> Curve<'a> {
    Curve {
        band: Band::Total,
        ..curve(label, &measured.frf, style)
    }
}
