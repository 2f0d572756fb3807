//! Figures 4 and 5 of the paper and its section 6 in the report.

use frfid_report::{Band, Curve, Labels, Part, Responses, Style, bode};

use crate::against_truth::Measured;
use crate::error::PaperError;
use crate::paper::Named;
use crate::section6::Section6;

impl Section6 {
    /// The figures of section 6: 4, 5, and the one of which the paper says that it is not depicted.
    ///
    /// # Errors
    /// [`PaperError`] would be a fault of this library.
    pub fn figures(&self) -> Result<Vec<Named>, PaperError> {
        let Section6 {
            linear,
            friction,
            gliding,
            stiffening,
            ..
        } = self;
        let labels = Labels::torque_to_velocity(1, 1);
        let figure = |curves: &[Curve]| bode(curves, 0, 0, &labels);
        let truth = || curve("linear joint, exact", &self.truth, Style::Reference);
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
    pub(crate) fn part(&self, figures: &[Named]) -> Part<'_> {
        let curves = vec![
            curve("linear joint, exact", &self.truth, Style::Reference),
            estimate(
                "multisine, 50 N m",
                &self.friction.multisine,
                Style::Markers,
            ),
            estimate("chirp, 50 N m", &self.friction.chirp, Style::Line),
            estimate(
                "multisine, k2 = 1.7 k1",
                &self.stiffening.multisine,
                Style::Markers,
            ),
            estimate("chirp, k2 = 1.7 k1", &self.stiffening.chirp, Style::Line),
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
