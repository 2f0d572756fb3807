//! Figures 4 and 5 of the paper and its section 6 in the report.

use frfid_report::{Band, Curve, Labels, Part, Responses, Style, bode};

use crate::against_truth::Measured;
use crate::error::PaperError;
use crate::named_figure::Named;
use crate::section6::{Pair, Section6};

impl Section6 {
    /// The figures of section 6: 4, 5, and the one of which the paper says that it is not depicted.
    ///
    /// # Errors
    /// [`PaperError`] would be a fault of this library.
    pub fn figures(&self) -> Result<Vec<Named>, PaperError> {
        Ok(vec![
            self.friction_figure()?,
            self.constant_velocity_figure()?,
            self.stiffness_figure()?,
        ])
    }

    /// Figure 4.
    fn friction_figure(&self) -> Result<Named, PaperError> {
        let (linear, friction) = (&self.linear, &self.friction);
        let curves = [
            self.exact(),
            estimate("multisine, no friction", &linear.multisine, Style::Markers),
            estimate("chirp, no friction", &linear.chirp, Style::Line),
            estimate("multisine, 50 N m", &friction.multisine, Style::Markers),
            estimate("chirp, 50 N m", &friction.chirp, Style::Line),
        ];
        Ok(Named {
            name: "figure_4_friction",
            caption: "Figure 4: influence of Coulomb friction. The multisine is too weak and loses the resonance, the chirp is only damped.".into(),
            figure: bode(&curves, 0, 0, &labels())?,
        })
    }

    /// The same friction on a constant velocity, which the paper reports in words.
    fn constant_velocity_figure(&self) -> Result<Named, PaperError> {
        let Pair { multisine, chirp } = &self.gliding;
        let curves = [
            self.exact(),
            estimate("multisine, 50 N m, 0.25 rad/s", multisine, Style::Markers),
            estimate("chirp, 50 N m, 0.25 rad/s", chirp, Style::Line),
        ];
        Ok(Named {
            name: "figure_4b_constant_velocity",
            caption: "Not depicted in the paper: the same friction, the excitation on a constant velocity of 0.25 rad/s. Friction drops out.".into(),
            figure: bode(&curves, 0, 0, &labels())?,
        })
    }

    /// Figure 5.
    fn stiffness_figure(&self) -> Result<Named, PaperError> {
        let Pair { multisine, chirp } = &self.stiffening;
        let curves = [
            self.exact(),
            estimate("multisine, k2 = 1.7 k1", multisine, Style::Markers),
            estimate("chirp, k2 = 1.7 k1", chirp, Style::Line),
        ];
        Ok(Named {
            name: "figure_5_stiffness",
            caption: "Figure 5: influence of a stiffness that grows with deflection (k2 = 1.7 k1). Only the chirp reaches the stiffer part: its resonance is warped upwards.".into(),
            figure: bode(&curves, 0, 0, &labels())?,
        })
    }

    /// Section 6 as a part of the report: the figures and the responses to look into.
    #[must_use]
    pub(crate) fn part(&self, figures: &[Named]) -> Part<'_> {
        Part {
            title: "Section 6: an academic example".into(),
            notes: vec![
                "Motor torque to motor velocity of a single flexible joint in open loop: J_m = 35 kg m^2, J_o = 150 kg m^2, d = 400 N m s/rad, \
                 k1 = 1.5e5 N m/rad, knee at 1e-3 rad. Multisine: 30 realizations of 12.288 s, peak 150 N m. Chirp: 20 s, 150 N m. \
                 Everything was simulated and estimated when this page was made."
                    .into(),
            ],
            tables: Vec::new(),
            responses: Some(Responses {
                title: "Frequency responses".into(),
                curves: self.curves_to_look_into(),
                labels: labels(),
            }),
            figures: figures.iter().map(Named::captioned).collect(),
        }
    }

    /// The curves of the page's interactive diagram.
    fn curves_to_look_into(&self) -> Vec<Curve<'_>> {
        let (friction, stiffening) = (&self.friction, &self.stiffening);
        vec![
            self.exact(),
            estimate("multisine, 50 N m", &friction.multisine, Style::Markers),
            estimate("chirp, 50 N m", &friction.chirp, Style::Line),
            estimate(
                "multisine, k2 = 1.7 k1",
                &stiffening.multisine,
                Style::Markers,
            ),
            estimate("chirp, k2 = 1.7 k1", &stiffening.chirp, Style::Line),
        ]
    }

    /// The truth, which every figure shows.
    fn exact(&self) -> Curve<'_> {
        Curve {
            label: "linear joint, exact".into(),
            frf: &self.truth,
            style: Style::Reference,
            band: Band::None,
            flagged: None,
        }
    }
}

/// Names of the joint's one input and one output.
fn labels() -> Labels {
    Labels::torque_to_velocity(1, 1)
}

/// An estimate with its 95 % region of noise and nonlinear distortion.
fn estimate<'a>(label: &str, measured: &'a Measured, style: Style) -> Curve<'a> {
    Curve {
        label: label.into(),
        frf: &measured.frf,
        style,
        band: Band::Total,
        flagged: None,
    }
}
