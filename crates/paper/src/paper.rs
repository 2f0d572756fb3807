//! Paper as a whole: claims, figures and results of both sections, and the page that shows them.

use frfid_files::ResultFile;
use frfid_report::{Claim, Part, Report};
use frfid_signals::Frf;

use crate::against_truth::Measured;
use crate::error::PaperError;
use crate::named_figure::Named;
use crate::section6::Section6;
use crate::section7::Section7;

/// Source of everything that is reproduced.
const SOURCE: &str =
    "F. Saupe, A. Knoblach, MSSP 52-53 (2015) 60-72, doi:10.1016/j.ymsp.2014.08.011";

/// Sections 6 and 7 of the paper, done in simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Paper {
    /// The academic example.
    pub section6: Section6,
    /// The robot.
    pub section7: Section7,
}

/// The figures of the paper, by section.
#[derive(Debug, Clone)]
pub struct PaperFigures {
    /// Figures 4 and 5, and what the paper says of a constant velocity.
    pub section6: Vec<Named>,
    /// Figures 3 and 6 to 10, and the convergence.
    pub section7: Vec<Named>,
}

impl PaperFigures {
    /// Every figure, in the order of the page.
    pub fn all(&self) -> impl Iterator<Item = &Named> {
        self.section6.iter().chain(&self.section7)
    }
}

impl Paper {
    /// Every claim beside what we find.
    #[must_use]
    pub fn claims(&self) -> Vec<Claim> {
        [self.section6.claims(), self.section7.claims()].concat()
    }

    /// Draws the figures.
    ///
    /// # Errors
    /// [`PaperError`] would be a fault of this library.
    pub fn figures(&self) -> Result<PaperFigures, PaperError> {
        Ok(PaperFigures {
            section6: self.section6.figures()?,
            section7: self.section7.figures()?,
        })
    }

    /// The FRFs of figures 4, 5 and 10 as results with their names, for `frfid compare` and
    /// `frfid export`.
    #[must_use]
    pub fn results(&self) -> Vec<(&'static str, ResultFile)> {
        let Self { section6, section7 } = self;
        let motor = |measured: &Measured| result(&measured.frf, &["motor".to_owned()]);
        let joints = |frf: &Frf| result(frf, &section7.joint_names);
        vec![
            ("figure_4_multisine", motor(&section6.friction.multisine)),
            ("figure_4_chirp", motor(&section6.friction.chirp)),
            ("figure_5_multisine", motor(&section6.stiffening.multisine)),
            ("figure_5_chirp", motor(&section6.stiffening.chirp)),
            (
                "figure_10_multisine",
                joints(&section7.multisine.by_position),
            ),
            ("figure_10_chirp", joints(&section7.sign_flip.frf)),
        ]
    }

    /// The page: the sections one after the other, below the table of claims.
    #[must_use]
    pub fn page(&self, figures: &PaperFigures) -> Report<'_> {
        Report {
            title: "Saupe and Knoblach (2015): frequency responses of flexible-joint robots".into(),
            lead: figures.section6.first().map(lead),
            claims: self.claims(),
            verdicts: Vec::new(),
            checks: Vec::new(),
            parts: vec![
                self.section6.part(&figures.section6),
                self.section7.part(&figures.section7),
            ],
            provenance: vec![
                ("frfid".into(), env!("CARGO_PKG_VERSION").into()),
                ("source".into(), SOURCE.into()),
            ],
        }
    }
}

/// What the paper is about, in a picture and three sentences.
fn lead(figure_4: &Named) -> Part<'static> {
    Part {
        title: "In short".into(),
        notes: vec![
            "Frequency responses of robots are measured with friction in the joints, and friction bends them. A multisine that stays \
             within the friction loses the resonance altogether, a chirp of the same peak keeps it, but damped. Below: what else the \
             paper claims, from a stiffening gear to three axes of a robot, each claim beside what frfid finds in simulation."
                .into(),
        ],
        figures: vec![figure_4.captioned()],
        ..Part::default()
    }
}

/// An FRF as a result of this version of frfid.
fn result(frf: &Frf, joints: &[String]) -> ResultFile {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    ResultFile {
        provenance: [("frfid_version".to_owned(), version)].into(),
        ..ResultFile::torque_to_velocity(frf.clone(), joints)
    }
}
