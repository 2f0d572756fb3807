//! Figures 4 and 5 of the paper and its section 6 in the report.

use std::iter;

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
        self.figure(
            "figure_4_friction",
            "Figure 4: influence of Coulomb friction. The multisine is too weak and loses the resonance, the chirp is only damped.",
            &[self.without_friction(), self.with_friction()],
        )
    }

    /// The same friction on a constant velocity, which the paper reports in words.
    fn constant_velocity_figure(&self) -> Result<Named, PaperError> {
        self.figure(
            "figure_4b_constant_velocity",
            "Not depicted in the paper: the same friction, the excitation on a constant velocity of 0.25 rad/s. Friction drops out.",
            &[self.on_constant_velocity()],
        )
    }

    /// Figure 5.
    fn stiffness_figure(&self) -> Result<Named, PaperError> {
        self.figure(
            "figure_5_stiffness",
            "Figure 5: influence of a stiffness that grows with deflection (k2 = 1.7 k1). Only the chirp reaches the stiffer part: its resonance is warped upwards.",
            &[self.that_stiffens()],
        )
    }

    /// A figure of the truth and the estimates of joints, each with its name.
    fn figure(
        &self,
        name: &'static str,
        caption: &str,
        joints: &[Joint<'_>],
    ) -> Result<Named, PaperError> {
        let figure = bode(&self.curves(joints), 0, 0, &labels())?;
        Ok(Named::new(name, caption, figure))
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
                curves: self.curves(&[self.with_friction(), self.that_stiffens()]),
                labels: labels(),
                still: None,
            }),
            figures: figures.iter().skip(1).map(Named::captioned).collect(), // the first leads the page
        }
    }

    /// The truth and, of each joint, what multisine and chirp find.
    fn curves<'a>(&'a self, joints: &[Joint<'a>]) -> Vec<Curve<'a>> {
        let exact = Curve::new("linear joint, exact", &self.truth, Style::Reference);
        let found = joints.iter().flat_map(Joint::curves);
        iter::once(exact).chain(found).collect()
    }
}

/// A joint with its name and the colours in which the page shows its multisine and its chirp.
struct Joint<'a> {
    name: &'static str,
    pair: &'a Pair,
    colors: [usize; 2],
    shape: usize,
}

impl Section6 {
    fn with_friction(&self) -> Joint<'_> {
        joint("50 N m", &self.friction, [0, 1], 0)
    }

    fn without_friction(&self) -> Joint<'_> {
        joint("no friction", &self.linear, [2, 3], 1)
    }

    fn that_stiffens(&self) -> Joint<'_> {
        joint("k2 = 1.7 k1", &self.stiffening, [4, 2], 2)
    }

    fn on_constant_velocity(&self) -> Joint<'_> {
        joint("50 N m, 0.25 rad/s", &self.gliding, [3, 4], 3)
    }
}

fn joint<'a>(name: &'static str, pair: &'a Pair, colors: [usize; 2], shape: usize) -> Joint<'a> {
    Joint {
        name,
        pair,
        colors,
        shape,
    }
}

impl<'a> Joint<'a> {
    /// Both estimates.
    fn curves(&self) -> [Curve<'a>; 2] {
        let [multisine, chirp] = self.colors;
        let label = |what: &str| format!("{what}, {}", self.name);
        [
            estimate(label("multisine"), &self.pair.multisine, Style::Markers)
                .with_swatch(multisine, self.shape),
            estimate(label("chirp"), &self.pair.chirp, Style::Line).with_swatch(chirp, self.shape),
        ]
    }
}

/// Names of the joint's one input and one output.
fn labels() -> Labels {
    Labels::torque_to_velocity(1, 1)
}

/// An estimate with its 95 % region of noise and nonlinear distortion.
fn estimate(label: String, measured: &Measured, style: Style) -> Curve<'_> {
    Curve {
        band: Band::Total,
        ..Curve::new(label, &measured.frf, style)
    }
}
